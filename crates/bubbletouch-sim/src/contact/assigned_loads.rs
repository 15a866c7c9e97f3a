//! Assignment of contact forces on rigid bodies to the patches that these bodies carry.
//!
//! A contact acts on the nearest patch of its carrier that it faces and whose taxels are within reach of its point. A contact that acts on no patch is counted
//! at the nearest patch of the carrier, if that is nearer than the diameter of the patch.

use super::point_loads::PointLoad;
use crate::geometry::{Pose, distinct_places};
use crate::objects::nearest_distances;
use crate::world::Patch;
use glam::DVec3;

/// Least cosine between a normal force and the axis of the nearest taxel, reversed: contacts up to 60° off the axis act on the patch. If larger, contacts on
/// the rims of curved skins are lost; if smaller, contacts on the side of a finger act on its pad.
const FACING: f64 = 0.5;

/// Relative allowance for rounding of a contact point on the rim.
const ROUNDING: f64 = 1.0 + 1e-9;

/// Distances from the taxels of a patch within which contacts act on the patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadRange {
    /// Largest height above the nearest taxel, metres: the largest stroke plus the largest diameter of a taxel. Points of deep contacts are up to twice as far
    /// behind the taxel.
    pub reach: f64,
    /// Largest distance from the axis of the nearest taxel, metres: the largest spacing, or the largest radius if that is larger. If larger, contacts beside
    /// the skin act on it; if smaller, contacts on the rim do not.
    pub margin: f64,
    /// Centre and radius of a ball around all taxels, in the patch frame, metres.
    pub ball: (DVec3, f64),
}

impl LoadRange {
    /// Returns the range of a patch.
    pub fn new(patch: &Patch) -> Self {
        let (centers, taxels) = (patch.layout().centers(), patch.taxels().all());
        let radius = taxels.iter().map(|taxel| taxel.radius).fold(0.0, f64::max);
        let stroke = taxels.iter().map(|taxel| taxel.stroke).fold(0.0, f64::max);
        let min = centers.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let max = centers
            .iter()
            .copied()
            .fold(DVec3::NEG_INFINITY, DVec3::max);
        Self {
            reach: stroke + 2.0 * radius,
            margin: radius.max(largest_spacing(patch)),
            ball: (0.5 * (min + max), 0.5 * (max - min).length() + radius),
        }
    }
}

/// Patch of a skin on its carrier.
#[derive(Clone, Copy, Debug)]
pub struct LoadedPatch<'a> {
    /// Patch on which contacts act.
    pub patch: &'a Patch,
    /// Range within which contacts act on the patch; `reach` may be larger than the patch's own.
    pub range: LoadRange,
    /// Index of the rigid body that carries the patch.
    pub carrier: usize,
    /// Pose `world_from_patch` of the patch.
    pub pose: Pose,
}

/// Contact forces by the patch and the object between which they act.
#[derive(Clone, Debug, Default)]
pub struct AssignedLoads {
    /// Patch, object and load in the patch frame, sorted by patch and object.
    pub loads: Vec<(usize, usize, PointLoad)>,
    /// Patch, object and normal force, newtons, of contacts that act on no patch, at the nearest patch.
    pub beside: Vec<(usize, usize, f64)>,
}

/// Assigns contacts to patches. A contact has the index of the carrier on which its force acts, the index of the object that touches the carrier, and the force
/// in the world.
pub fn assign_loads(
    patches: &[LoadedPatch],
    contacts: impl IntoIterator<Item = (usize, usize, PointLoad)>,
) -> AssignedLoads {
    let mut found = AssignedLoads::default();
    for (carrier, object, load) in contacts {
        let own = patches.iter().enumerate();
        let own = own.filter(|(_, patch)| patch.carrier == carrier);
        let places = own.map(|(number, patch)| {
            let local = load.seen_from(&patch.pose);
            let (distance, acts) = place(patch, &local);
            (number, local, distance, acts)
        });
        let nearest = places.min_by(|a, b| b.3.cmp(&a.3).then(a.2.total_cmp(&b.2)));
        match nearest {
            Some((number, local, _, true)) => found.loads.push((number, object, local)),
            Some((number, local, distance, false))
                if distance <= 2.0 * patches[number].range.ball.1 =>
            {
                found.beside.push((number, object, local.normal.length()));
            }
            _ => {}
        }
    }
    found
        .loads
        .sort_by_key(|(patch, object, _)| (*patch, *object));
    found
}

/// Returns the distance of a load's point from the nearest taxel, metres, and whether the load acts on the patch. The load is in the patch frame.
fn place(patch: &LoadedPatch, load: &PointLoad) -> (f64, bool) {
    let (layout, range) = (patch.patch.layout(), patch.range);
    let squares = layout
        .centers()
        .iter()
        .map(|center| center.distance_squared(load.point));
    let nearest = squares.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
    let (taxel, square) = nearest.expect("a patch has taxels");
    let (axis, offset) = (layout.axes()[taxel], load.point - layout.centers()[taxel]);
    let height = offset.dot(axis);
    let beside = (square - height * height).max(0.0).sqrt();
    let acts = -load.normal.dot(axis) >= FACING * load.normal.length()
        && beside <= range.margin * ROUNDING
        && (-2.0 * range.reach..=range.reach).contains(&height);
    (square.sqrt(), acts)
}

/// Returns the largest distance between a taxel and its nearest neighbour at another place, metres; 0 for a single taxel.
fn largest_spacing(patch: &Patch) -> f64 {
    let places = distinct_places(patch.layout().centers());
    match places.len() {
        1 => 0.0,
        _ => nearest_distances(&places).into_iter().fold(0.0, f64::max),
    }
}
