//! The contact law \[BT\]: how far a sphere deflects a taxel, and which spheres can push a taxel.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | S | ρ + R, radii of taxel and sphere | m |
//! | h | height of the sphere's centre above the taxel's rest centre, along the taxel's axis | m |
//! | b | distance of the sphere's centre from the taxel's axis | m |
//! | q | S² − b² | m² |
//! | B | −s − ρ, height of the substrate ([`Taxel::substrate`](crate::world::Taxel::substrate)) | m |
//!
//! Contact with a sphere requires the deflection `δ = √q − h` ([`deflection`]) where q > 0, unless the sphere is behind the substrate. A taxel that rests on
//! the far side of the sphere has its centre at `h + √q`; the sphere counts if that is above B. Without a root this is
//!
//! ```text
//! q > max(B − h, 0)²
//! ```
//!
//! ([`is_in_front`]). A press from the front has B = −∞: all spheres with q > 0 count.
//!
//! Every layout has its own evaluator of this law. The evaluator finds the pairs of taxels and spheres with q > 0, and shares q and h among taxels. The
//! evaluators are `placed_sphere` (rows of a flat grid), `near_spheres` (leaves of the taxel tree), and `reach` (with derivatives). In `whole_body` they
//! are `row_press` (extrusions), `dome_patch` (rings) and `draped_patch` (tiles). For a mesh the rule is applied to the heights at which the mesh stops a
//! taxel ([`reaches_front`]).

use super::LanesBelow;

/// Returns the deflection, metres, above which a taxel with this stroke (metres) is saturated: the stroke times 1 + 1e-12. The tolerance ensures that a press
/// to a depth of exactly the stroke saturates no taxel.
pub fn saturation_limit(stroke: f64) -> f64 {
    stroke * (1.0 + 1e-12)
}

/// Factor slightly below 1, by more than the rounding error, for comparisons of squared deflections before a root is taken. If larger, rounding decides
/// comparisons; if smaller, roots are taken needlessly.
const ALMOST: f64 = 1.0 - 1e-12;

/// Returns the deflection √q − h that contact with a sphere requires, metres. The height h is along the taxel's axis. The argument q is the squared sum of
/// radii minus the squared distance from the axis; q must be positive.
#[inline(always)]
pub(crate) fn deflection(q: f64, height: f64) -> f64 {
    q.sqrt() - height
}

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
pub(super) fn reaches_front(far_side: f64, behind: f64) -> bool {
    far_side >= behind
}

/// Returns the deflection that contact with a sphere requires, metres. Returns 0 if the sphere is behind the substrate or misses the taxel, and at most 0 if
/// the sphere is above the taxel.
#[inline(always)]
pub(super) fn needed(q: f64, height: f64, behind: f64) -> f64 {
    // The root is taken for every value, because selecting between two numbers compiles to a vector instruction and a branch does not.
    let depth = deflection(q.max(0.0), height);
    if is_in_front(q, height, behind) {
        depth
    } else {
        0.0
    }
}

/// Returns whether contact with a sphere may require more than a given deflection (metres, at least 0), without taking a root. The result `false` is exact.
#[inline(always)]
pub(super) fn may_exceed(q: f64, height: f64, deflection: f64) -> bool {
    shortfall(q, height, deflection) < 0.0
}

/// Returns a value, m², that is negative if the deflection √q − h, which contact with a sphere requires, may exceed `deflection`. The symbol h is `height`.
#[inline(always)]
fn shortfall(q: f64, height: f64, deflection: f64) -> f64 {
    let bar = (height + deflection).max(0.0);
    bar * bar * ALMOST - q
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

/// Returns whether the deflection √q − h, which contact with a sphere requires, may exceed the present deflection in any lane. The symbols q and h are
/// `squares` (m²) and `heights` (metres). The result `false` is exact.
#[inline(always)]
pub(crate) fn beats<const N: usize>(
    squares: &[f64; N],
    heights: &[f64; N],
    deflections: &[f64; N],
) -> bool {
    let (heights, deflections, mut shortfalls) = (*heights, *deflections, [0.0; N]);
    for k in 0..N {
        shortfalls[k] = shortfall(squares[k], heights[k], deflections[k]);
    }
    !LanesBelow::new(&shortfalls, 0.0).is_empty()
}

/// Raises each deflection to √q − h, the deflection that contact with a sphere requires, if this value is larger and q is positive. The symbols q and h are
/// `squares` (m²) and `heights` (metres).
///
/// Indexed loops over local copies let the compiler vectorise this function. Iterator adapters compiled elsewhere would remain function calls, and loops over
/// memory that may alias are not vectorised. The roots of all lanes are taken, because roots of negative numbers cost no more. The maximum avoids a masked
/// store, which takes ten times as long on some processors.
#[inline(always)]
pub(crate) fn indent<const N: usize>(
    squares: &[f64; N],
    heights: &[f64; N],
    deflections: &mut [f64; N],
) {
    let (squares, heights, mut raised) = (*squares, *heights, *deflections);
    for k in 0..N {
        let needed = deflection(squares[k], heights[k]);
        let needed = if squares[k] > 0.0 { needed } else { 0.0 };
        raised[k] = raised[k].max(needed);
    }
    *deflections = raised;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use rand::Rng;

    #[test]
    fn lanes_and_single_taxels_obey_one_law() {
        let mut rng = Seed::new(48).rng();
        let (mut n_counting, mut n_behind) = (0, 0);
        for _ in 0..2000 {
            let squares: [f64; 8] = std::array::from_fn(|_| rng.gen_range(-2e-5..9e-5));
            let heights: [f64; 8] = std::array::from_fn(|_| rng.gen_range(-2e-2..1e-2));
            let before: [f64; 8] = std::array::from_fn(|_| rng.gen_range(0.0..3e-3));
            let behind = -6e-3;
            let counting = squares_in_front(&squares, &heights, behind);
            let mut raised = before;
            indent(&counting, &heights, &mut raised);
            for k in 0..8 {
                let (q, h) = (squares[k], heights[k]);
                // The rule, evaluated with a root.
                let far_side = h + q.max(0.0).sqrt();
                let counts = q > 0.0 && reaches_front(far_side, behind);
                n_counting += usize::from(counts);
                n_behind += usize::from(q > 0.0 && !counts);
                let expected = if counts { q.sqrt() - h } else { 0.0 };
                assert_eq!(needed(q, h, behind), expected);
                assert_eq!(raised[k], before[k].max(expected));
                if raised[k] > before[k] {
                    assert!(may_exceed(q, h, before[k]) && beats(&counting, &heights, &before));
                }
            }
        }
        assert!(
            n_counting > 1000 && n_behind > 1000,
            "{n_counting} {n_behind}"
        );
    }
}
