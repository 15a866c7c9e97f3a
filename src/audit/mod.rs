//! Audit of a data set: tests whether recorded frames with labels support a claim about recognition.
//!
//! Each check is a file of [`checks`] with a constant `ABOUT`; its name in the list [`checks::CHECKS`] adds it to the audit. A check returns findings with a
//! number, a p-value or a count, one sentence, and advice. The p-values of all findings are corrected together (Holm). The probability that an audit of
//! faultless data reports a fault is therefore at most 5 %.
//!
//! Statistics of frames are in `bubbletouch_sim::audit`. Statistics of labelled rows are in `bubbletouch_svm::audit`.

mod check;
pub mod checks;
mod context;
mod data;
mod deep_touches;
mod duplicate_pairs;
mod finding;
mod pictures;
mod reader;
mod report;
mod run;
mod scores;
mod splits;
mod tables;

pub use check::{CheckAbout, Source};
pub use context::{AuditOptions, Context};
pub use data::AuditData;
pub use finding::{ALPHA, Finding, Verdict};
pub use reader::AuditFiles;
pub use report::{AUDIT_FILES, audit_files, audit_text};
pub use run::{Audit, audit};
