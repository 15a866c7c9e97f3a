//! Plan of a recognition study: checked keys, converted to SI units.

mod combinations;
pub(crate) mod learning;
pub mod listed_taxels;
pub mod pose_groups;
pub(crate) mod recorded;
pub(crate) mod scene;
pub mod sensed;
pub mod signal;
pub mod study_plan;
pub mod taxel_array;
pub mod tested;
pub(crate) mod unused_keys;

pub use self::{
    listed_taxels::*, pose_groups::*, sensed::*, signal::*, study_plan::*, taxel_array::*,
};
