//! Splits and configurations of a study.

pub mod configurations;
pub(crate) mod learned_frames;
pub mod splits;
pub mod training_rows;
