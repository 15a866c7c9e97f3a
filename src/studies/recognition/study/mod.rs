//! Work items of recognition studies: one for each family of configurations and trial, and one for the touches of each array.

pub(crate) mod kind;
pub(crate) mod limits;
pub(crate) mod load;
pub(crate) mod measuring;
pub(crate) mod recognition_study;
pub(crate) mod rows;
pub(crate) mod scale;
pub(crate) mod touch_inputs;

pub use crate::studies::recognition::study::load::{load_study, read_plans, touch_content};
pub use crate::studies::recognition::study::recognition_study::RecognitionStudy;
pub use crate::studies::recognition::study::rows::RecognitionRows;
pub use crate::studies::recognition::study::scale::recognition_scale;
