//! The splits and configurations of a study.

pub(crate) mod learned_frames;
pub mod splits;
pub mod sweep;
