//! Bounds in single precision that the searches of grids and of leaves share: directions of contact of parts of a mesh, and lines beside boxes.

use glam::{Vec3, Vec3Swizzles};

/// Bound of the rounding errors of single precision, relative to the lengths in the scene. Each bound is computed from about ten numbers, each rounded by 6e-8.
pub(in crate::contact) const SINGLE_ROUNDING: f64 = 4e-6;

/// Returns the vector s of a box with the half sizes h, metres. Let a line have the direction u (unit vector) and contain the point o, and let m be the centre of
/// the box. The line misses the box if |(m − o) × u| exceeds `s_i = h_j |u_k| + h_k |u_j|` in a component i.
#[inline(always)]
pub(in crate::contact) fn half_shadow(half: Vec3, direction: Vec3) -> Vec3 {
    let along = direction.abs();
    half.yzx() * along.zxy() + half.zxy() * along.yzx()
}

/// Directions of contact of a part of a mesh ([`mesh_blocks`](crate::objects::mesh_blocks)), times the radius of a taxel that comes from below.
#[derive(Clone, Copy, Debug)]
pub(in crate::contact) struct Directions {
    /// Length by which the part is moved along its axis, metres; zero if the side of the surface is not certain.
    pub shift: f32,
    /// Radius of the taxel if the side of the surface is not certain, otherwise zero, metres. A component of a direction is then between minus and plus the sum of
    /// the spread and the absolute component of the axis.
    pub both: f32,
    /// Length by which the moved part is enlarged, metres: the whole radius if it may be behind the substrate, because the search then evaluates all triangles.
    pub spread: f32,
    /// Whether the part may lie behind the substrate.
    pub is_low: bool,
}

impl Directions {
    /// Determines the directions of contact of a part with the lowest point `bottom`. `up` is the component of its axis along the taxel's axis. A taxel has the
    /// radius `reach` and its substrate at the height `behind`. Directions of taxels differ by up to `cone`, and `slack` bounds rounding errors. Lengths in metres.
    #[inline(always)]
    pub fn new(
        (up, spread): (f32, f32),
        bottom: f32,
        (reach, behind): (f32, f32),
        (cone, slack): (f32, f32),
    ) -> Self {
        let is_low = bottom - reach - slack < behind;
        let is_certain = (up.abs() > spread + (cone + 1e-5)) & !is_low;
        let side = if up < 0.0 { reach } else { -reach };
        Self {
            shift: if is_certain { side } else { 0.0 },
            both: if is_certain { 0.0 } else { reach },
            spread: reach * (if is_low { 1.0 } else { spread }),
            is_low,
        }
    }
}
