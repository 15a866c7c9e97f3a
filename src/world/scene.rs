//! The immutable description of what presses on what.

use super::Patch;
use crate::objects::Model;

/// A patch and the objects it can touch. Where they are is said at each press.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The patch; all deflections are its taxels'.
    pub patch: Patch,
    /// The objects, each in its own frame.
    pub objects: Vec<Model>,
}

impl Scene {
    /// A patch and one object.
    pub fn of_one(patch: &Patch, object: &Model) -> Self {
        Self {
            patch: *patch,
            objects: vec![object.clone()],
        }
    }
}
