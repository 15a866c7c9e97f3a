//! Lines along the axes of eight neighbouring taxels, in the frame of a mesh.
//!
//! The lines are stored in double precision for evaluation and in single precision for the search. One *thick line* contains all lines. It is the line
//! through the point ō along the unit vector ū, with bounds of the distances of the taxels' centres from the line. Let p(t) = o + t u be the centre of a
//! taxel at the height t. Heights of stops are at most the limit of the search. They are at least the height of the substrate or of the far end of the
//! mesh.

use super::eight::{Eight, Eight3, Mask, cross, difference, dot};
use super::skin_mesh::MeshAt;
use crate::world::{LEAF, Leaf};
use glam::DVec3;

/// Bound of the rounding errors of single precision, relative to the lengths in the scene. Each bound is computed from about ten numbers, each rounded by 6e-8.
const ROUNDING: f64 = 4e-6;
/// Cosine below which the direction of a taxel counts as perpendicular to the thick line. Far below any cosine between neighbouring taxels of a smooth layout.
const STEEP: f32 = 1e-3;
/// Component of a direction below which the component does not bound the heights at which a line enters a box. If larger, bounds are weaker; if smaller, rounding
/// errors are enlarged more.
const SMALL: f32 = 0.02;

/// Axis of a taxel in the frame of a mesh, in double precision.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ray {
    /// Centre of the taxel at rest, metres.
    pub origin: DVec3,
    /// Axis of the taxel, unit vector.
    pub direction: DVec3,
    /// Sum of the taxel's radius and the rounding of the mesh, metres.
    pub reach: f64,
}

/// Lines in single precision, one a lane; positions are relative to the centre of the mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lines {
    pub origin: Eight3,
    pub direction: Eight3,
    /// Absolute values of the directions' components.
    pub absolute: Eight3,
    /// Reciprocals of the directions' components; 0 for components that are too small.
    pub inverse: Eight3,
    /// −∞ for components that are too small, otherwise 0.
    pub floor: Eight3,
    /// Sums of a taxel's radius and the rounding of the mesh, metres.
    pub reach: Eight,
    /// Heights along the lines below which a triangle may lie behind the substrate of a taxel, metres.
    pub behind: Eight,
}

impl Lines {
    /// Creates lines from their origins and directions.
    #[inline(always)]
    fn new((origin, direction): (Eight3, Eight3), reach: Eight, behind: Eight) -> Self {
        let absolute = direction.map(Eight::abs);
        let (zero, one) = (Eight::splat(0.0), Eight::splat(1.0));
        let is_small = absolute.map(|component| component.is_below(Eight::splat(SMALL)));
        Self {
            origin,
            direction,
            absolute,
            inverse: [0, 1, 2].map(|k| is_small[k].select(zero, one / direction[k])),
            floor: is_small.map(|mask| mask.select(Eight::splat(f32::NEG_INFINITY), zero)),
            reach,
            behind,
        }
    }

    /// Returns one line in all lanes.
    #[inline(always)]
    pub fn one(ray: &Ray, center: DVec3, behind: f64) -> Self {
        let splat = |vector: DVec3| {
            let [x, y, z] = vector.to_array();
            [x, y, z].map(|component| Eight::splat(component as f32))
        };
        Self::new(
            (splat(ray.origin - center), splat(ray.direction)),
            Eight::splat(ray.reach as f32),
            Eight::splat(behind as f32),
        )
    }
}

/// Bounds of the deviations of taxels from a thick line; all are 0 for the line of one taxel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Thickness {
    /// Bounds of |(p(t) − ō) × ū| for the heights t at which triangles stop a taxel, metres. `across` bounds the components, `radius` the length.
    pub across: [f32; 3],
    pub radius: f32,
    /// Bounds of |(p(t) − ō) × ū| for all heights t at which the line meets the ball around the mesh, metres. `across_far` bounds the components,
    /// `radius_far` the length.
    pub across_far: [f32; 3],
    pub radius_far: f32,
    /// Largest distance between a taxel's axis and ū.
    pub cone: f32,
    /// Difference of the largest and the smallest reach, metres.
    pub reach: f32,
}

impl Thickness {
    /// Thickness of the line of one taxel.
    pub const ZERO: Self = Self {
        across: [0.0; 3],
        radius: 0.0,
        across_far: [0.0; 3],
        radius_far: 0.0,
        cone: 0.0,
        reach: 0.0,
    };
}

/// Axes of the taxels of a leaf in the frame of a mesh, with a thick line around them.
#[derive(Clone, Copy, Debug)]
pub(super) struct TaxelLines {
    pub rays: [Ray; LEAF],
    pub lines: Lines,
    /// One bit for each taxel that may touch the mesh.
    pub active: u32,
    /// The thick line in all lanes.
    pub middle: Lines,
    pub thickness: Thickness,
    /// Largest height of a stopped taxel's centre, measured along the thick line, metres.
    top: f32,
    /// Heights along the thick line of the taxels' centres at rest, metres; −∞ for taxels that are not active.
    ahead: Eight,
    /// Cosines between the taxels' axes and the thick line.
    cosine: Eight,
    /// Bound of rounding errors, metres.
    pub slack: f32,
}

impl TaxelLines {
    /// Creates the lines of a leaf; `None` if the ball around the mesh is out of the taxels' reach. `limits` are the heights below which stops are searched,
    /// metres.
    #[inline(always)]
    pub fn new(mesh: &MeshAt, leaf: &Leaf, limits: &[f64; LEAF]) -> Option<Self> {
        let blocks = mesh.model().blocks();
        let mesh_from_patch = mesh.rotation().transpose();
        let rounding = mesh.model().rounding();
        let mut origin = [[0.0; LEAF]; 3];
        let mut direction = [[0.0; LEAF]; 3];
        let (mut reach, mut behind, mut limit) = ([0.0; LEAF], [0.0; LEAF], [0.0; LEAF]);
        let rays = std::array::from_fn(|k| {
            let center = leaf.vector(&leaf.centers, k) - mesh.translation();
            let ray = Ray {
                origin: mesh_from_patch * center,
                direction: mesh_from_patch * leaf.vector(&leaf.axes, k),
                reach: leaf.radii[k] + rounding,
            };
            let from = ray.origin - blocks.center;
            for axis in 0..3 {
                origin[axis][k] = from[axis] as f32;
                direction[axis][k] = ray.direction[axis] as f32;
            }
            reach[k] = ray.reach as f32;
            behind[k] = leaf.behind[k] as f32;
            limit[k] = limits[k] as f32;
            ray
        });
        let [origin, direction] =
            [origin, direction].map(|vectors| vectors.map(|lanes| Eight::new(&lanes)));
        let (reach, behind) = (Eight::new(&reach), Eight::new(&behind));
        let lines = Lines::new((origin, direction), reach, behind);
        let length = dot(&lines.origin, &lines.origin).largest().sqrt() + lines.reach.largest();
        let slack = (ROUNDING * (blocks.radius + f64::from(length))) as f32;
        let mut used = 0;
        for k in 0..LEAF {
            used |= u32::from(leaf.is_used(k)) << k;
        }
        let ends = Ends::new(&lines, &limit, blocks.radius as f32, slack);
        let active = ends.may_touch.bits() & used;
        if active == 0 {
            return None;
        }
        let (middle, thickness, [top, ahead, cosine]) = thick_line((&lines, &ends), active);
        Some(Self {
            rays,
            lines,
            active,
            middle,
            thickness,
            top: top.largest(),
            ahead,
            cosine,
            slack,
        })
    }

    /// Returns the largest height along the thick line of a taxel's centre when a triangle stops the taxel below its limit, metres.
    #[inline(always)]
    pub fn top(&self, limits: Eight) -> f32 {
        let is_backwards = self.cosine.is_at_most(Eight::splat(STEEP)).bits() != 0;
        let top = (self.ahead + limits * self.cosine).largest();
        if is_backwards { self.top } else { top }
    }
}

/// Heights along lines between which taxels may touch the ball around a mesh, metres.
struct Ends {
    /// Lowest height, whether or not it is behind the substrate.
    far: Eight,
    /// Lowest height at which a triangle stops a taxel in front of the substrate.
    lowest: Eight,
    /// Limits of the search.
    limit: Eight,
    may_touch: Mask,
}

impl Ends {
    #[inline(always)]
    fn new(lines: &Lines, limit: &[f32; LEAF], radius: f32, slack: f32) -> Self {
        let foot = dot(&lines.origin, &lines.direction);
        let square = dot(&lines.origin, &lines.origin);
        let reach = lines.reach + Eight::splat(radius + slack);
        let limit = Eight::new(limit) + Eight::splat(slack);
        let zero = Eight::splat(0.0);
        let far = zero - foot - reach;
        let lowest = far.max(lines.behind);
        // The square is rounded relative to the squared length.
        let beside = square * Eight::splat(1.0 - 1e-5) - foot * foot;
        let may_touch = beside
            .is_at_most(reach * reach)
            .and(lowest.is_at_most(limit))
            .and(lines.behind.is_at_most(reach - foot));
        Self {
            far,
            lowest,
            limit,
            may_touch,
        }
    }
}

/// Returns the thick line around the active lines in all lanes, and its thickness. At least one line is active. The function also returns three values for
/// each lane. They are the largest height of a stopped taxel's centre along the thick line, its height at rest (both metres), and the cosine between axis
/// and thick line.
#[inline(always)]
fn thick_line((lines, ends): (&Lines, &Ends), active: u32) -> (Lines, Thickness, [Eight; 3]) {
    let is_active = Mask::of_bits(active);
    let first = active.trailing_zeros() as usize;
    // Other lanes repeat an active line, so that all lanes count below.
    let pick = |of: Eight| is_active.select(of, Eight::splat(of.to_lanes()[first]));
    let origin = lines.origin.map(pick);
    let direction = lines.direction.map(pick);
    let reach = pick(lines.reach);
    let middle = origin.map(|component| Eight::splat(0.125 * component.sum()));
    let mean = direction.map(Eight::sum);
    let length = (mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2]).sqrt();
    let along = match length > STEEP {
        true => mean.map(|component| Eight::splat(component / length)),
        false => direction.map(|component| Eight::splat(component.to_lanes()[first])),
    };
    let away = difference(&origin, &middle);
    let at = |height: Eight| {
        let height = pick(height);
        [0, 1, 2].map(|axis| away[axis] + height * direction[axis])
    };
    let (low, high, far) = (at(ends.lowest), at(ends.limit), at(ends.far));
    let [across_low, across_high, across_far] =
        [&low, &high, &far].map(|away| cross(away, &along).map(Eight::abs));
    let square = [&across_low, &across_high, &across_far].map(|across| dot(across, across));
    let across = [0, 1, 2].map(|axis| across_low[axis].max(across_high[axis]));
    let near = square[0].max(square[1]);
    let turned = difference(&direction, &along);
    let cosine = dot(&direction, &along);
    let ahead = dot(&away, &along);
    let substrate = ahead + pick(lines.behind) * cosine;
    let is_steep = cosine.is_at_most(Eight::splat(STEEP));
    let substrate = is_steep.select(Eight::splat(f32::INFINITY), substrate);
    let thickness = Thickness {
        across: across.map(Eight::largest),
        radius: near.largest().sqrt(),
        across_far: [0, 1, 2].map(|axis| across[axis].max(across_far[axis]).largest()),
        radius_far: near.max(square[2]).largest().sqrt(),
        cone: dot(&turned, &turned).largest().sqrt(),
        reach: reach.largest() - reach.smallest(),
    };
    // The far end is the highest if a taxel's axis points down along the thick line.
    let [low, high, far] = [low, high, far].map(|away| dot(&away, &along));
    let top = low.max(high).max(far);
    let (reach, behind) = (reach.largest(), substrate.largest());
    let line = Lines::new((middle, along), Eight::splat(reach), Eight::splat(behind));
    let ahead = is_active.select(ahead, Eight::splat(f32::NEG_INFINITY));
    (line, thickness, [top, ahead, cosine])
}
