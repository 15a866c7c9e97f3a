//! Objects above a flat grid.

use super::lines::GridLines;
use crate::geometry::Pose;
use crate::objects::Model;

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
