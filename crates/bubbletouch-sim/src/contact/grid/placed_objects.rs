//! Objects above a flat grid, and the travel of the grid.

use super::lines::GridLines;
use crate::geometry::Pose;
use crate::objects::Model;

/// Travel of a press, and which spheres count during it.
#[derive(Clone, Copy)]
pub(crate) enum TravelGoal {
    /// To this travel, metres, from the front; all spheres count.
    Travel(f64),
    /// No travel. A sphere that is wholly behind the substrate of a taxel does not push this taxel.
    Pose,
    /// To first contact and this depth past it, metres, from the front; all spheres count.
    Depth(f64),
}

/// Objects in the frame of a flat grid.
pub(super) struct PlacedObjects<'a> {
    pub objects: &'a [Model],
    /// Poses `patch_from_object`, one per object.
    pub patch_from_objects: &'a [Pose],
    /// Radius ρ of a taxel, metres.
    pub radius: f64,
    /// Height of the substrate, metres; −∞ if the press comes from the front.
    pub behind: f64,
    /// Places of the taxels.
    pub lines: &'a GridLines,
}
