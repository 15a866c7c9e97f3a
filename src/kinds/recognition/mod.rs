//! Studies that recognise objects, in work items: a family of cells in a trial each, and the touches of each array.

mod kind;
mod limits;
mod load;
mod measuring;
mod rows;
mod scale;
mod study;

pub use load::{load_study, read_plans, touch_content};
pub use rows::RecognitionRows;
pub use scale::recognition_scale;
pub use study::RecognitionStudy;
