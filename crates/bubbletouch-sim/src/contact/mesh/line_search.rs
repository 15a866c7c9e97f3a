//! Bounds, in single precision, of the heights at which the triangles of a mesh can stop taxels on given lines.
//!
//! A taxel of radius ρ that a triangle stops has its centre at p + ρ d. Here p is a point of the triangle and d a direction of contact
//! ([`mesh_blocks`](crate::objects::mesh_blocks)). The taxel moves along the unit vector u and comes from below, so d·u < 0. Normals that certainly point
//! down, or up, determine the side of the surface. If the side is not certain, d is any unit vector. Triangles that may lie behind the substrate are
//! enlarged by the whole radius.
//!
//! The functions have no branches: loops that compare one line with all parts of a node, or all lines with one part, become vector instructions. A function
//! that contains such a loop and returns its [`Pairs`] does not: the loops are written where the pairs are used.
//!
//! All bounds are enlarged by `slack`, far more than the rounding of single precision, so they never exclude a contact.

use super::directions::{Directions, half_shadow};
use super::taxel_lines::{Line, Thickness};
use crate::contact::lanes::{least, most};
use crate::objects::mesh_blocks::{Block, BlockNode, vector};
use glam::Vec3;

/// Box around triangles, with a bound of the directions of contact, relative to the centre of the mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    center: Vec3,
    half: Vec3,
    axis: Vec3,
    spread: f32,
}

/// Triangle with a bound of the directions of contact, relative to the centre of the mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facet {
    corners: [Vec3; 3],
    normal: Vec3,
    spread: f32,
}

/// Comparison of a line with a part of a mesh.
pub(super) struct Comparison {
    /// Whether a taxel on the line may touch the part.
    is_near: bool,
    /// Whether the part may lie behind the substrate.
    is_behind: bool,
    /// Lower bound of the heights at which the part stops a taxel on the line, metres.
    low: f32,
}

/// Comparisons of `N` pairs of a line and a part of a mesh, one a lane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pairs<const N: usize> {
    /// One bit for each pair that may touch.
    pub near: u32,
    /// One bit for each pair whose part may lie behind the substrate.
    pub behind: u32,
    /// Lower bounds of the heights at which the part stops a taxel on the line, metres.
    pub low: [f32; N],
}

impl<const N: usize> Pairs<N> {
    pub const NONE: Self = Self {
        near: 0,
        behind: 0,
        low: [f32::NEG_INFINITY; N],
    };

    /// Sets the pair of a lane, which must not have been set before.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, comparison: Comparison) {
        self.near |= u32::from(comparison.is_near) << lane;
        self.behind |= u32::from(comparison.is_behind) << lane;
        self.low[lane] = comparison.low;
    }
}

impl Bounds {
    /// Returns the box of a child of a node.
    #[inline(always)]
    pub fn of_child(node: &BlockNode, lane: usize) -> Self {
        Self {
            center: vector(&node.center, lane),
            half: vector(&node.half, lane),
            axis: vector(&node.axis, lane),
            spread: node.spread[lane],
        }
    }

    /// Compares a line with the box. `IS_THICK` is whether the line is a thick line.
    #[inline(always)]
    pub fn compare<const IS_THICK: bool>(
        &self,
        line: &Line,
        thickness: &Thickness,
        slack: f32,
    ) -> Comparison {
        let from = self.center - line.origin;
        let along = from.dot(line.direction);
        let size = self.half.dot(line.direction.abs());
        let (bottom, top) = (along - size, along + size);
        let up = self.axis.dot(line.direction);
        let contact = Contact::new((up, self.spread), bottom, line, (thickness, slack));
        let moved = from + contact.shift * self.axis;
        let is_met = contact.gap(moved, self.half, line, thickness) <= 2.0 * slack;
        let hidden = line.behind - line.reach - top;
        let low = contact.low(bottom, up, line, slack);
        Comparison {
            // Nodes that reach in front of the substrate are examined further.
            is_near: is_met & (IS_THICK | (hidden <= 2.0 * slack)),
            is_behind: is_met & (-hidden <= 2.0 * slack),
            low: match IS_THICK {
                true => low,
                false => most(low, contact.entry(moved, self.half, line, slack)),
            },
        }
    }
}

impl Facet {
    /// Returns a triangle of a block.
    #[inline(always)]
    pub fn of_block(block: &Block, lane: usize) -> Self {
        let [a, b, c] = &block.corners;
        Self {
            corners: [vector(a, lane), vector(b, lane), vector(c, lane)],
            normal: vector(&block.normal, lane),
            spread: block.spread[lane],
        }
    }

    /// Compares a line with the triangle. `IS_THICK` is whether the line is a thick line.
    #[inline(always)]
    pub fn compare<const IS_THICK: bool>(
        &self,
        line: &Line,
        thickness: &Thickness,
        slack: f32,
    ) -> Comparison {
        let [a, b, c] = self.corners;
        let [a, b, c] = [a - line.origin, b - line.origin, c - line.origin];
        let along = line.direction;
        let heights = [a.dot(along), b.dot(along), c.dot(along)];
        let bottom = least(least(heights[0], heights[1]), heights[2]);
        let top = most(most(heights[0], heights[1]), heights[2]);
        let up = self.normal.dot(along);
        let contact = Contact::new((up, self.spread), bottom, line, (thickness, slack));
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let shift = contact.shift * self.normal;
        let middle = 0.5 * (low + high) + shift;
        let gap = contact.gap(middle, 0.5 * (high - low), line, thickness);
        let beside = contact.beside_sides([a, b, c], (shift, up), line, (thickness, slack));
        let is_met = (gap <= 2.0 * slack) & (beside <= 0.0);
        let hidden = line.behind - line.reach - top;
        Comparison {
            is_near: is_met & (IS_THICK | (hidden <= 2.0 * slack)),
            is_behind: is_met & (bottom - line.behind <= 2.0 * slack),
            low: contact.low(bottom, up, line, slack),
        }
    }
}

/// Lengths by which a part of a mesh is moved along its axis, and by which it is then enlarged, metres.
struct Contact {
    shift: f32,
    wide: f32,
    /// Whether the part may lie behind the substrate.
    is_low: bool,
}

impl Contact {
    /// Determines the directions of contact of a part with the lowest point `bottom`. `up` is the component of its axis along the line.
    #[inline(always)]
    fn new(
        up_and_spread: (f32, f32),
        bottom: f32,
        line: &Line,
        (thickness, slack): (&Thickness, f32),
    ) -> Self {
        let taxel = (line.reach, line.behind);
        let directions = Directions::new(up_and_spread, bottom, taxel, (thickness.cone, slack));
        let narrow = directions.spread + thickness.reach;
        Self {
            shift: directions.shift,
            wide: if directions.both > 0.0 {
                line.reach
            } else {
                narrow
            },
            is_low: directions.is_low,
        }
    }

    /// Returns a lower bound of the height at which the part stops a taxel, metres.
    #[inline(always)]
    fn low(&self, bottom: f32, up: f32, line: &Line, slack: f32) -> f32 {
        // No direction is longer than one.
        most(bottom + self.shift * up - self.wide, bottom - line.reach) - slack
    }

    /// Returns a lower bound of the height at which the line enters a box, metres. `middle` is the centre of the moved box, relative to the line.
    #[inline(always)]
    fn entry(&self, middle: Vec3, half: Vec3, line: &Line, slack: f32) -> f32 {
        let wide = half + (self.wide + 2.0 * slack);
        let entries = middle * line.inverse - wide * line.inverse.abs() + line.floor;
        most(most(entries.x, entries.y), entries.z) - slack
    }

    /// Returns the largest component by which the line passes beside a box, metres; negative for a line that meets the box. `middle` is the centre of the moved
    /// box, relative to the line.
    #[inline(always)]
    fn gap(&self, middle: Vec3, half: Vec3, line: &Line, thickness: &Thickness) -> f32 {
        let size = half_shadow(half, line.direction);
        let thick = if self.is_low {
            thickness.across_far
        } else {
            thickness.across
        };
        let beyond = middle.cross(line.direction).abs() - size - thick;
        most(most(beyond.x, beyond.y), beyond.z) - self.wide
    }

    /// Returns a positive value for a line that passes beside a triangle, which is moved by `shift` and widened. The corners are relative to the line.
    ///
    /// Seen along the line, the origin is to the left of the side from a to b if a·((b − a) × u) is positive.
    #[inline(always)]
    fn beside_sides(
        &self,
        [a, b, c]: [Vec3; 3],
        (shift, up): (Vec3, f32),
        line: &Line,
        (thickness, slack): (&Thickness, f32),
    ) -> f32 {
        let sign = if up > 0.0 { -1.0 } else { 1.0 };
        let thick = if self.is_low {
            thickness.radius_far
        } else {
            thickness.radius
        };
        let wide = self.wide + thick + 2.0 * slack;
        let mut beside = f32::NEG_INFINITY;
        for (a, b) in [(a, b), (b, c), (c, a)] {
            let edge = b - a;
            let outside = sign * (a + shift).dot(edge.cross(line.direction));
            // The length of the side is at most the sum of the components.
            beside = most(
                beside,
                outside - wide * (edge.x.abs() + edge.y.abs() + edge.z.abs()),
            );
        }
        beside
    }
}
