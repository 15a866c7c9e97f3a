//! Contact with a sphere: the deflection that it requires, for single taxels and for lanes of N taxels.

use super::behind::is_in_front;
use crate::contact::lanes::SelectedLanes;

/// Factor slightly below 1, by more than the rounding error, for comparisons of squared deflections before a root is taken. If larger, rounding decides
/// comparisons; if smaller, roots are taken needlessly.
const ALMOST: f64 = 1.0 - 1e-12;

/// Returns the deflection √q − h that contact with a sphere requires, metres. The height h is along the taxel's axis. The argument q is the squared sum of
/// radii minus the squared distance from the axis; q must be positive.
#[inline(always)]
pub(crate) fn deflection(q: f64, height: f64) -> f64 {
    q.sqrt() - height
}

/// Returns the deflection that contact with a sphere requires, metres. Returns 0 if the sphere is behind the substrate or misses the taxel, and at most 0 if
/// the sphere is above the taxel.
#[inline(always)]
pub(crate) fn needed(q: f64, height: f64, behind: f64) -> f64 {
    // The root is taken for every value, because selecting between two numbers compiles to a vector instruction and a branch does not.
    let depth = deflection(q.max(0.0), height);
    if is_in_front(q, height, behind) {
        depth
    } else {
        0.0
    }
}

/// Returns a value, m², that is negative if the deflection √q − h, which contact with a sphere requires, may exceed `deflection`. The symbol h is `height`.
#[inline(always)]
fn shortfall(q: f64, height: f64, deflection: f64) -> f64 {
    let bar = (height + deflection).max(0.0);
    bar * bar * ALMOST - q
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
    !SelectedLanes::below(&shortfalls, 0.0).is_empty()
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
    use crate::contact::law::behind::{reaches_front, squares_in_front};
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
                    assert!(beats(&counting, &heights, &before));
                }
            }
        }
        assert!(
            n_counting > 1000 && n_behind > 1000,
            "{n_counting} {n_behind}"
        );
    }
}
