//! Studies that recognise objects, in work items: a family of cells in a trial each, and the touches of each array.

mod cost;
mod limits;
mod load;
mod measuring;
mod rows;
mod study;

pub use limits::Limit;
pub(super) use measuring::describe;
pub use rows::{ArrayOutcome, Outcome, RecognitionRows};
pub use study::{RecognitionStudy, StudyPart};
