//! Objects above a flat grid, and the travel of the grid.

use super::lines::GridLines;
use crate::geometry::Pose;
use crate::objects::Model;

/// Goal of a press on a grid, which also determines whether spheres behind the substrate push taxels.
#[derive(Clone, Copy)]
pub(crate) enum TravelGoal {
    /// Travel of a press from the front, metres; spheres push at any distance behind the taxels.
    Travel(f64),
    /// Given pose without travel. A sphere that is wholly behind the substrate of a taxel does not push this taxel.
    Pose,
    /// Depth past first contact of a press from the front, metres; spheres push at any distance behind the taxels.
    Depth(f64),
}

/// Objects in the frame of a flat grid, with the data of the grid that a press needs.
pub(super) struct PlacedObjects<'a> {
    pub objects: &'a [Model],
    /// Poses `patch_from_object`, one per object.
    pub patch_from_objects: &'a [Pose],
    /// Radius of the taxels, metres.
    pub radius: f64,
    /// Height of the substrate, metres, below which spheres do not push taxels; −∞ if the press comes from the front.
    pub behind: f64,
    /// Lines (columns and rows) of the grid.
    pub lines: &'a GridLines,
}
