//! Work items of recognition studies: one for each family of configurations and trial, and one for the touches of each array.

pub(crate) mod kind;
pub(crate) mod limits;
pub(crate) mod load;
pub(crate) mod measuring;
pub(crate) mod recognition_study;
pub(crate) mod scale;

pub use self::{load::*, measuring::*, recognition_study::*, scale::*};
