//! Audit of a data set: tests whether recorded frames with labels support a claim about recognition.
//!
//! An audit answers three questions: what the split of the claim measures ([`claim`]), whether the class can be read from what should not name it ([`sources`]),
//! and whether the readings are sound ([`readings`]). Each answer is a list of findings with a number, one sentence, and advice. Only tests are faults, apart from
//! designs that make every split impossible. The p-values of all tests are corrected together (Holm). The probability that an audit of faultless data reports a
//! fault is therefore at most 5 %.
//!
//! Statistics of frames are in `bubbletouch_sim::audit`. Statistics of labelled rows, and the engine of all permutation tests, are in `bubbletouch_svm::audit`.

pub mod claim;
mod context;
mod data;
mod finding;
mod pictures;
mod reader;
pub mod readings;
mod report;
mod run;
pub mod sources;
mod splits;
mod tables;

pub use context::{AuditOptions, Context};
pub use data::AuditData;
pub use finding::{ALPHA, Finding, Verdict, has_fault};
pub use reader::AuditFiles;
pub use report::{AUDIT_FILES, audit_files, audit_text};
pub use run::{Audit, audit};
