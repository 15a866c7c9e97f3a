//! Lines along the axes of eight neighbouring taxels, in the frame of a mesh.
//!
//! The lines are stored in double precision for evaluation and in single precision for the search. One *thick line* contains all lines. It is the line
//! through the point ō along the unit vector ū, with bounds of the distances of the taxels' centres from the line. Let p(t) = o + t u be the centre of a
//! taxel at the height t. Heights of stops are at most the limit of the search. They are at least the height of the substrate or of the far end of the
//! mesh.

use super::directions::SINGLE_ROUNDING;
use super::skin_mesh::MeshAt;
use crate::contact::lanes::{largest, most};
use crate::world::{LEAF, Leaf};
use glam::{DVec3, Vec3};

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

impl Ray {
    /// Returns the axis of an entry of a leaf.
    #[inline(always)]
    pub fn new(mesh: &MeshAt, leaf: &Leaf, entry: usize) -> Self {
        let mesh_from_patch = mesh.object.rotation.transpose();
        let center = leaf.vector(&leaf.centers, entry);
        Self {
            origin: mesh_from_patch * (center - mesh.object.translation),
            direction: mesh_from_patch * leaf.vector(&leaf.axes, entry),
            reach: leaf.radii[entry] + mesh.object.reach,
        }
    }
}

/// Line in single precision; positions are relative to the centre of the mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    pub origin: Vec3,
    pub direction: Vec3,
    /// Reciprocals of the direction's components; 0 for components that are too small.
    pub inverse: Vec3,
    /// −∞ for components that are too small, otherwise 0.
    pub floor: Vec3,
    /// Sum of a taxel's radius and the rounding of the mesh, metres.
    pub reach: f32,
    /// Height along the line below which a triangle may lie behind the substrate of a taxel, metres.
    pub behind: f32,
}

impl Line {
    #[inline(always)]
    fn new(origin: Vec3, direction: Vec3, reach: f32, behind: f32) -> Self {
        let is_small = direction.abs().cmple(Vec3::splat(SMALL));
        Self {
            origin,
            direction,
            inverse: Vec3::select(is_small, Vec3::ZERO, direction.recip()),
            floor: Vec3::select(is_small, Vec3::NEG_INFINITY, Vec3::ZERO),
            reach,
            behind,
        }
    }
}

/// One number for each taxel of a leaf.
type Eight = [f32; LEAF];

/// Lines of the taxels of a leaf, stored number by number.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Lines {
    origin: [Eight; 3],
    direction: [Eight; 3],
    inverse: [Eight; 3],
    floor: [Eight; 3],
    reach: Eight,
    behind: Eight,
}

impl Lines {
    /// Returns the line of a taxel.
    #[inline(always)]
    pub fn at(&self, taxel: usize) -> Line {
        let vector = |[x, y, z]: &[Eight; 3]| Vec3::new(x[taxel], y[taxel], z[taxel]);
        Line {
            origin: vector(&self.origin),
            direction: vector(&self.direction),
            inverse: vector(&self.inverse),
            floor: vector(&self.floor),
            reach: self.reach[taxel],
            behind: self.behind[taxel],
        }
    }

    #[inline(always)]
    fn set(&mut self, taxel: usize, line: &Line) {
        set(&mut self.origin, taxel, line.origin);
        set(&mut self.direction, taxel, line.direction);
        set(&mut self.inverse, taxel, line.inverse);
        set(&mut self.floor, taxel, line.floor);
        self.reach[taxel] = line.reach;
        self.behind[taxel] = line.behind;
    }
}

#[inline(always)]
fn set([x, y, z]: &mut [Eight; 3], lane: usize, vector: Vec3) {
    (x[lane], y[lane], z[lane]) = (vector.x, vector.y, vector.z);
}

/// Bounds of the deviations of taxels from a thick line; all are 0 for the line of one taxel.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Thickness {
    /// Bounds of |(p(t) − ō) × ū| for the heights t at which triangles stop a taxel, metres. `across` bounds the components, `radius` the length.
    pub across: Vec3,
    pub radius: f32,
    /// Bounds of |(p(t) − ō) × ū| for all heights t at which the line meets the ball around the mesh, metres. `across_far` bounds the components,
    /// `radius_far` the length.
    pub across_far: Vec3,
    pub radius_far: f32,
    /// Largest distance between a taxel's axis and ū.
    pub cone: f32,
    /// Difference of the largest and the smallest reach, metres.
    pub reach: f32,
}

/// Axes of the taxels of a leaf in the frame of a mesh, with a thick line around them.
#[derive(Clone, Copy, Debug)]
pub(super) struct TaxelLines {
    pub lines: Lines,
    /// One bit for each taxel that may touch the mesh.
    pub active: u32,
    pub thick: ThickLine,
    /// Bound of rounding errors, metres.
    pub slack: f32,
}

impl TaxelLines {
    /// Creates the lines of a leaf; `None` if the ball around the mesh is out of the taxels' reach. `limits` are the heights below which stops are searched,
    /// metres.
    #[inline(always)]
    pub fn new(mesh: &MeshAt, leaf: &Leaf, limits: &[f64; LEAF]) -> Option<Self> {
        let blocks = mesh.mesh.blocks();
        let mut lines = Lines::default();
        let mut squares = [0.0; LEAF];
        for (k, square) in squares.iter_mut().enumerate() {
            let ray = Ray::new(mesh, leaf, k);
            let (origin, direction) = (ray.origin - blocks.center, ray.direction);
            let behind = leaf.behind[k] as f32;
            let line = Line::new(
                origin.as_vec3(),
                direction.as_vec3(),
                ray.reach as f32,
                behind,
            );
            lines.set(k, &line);
            *square = line.origin.length_squared();
        }
        let length = largest(&squares).sqrt() + largest(&lines.reach);
        let slack = (SINGLE_ROUNDING * (blocks.radius + f64::from(length))) as f32;
        let ends = Ends::new(&lines, limits, blocks.radius as f32, slack);
        (ends.active != 0).then(|| Self {
            lines,
            active: ends.active,
            thick: ThickLine::new(&lines, &ends),
            slack,
        })
    }
}

/// Heights along lines between which taxels may touch the ball around a mesh, metres.
struct Ends {
    /// Lowest heights, whether or not they are behind the substrate.
    far: Eight,
    /// Lowest heights at which a triangle stops the taxel in front of the substrate.
    lowest: Eight,
    /// Limits of the search.
    limit: Eight,
    /// One bit for each taxel that may touch the ball; unused entries of a leaf have infinitely high substrates and may not.
    active: u32,
}

impl Ends {
    #[inline(always)]
    fn new(lines: &Lines, limits: &[f64; LEAF], radius: f32, slack: f32) -> Self {
        let (mut far, mut lowest, mut limit) = ([0.0; LEAF], [0.0; LEAF], [0.0; LEAF]);
        let mut active = 0;
        for k in 0..LEAF {
            let line = lines.at(k);
            let foot = line.origin.dot(line.direction);
            let reach = line.reach + (radius + slack);
            limit[k] = limits[k] as f32 + slack;
            far[k] = -foot - reach;
            lowest[k] = most(far[k], line.behind);
            // The square is rounded relative to the squared length.
            let beside2 = line.origin.length_squared() * (1.0 - 1e-5) - foot * foot;
            let may_touch = (beside2 <= reach * reach)
                & (lowest[k] <= limit[k])
                & (line.behind <= reach - foot);
            active |= u32::from(may_touch) << k;
        }
        Self {
            far,
            lowest,
            limit,
            active,
        }
    }
}

/// Line that contains the lines of several taxels.
#[derive(Clone, Copy, Debug)]
pub(super) struct ThickLine {
    pub line: Line,
    pub thickness: Thickness,
    /// Largest height of a stopped taxel's centre, measured along the thick line, metres.
    top: f32,
    /// Heights along the thick line of the taxels' centres at rest, metres; −∞ for taxels that are not active.
    ahead: Eight,
    /// Cosines between the taxels' axes and the thick line.
    cosine: Eight,
}

impl ThickLine {
    /// Creates the thick line around the active lines, at least one.
    #[inline(always)]
    fn new(lines: &Lines, ends: &Ends) -> Self {
        let is_active = |k: usize| ends.active >> k & 1 == 1;
        let first = ends.active.trailing_zeros() as usize;
        // Other lanes repeat an active line, so that all lanes count below.
        let pick = |k: usize, values: &Eight| {
            if is_active(k) {
                values[k]
            } else {
                values[first]
            }
        };
        let picked =
            |k: usize, [x, y, z]: &[Eight; 3]| Vec3::new(pick(k, x), pick(k, y), pick(k, z));
        let (mut middle, mut mean) = (Vec3::ZERO, Vec3::ZERO);
        for k in 0..LEAF {
            middle += 0.125 * picked(k, &lines.origin);
            mean += picked(k, &lines.direction);
        }
        let length = mean.length();
        let along = match length > STEEP {
            true => mean / length,
            false => lines.at(first).direction,
        };
        let (mut across, mut across_far) = ([[0.0; LEAF]; 3], [[0.0; LEAF]; 3]);
        let (mut near2, mut far2, mut cone2) = ([0.0; LEAF], [0.0; LEAF], [0.0; LEAF]);
        let (mut top, mut substrate) = ([0.0; LEAF], [0.0; LEAF]);
        let (mut reach, mut minus_reach) = ([0.0; LEAF], [0.0; LEAF]);
        let (mut ahead, mut cosine) = ([0.0; LEAF], [0.0; LEAF]);
        for k in 0..LEAF {
            let direction = picked(k, &lines.direction);
            let away = picked(k, &lines.origin) - middle;
            let low = away + pick(k, &ends.lowest) * direction;
            let high = away + pick(k, &ends.limit) * direction;
            let far = away + pick(k, &ends.far) * direction;
            // The far end is the highest if a taxel's axis points down along the thick line.
            top[k] = most(most(low.dot(along), high.dot(along)), far.dot(along));
            let low = low.cross(along).abs();
            let high = high.cross(along).abs();
            let far = far.cross(along).abs();
            set(&mut across, k, low.max(high));
            set(&mut across_far, k, low.max(high).max(far));
            near2[k] = most(low.length_squared(), high.length_squared());
            far2[k] = most(near2[k], far.length_squared());
            cone2[k] = (direction - along).length_squared();
            cosine[k] = direction.dot(along);
            let height = away.dot(along);
            ahead[k] = if is_active(k) {
                height
            } else {
                f32::NEG_INFINITY
            };
            let behind = height + pick(k, &lines.behind) * cosine[k];
            substrate[k] = if cosine[k] <= STEEP {
                f32::INFINITY
            } else {
                behind
            };
            reach[k] = pick(k, &lines.reach);
            minus_reach[k] = -reach[k];
        }
        let vector = |[x, y, z]: &[Eight; 3]| Vec3::new(largest(x), largest(y), largest(z));
        let (reach, least_reach) = (largest(&reach), -largest(&minus_reach));
        Self {
            line: Line::new(middle, along, reach, largest(&substrate)),
            thickness: Thickness {
                across: vector(&across),
                radius: largest(&near2).sqrt(),
                across_far: vector(&across_far),
                radius_far: largest(&far2).sqrt(),
                cone: largest(&cone2).sqrt(),
                reach: reach - least_reach,
            },
            top: largest(&top),
            ahead,
            cosine,
        }
    }

    /// Returns the largest height along the thick line of a taxel's centre when a triangle stops the taxel below its limit, metres.
    #[inline(always)]
    pub fn top(&self, limits: &Eight) -> f32 {
        let (mut tops, mut is_backwards) = ([0.0; LEAF], false);
        for k in 0..LEAF {
            tops[k] = self.ahead[k] + limits[k] * self.cosine[k];
            is_backwards |= self.cosine[k] <= STEEP;
        }
        if is_backwards {
            self.top
        } else {
            largest(&tops)
        }
    }
}
