//! Re-exports of the kinds of studies under a short path. The code is in [`studies`](crate::studies).

pub use crate::studies::*;

/// Types of recognition studies.
pub mod recognition {
    pub use crate::studies::recognition::study::{
        RecognitionRows, RecognitionStudy, load_study, read_plans, recognition_scale, touch_content,
    };
}
