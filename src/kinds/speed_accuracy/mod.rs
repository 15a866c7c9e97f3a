//! What does accuracy cost, for every choice there is here?
//!
//! A file with a `[speed_accuracy]` table is such a study: [`SpeedAccuracyStudySpec`] (as written) → [`SpeedAccuracyPlan`] (checked, SI) →
//! [`SpeedAccuracyStudy`] → tables of [`rows`]. It has two parts, each left out where its table is:
//!
//! - **contact**: time of a touch against its deflection error, of models of objects (packed spheres, a sphere a vertex, the mesh itself,
//!   solids by their distance functions), of singles, of time steps, and of methods whose taxels have mass. Exact contact says what is
//!   right. [Scans](ContactSpec::scans) that a study names are touched beside its objects. Rows that other programs left in a file of
//!   [`peers`](ContactSpec::peers) stand beside ours.
//! - **recognition**: share of right answers against the time of a decision (touch, compress, classify: one touch at a time on one thread) and
//!   of a training (one thread), over pitch, detail of the objects, ensemble, ratio and classifier. Learned from objects of that
//!   detail, tested on other touches of the exact ones.
//!
//! Each part has a table of what it found, one of times, and one of both together.

mod bench;
mod charts;
mod contact;
mod contact_points;
mod engines;
pub mod flat_press;
mod flat_rows;
mod models;
mod plan;
mod recognition;
pub mod rows;
mod solid_contact;
mod spec;
mod study;
mod subject;

pub use plan::SpeedAccuracyPlan;
pub use spec::{
    ContactSpec, RecognitionSweepSpec, ScansSpec, SpeedAccuracySpec, SpeedAccuracyStudySpec,
};
pub use study::{SpeedAccuracyRows, SpeedAccuracyStudy};
