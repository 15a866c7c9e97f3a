//! Bounds, in vectors of single precision, of the heights at which the triangles of a mesh can stop taxels on given lines.
//!
//! A taxel of radius ρ that a triangle stops has its centre at p + ρ d. Here p is a point of the triangle and d a direction of contact
//! ([`mesh_blocks`](crate::objects::mesh_blocks)). The taxel moves along the unit vector u and comes from below, so d·u < 0. Normals that certainly point
//! down, or up, determine the side of the surface. If the side is not certain, d is any unit vector. Triangles that may lie behind the substrate are
//! enlarged by the whole radius.
//!
//! Let a line have the direction u and contain the point o, and let a box with the half sizes h have its centre at m. The line misses the box if
//! |(m − o) × u| exceeds `h_j |u_k| + h_k |u_j|` in a component i. The functions compare one line with eight boxes, and eight lines with one box. The
//! values of the single line or box are repeated in all lanes.
//!
//! All bounds are enlarged by `slack`, far more than the rounding of single precision, so they never exclude a contact.

use super::eight::{
    Eight, Eight3, Mask, cross, difference, dot, group_of, splat_vector, vectors_of,
};
use super::taxel_lines::{Lines, Thickness};
use crate::objects::mesh_blocks::{Block, BlockNode};

/// Boxes around triangles, with bounds of the directions of contact; one a lane, relative to the centre of the mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Boxes {
    center: Eight3,
    half: Eight3,
    axis: Eight3,
    spread: Eight,
}

/// Triangles with bounds of the directions of contact; one a lane, relative to the centre of the mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangles {
    corners: [Eight3; 3],
    normal: Eight3,
    spread: Eight,
}

/// Pairs of a line and a part of a mesh, one a lane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pairs {
    /// One bit for each pair that may touch.
    pub near: u32,
    /// One bit for each pair whose part may lie behind the substrate.
    pub behind: u32,
    /// Lower bounds of the heights at which the part stops a taxel on the line, metres.
    pub low: Eight,
}

impl Boxes {
    /// Returns the boxes of one group of the children of a node.
    #[inline(always)]
    pub fn of_node(node: &BlockNode, group: usize) -> Self {
        Self {
            center: vectors_of(&node.center, group),
            half: vectors_of(&node.half, group),
            axis: vectors_of(&node.axis, group),
            spread: group_of(&node.spread, group),
        }
    }

    /// Returns the box of one child of a node in all lanes.
    #[inline(always)]
    pub fn of_child(node: &BlockNode, lane: usize) -> Self {
        Self {
            center: splat_vector(&node.center, lane),
            half: splat_vector(&node.half, lane),
            axis: splat_vector(&node.axis, lane),
            spread: Eight::splat(node.spread[lane]),
        }
    }

    /// Compares lines with the boxes. `IS_THICK` is whether the line is a thick line.
    #[inline(always)]
    pub fn compare<const IS_THICK: bool>(
        &self,
        lines: &Lines,
        thickness: &Thickness,
        slack: f32,
    ) -> Pairs {
        let from = difference(&self.center, &lines.origin);
        let along = dot(&from, &lines.direction);
        let size = dot(&self.half, &lines.absolute);
        let heights = [along - size, along + size];
        let up = dot(&self.axis, &lines.direction);
        let contact = Directions::new((up, self.spread), heights[0], lines, (thickness, slack));
        let gap = contact.gap((&from, &self.half, &self.axis), lines, thickness);
        let gap = gap - Eight::splat(2.0 * slack);
        let hidden = lines.behind - lines.reach - heights[1];
        let slack2 = Eight::splat(2.0 * slack);
        let zero = Eight::splat(0.0);
        // Nodes that reach in front of the substrate are examined further.
        let near = match IS_THICK {
            true => gap,
            false => gap.max(hidden - slack2),
        };
        let behind = gap.max(zero - hidden - slack2);
        let low = contact.low(heights[0], up, lines, slack);
        Pairs {
            near: near.is_at_most(zero).bits(),
            behind: behind.is_at_most(zero).bits(),
            low: match IS_THICK {
                true => low,
                false => low.max(contact.entry((&from, &self.half, &self.axis), lines, slack)),
            },
        }
    }
}

impl Triangles {
    /// Returns one group of the triangles of a block.
    #[inline(always)]
    pub fn of_block(block: &Block, group: usize) -> Self {
        let [a, b, c] = &block.corners;
        Self {
            corners: [
                vectors_of(a, group),
                vectors_of(b, group),
                vectors_of(c, group),
            ],
            normal: vectors_of(&block.normal, group),
            spread: group_of(&block.spread, group),
        }
    }

    /// Returns one triangle of a block in all lanes.
    #[inline(always)]
    pub fn of_lane(block: &Block, lane: usize) -> Self {
        let [a, b, c] = &block.corners;
        Self {
            corners: [
                splat_vector(a, lane),
                splat_vector(b, lane),
                splat_vector(c, lane),
            ],
            normal: splat_vector(&block.normal, lane),
            spread: Eight::splat(block.spread[lane]),
        }
    }

    /// Compares lines with the triangles. `IS_THICK` is whether the line is a thick line.
    #[inline(always)]
    pub fn compare<const IS_THICK: bool>(
        &self,
        lines: &Lines,
        thickness: &Thickness,
        slack: f32,
    ) -> Pairs {
        let [a, b, c] = &self.corners;
        let from = [
            difference(a, &lines.origin),
            difference(b, &lines.origin),
            difference(c, &lines.origin),
        ];
        let [a, b, c] = &from;
        let heights = [a, b, c].map(|corner| dot(corner, &lines.direction));
        let bottom = heights[0].min(heights[1]).min(heights[2]);
        let top = heights[0].max(heights[1]).max(heights[2]);
        let up = dot(&self.normal, &lines.direction);
        let contact = Directions::new((up, self.spread), bottom, lines, (thickness, slack));
        let half = Eight::splat(0.5);
        let low = [0, 1, 2].map(|axis| a[axis].min(b[axis]).min(c[axis]));
        let high = [0, 1, 2].map(|axis| a[axis].max(b[axis]).max(c[axis]));
        let middle = [0, 1, 2].map(|axis| half * (low[axis] + high[axis]));
        let size = [0, 1, 2].map(|axis| half * (high[axis] - low[axis]));
        let gap = contact.gap((&middle, &size, &self.normal), lines, thickness);
        let beside = contact.beside_sides(&from, (&self.normal, up), lines, (thickness, slack));
        let slack2 = Eight::splat(2.0 * slack);
        let zero = Eight::splat(0.0);
        let gap = (gap - slack2).max(beside);
        let hidden = lines.behind - lines.reach - top;
        let near = match IS_THICK {
            true => gap,
            false => gap.max(hidden - slack2),
        };
        let behind = gap.max(bottom - lines.behind - slack2);
        Pairs {
            near: near.is_at_most(zero).bits(),
            behind: behind.is_at_most(zero).bits(),
            low: contact.low(bottom, up, lines, slack),
        }
    }
}

/// Lengths by which parts of a mesh are moved along their axes, and by which they are then enlarged, metres.
struct Directions {
    shift: Eight,
    wide: Eight,
    /// Whether a part may lie behind the substrate.
    is_low: Mask,
}

impl Directions {
    /// Determines the directions of contact of parts with the lowest points `bottom`. `up` contains the components of their axes along the lines.
    #[inline(always)]
    fn new(
        (up, spread): (Eight, Eight),
        bottom: Eight,
        lines: &Lines,
        (thickness, slack): (&Thickness, f32),
    ) -> Self {
        let zero = Eight::splat(0.0);
        let reach = lines.reach;
        let is_low = (bottom - reach - Eight::splat(slack)).is_below(lines.behind);
        let is_certain = (spread + Eight::splat(thickness.cone + 1e-5)).is_below(up.abs());
        let side = up.is_below(zero).select(reach, zero - reach);
        let shift = is_low.select(zero, is_certain.select(side, zero));
        let narrow = reach * spread + Eight::splat(thickness.reach);
        let wide = is_low.select(reach, is_certain.select(narrow, reach));
        Self {
            shift,
            wide,
            is_low,
        }
    }

    /// Returns lower bounds of the heights at which parts stop taxels, metres.
    #[inline(always)]
    fn low(&self, bottom: Eight, up: Eight, lines: &Lines, slack: f32) -> Eight {
        // No direction is longer than one.
        (bottom + self.shift * up - self.wide).max(bottom - lines.reach) - Eight::splat(slack)
    }

    /// Returns lower bounds of the heights at which lines enter boxes, metres. `middle` is relative to the lines.
    #[inline(always)]
    fn entry(
        &self,
        (middle, half, axis): (&Eight3, &Eight3, &Eight3),
        lines: &Lines,
        slack: f32,
    ) -> Eight {
        let wide = self.wide + Eight::splat(2.0 * slack);
        let along = |k: usize| {
            let moved = middle[k] + self.shift * axis[k];
            let inverse = lines.inverse[k];
            moved * inverse - (half[k] + wide) * inverse.abs() + lines.floor[k]
        };
        along(0).max(along(1)).max(along(2)) - Eight::splat(slack)
    }

    /// Returns the largest component by which lines pass beside boxes, metres; negative for lines that meet a box. `middle` is relative to the lines.
    #[inline(always)]
    fn gap(
        &self,
        (middle, half, axis): (&Eight3, &Eight3, &Eight3),
        lines: &Lines,
        thickness: &Thickness,
    ) -> Eight {
        let moved = [0, 1, 2].map(|k| middle[k] + self.shift * axis[k]);
        let across = cross(&moved, &lines.direction);
        let [x, y, z] = lines.absolute;
        let size = [
            half[1] * z + half[2] * y,
            half[2] * x + half[0] * z,
            half[0] * y + half[1] * x,
        ];
        let beyond = |k: usize| {
            let (far, near) = (thickness.across_far[k], thickness.across[k]);
            let thick = self.is_low.select(Eight::splat(far), Eight::splat(near));
            across[k].abs() - size[k] - thick
        };
        beyond(0).max(beyond(1)).max(beyond(2)) - self.wide
    }

    /// Returns a positive value for lines that pass beside a triangle, which is moved along its normal and widened. The corners are relative to the lines.
    ///
    /// Seen along the line, the origin is to the left of the side from a to b if a·((b − a) × u) is positive.
    #[inline(always)]
    fn beside_sides(
        &self,
        corners: &[Eight3; 3],
        (normal, up): (&Eight3, Eight),
        lines: &Lines,
        (thickness, slack): (&Thickness, f32),
    ) -> Eight {
        let zero = Eight::splat(0.0);
        let sign = zero
            .is_below(up)
            .select(Eight::splat(-1.0), Eight::splat(1.0));
        let (far, near) = (thickness.radius_far, thickness.radius);
        let thick = self.is_low.select(Eight::splat(far), Eight::splat(near));
        let wide = self.wide + thick + Eight::splat(2.0 * slack);
        let shift = [0, 1, 2].map(|k| self.shift * normal[k]);
        let side = |a: &Eight3, b: &Eight3| {
            let edge = difference(b, a);
            let moved = [a[0] + shift[0], a[1] + shift[1], a[2] + shift[2]];
            let outside = sign * dot(&moved, &cross(&edge, &lines.direction));
            // The length of the side is at most the sum of the components.
            outside - wide * (edge[0].abs() + edge[1].abs() + edge[2].abs())
        };
        let [a, b, c] = corners;
        side(a, b).max(side(b, c)).max(side(c, a))
    }
}
