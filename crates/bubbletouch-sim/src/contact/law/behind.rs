//! Rule for obstacles behind the substrate of a taxel, which do not push the taxel.

use super::triangle::stopping_height;
use crate::mesh::Triangle;
use glam::{DVec2, DVec3};

/// Returns whether a sphere can push a taxel. The taxel must meet the sphere (q > 0), and the sphere must not be behind the substrate, whose height is
/// `behind`, metres.
#[inline(always)]
pub(crate) fn is_in_front(q: f64, height: f64, behind: f64) -> bool {
    let gap = (behind - height).max(0.0);
    q > gap * gap
}

/// Returns whether an obstacle can push a taxel: the obstacle is not wholly behind the substrate at height `behind`. `far_side` is the height at which a
/// taxel would touch the obstacle's far side, metres.
#[inline(always)]
pub(crate) fn reaches_front(far_side: f64, behind: f64) -> bool {
    far_side >= behind
}

/// Returns `squares` (m²) with −1 in place of the values of spheres that cannot push their taxel. `heights` are the heights of the spheres, and `behind` is
/// the height of the substrate, metres.
#[inline(always)]
pub(crate) fn squares_in_front<const N: usize>(
    squares: &[f64; N],
    heights: &[f64; N],
    behind: f64,
) -> [f64; N] {
    let (heights, mut squares) = (*heights, *squares);
    for k in 0..N {
        let counts = is_in_front(squares[k], heights[k], behind);
        squares[k] = if counts { squares[k] } else { -1.0 };
    }
    squares
}

/// Returns the height at which a triangle stops a taxel with the radius `reach` at the position `at`, metres.
///
/// Returns `None` if the triangle misses the taxel, or if a taxel on its far side would be behind the substrate at height `behind`, metres.
pub(crate) fn stop_in_front(
    triangle: &Triangle,
    reach: f64,
    at: DVec2,
    behind: f64,
) -> Option<f64> {
    let height = stopping_height(triangle, reach, at)?;
    if reaches_front(height, behind) {
        return Some(height);
    }
    far_side(triangle, reach, at)
        .is_some_and(|far_side| reaches_front(far_side, behind))
        .then_some(height)
}

/// Returns the height of a taxel that touches the far side of a triangle, metres; `None` if the taxel misses the triangle. This is the highest place of
/// contact for a taxel that moves down from above.
pub(crate) fn far_side(triangle: &Triangle, reach: f64, at: DVec2) -> Option<f64> {
    let mirrored = Triangle(triangle.0.map(|v| DVec3::new(v.x, v.y, -v.z)));
    stopping_height(&mirrored, reach, at).map(|height| -height)
}
