//! Closed-form motion of a spring with dry friction in a plane, dragged along a straight line.
//!
//! The spring's deflection u lies in a disc: `|u| ≤ r`, r = μ f / k_t. The dragging point moves by Δ = L e (|e| = 1) at a constant speed, with constant r.
//! Inside the disc the spring's end sticks, and u grows by the motion. If u is on the rim and the motion points outwards, the end slips
//! against the force: `u̇ = e − (e·û) û`. With φ the angle from e to u, this gives `r φ' = −sin φ`, so
//!
//! ```text
//! tan(φ/2) = tan(φ₀/2) e^(−s / r)
//! ```
//!
//! at the distance s after the end reached the rim: u turns until it points along the motion. One step along a straight path therefore equals many
//! steps. If u is parallel to the motion, the solution is the usual radial return. If r has decreased, u is first
//! returned radially to the new disc: backward Euler for the normal force.

use glam::DVec2;

/// Factor by which rounding may move the spring's end beyond the friction disc without counting as slip. If larger, creep counts as sticking; if smaller, an
/// end that stays on the rim of the disc counts as slipping.
const ROUNDING: f64 = 1.0 + 1e-12;

/// State of a friction spring's end after the object has dragged it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Dragged {
    /// Displacement of the spring's end, metres, at most the radius of the friction disc.
    pub displacement: DVec2,
    /// Whether the spring's end slipped while it was dragged.
    pub has_slipped: bool,
}

/// Drags the spring's end from `displacement` by `motion`, with the radius `limit` ≥ 0 of the friction disc; all in metres.
pub(crate) fn drag(displacement: DVec2, motion: DVec2, limit: f64) -> Dragged {
    let is_outside = displacement.length() > limit * ROUNDING;
    let start = within(displacement, limit);
    let trial = start + motion;
    let has_slipped = is_outside || trial.length() > limit * ROUNDING;
    let displacement = if trial.length() <= limit * ROUNDING {
        within(trial, limit)
    } else {
        slide(start, motion, limit)
    };
    Dragged {
        displacement,
        has_slipped,
    }
}

fn within(displacement: DVec2, limit: f64) -> DVec2 {
    let length = displacement.length();
    if length <= limit {
        return displacement;
    }
    displacement * (limit / length)
}

/// Moves the spring's end from inside the friction disc to its rim, and then along the rim.
fn slide(start: DVec2, motion: DVec2, limit: f64) -> DVec2 {
    if limit == 0.0 {
        return DVec2::ZERO;
    }
    let length = motion.length();
    let along = motion / length;
    let ahead = start.dot(along);
    let aside = start - ahead * along;
    let beside = aside.length().min(limit);
    let rim = (limit * limit - beside * beside).sqrt();
    let slipped = (length - (rim - ahead).max(0.0)).max(0.0);
    let half = beside / (limit + rim) * (-slipped / limit).exp();
    let (cos, sin) = (
        (1.0 - half * half) / (1.0 + half * half),
        2.0 * half / (1.0 + half * half),
    );
    within(
        limit * (cos * along + sin * aside.normalize_or_zero()),
        limit,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use rand::Rng;

    /// Returns a random start inside a disc, a random motion, and the disc's radius.
    fn random_case(case: u64) -> (DVec2, DVec2, f64) {
        let mut rng = Seed::new(5).named("drag").numbered(case).rng();
        let mut random =
            |size: f64| DVec2::new(rng.gen_range(-size..size), rng.gen_range(-size..size));
        let (start, motion) = (random(1e-3), random(3e-3));
        let limit = start.length() * rng.gen_range(1.0..2.0);
        (start, motion, limit)
    }

    #[test]
    fn a_drag_is_the_limit_of_many_small_radial_returns() {
        let mut n_slipped = 0;
        for case in 0..200 {
            let (start, motion, limit) = random_case(case);
            let dragged = drag(start, motion, limit);
            let n = 20_000;
            let step = motion / f64::from(n);
            let slow = (0..n).fold(start, |u, _| within(u + step, limit));
            assert!(
                dragged.displacement.distance(slow) < 1e-3 * limit,
                "case {case}"
            );
            n_slipped += usize::from(dragged.has_slipped);
        }
        assert!((50..200).contains(&n_slipped), "{n_slipped}");
    }

    #[test]
    fn one_drag_along_a_line_is_many() {
        for case in 0..500 {
            let (start, motion, limit) = random_case(case);
            let once = drag(start, motion, limit).displacement;
            for n in [2, 7, 100] {
                let step = motion / f64::from(n);
                let often = (0..n).fold(start, |u, _| drag(u, step, limit).displacement);
                assert!(
                    once.distance(often) < 1e-13 * limit,
                    "case {case}, {n} steps"
                );
            }
        }
    }

    #[test]
    fn no_drag_leaves_the_disc_or_makes_energy() {
        for case in 0..2000 {
            let (start, motion, limit) = random_case(case);
            for limit in [limit, 0.3 * limit, 1e-300, 0.0] {
                let motion = motion * 10f64.powi((case % 40) as i32 - 20);
                let Dragged {
                    displacement: u, ..
                } = drag(start, motion, limit);
                assert!(
                    u.length() <= limit * (1.0 + 1e-15),
                    "case {case}: {u} {limit}"
                );
                let stored = 0.5 * (u.length_squared() - start.length_squared());
                assert!(u.dot(motion) >= stored - 1e-20, "case {case}");
            }
        }
    }

    #[test]
    fn what_is_not_moved_does_not_slip() {
        for case in 0..200 {
            let (start, motion, limit) = random_case(case);
            let rest = drag(start, motion, limit).displacement;
            let still = drag(rest, DVec2::ZERO, limit);
            assert!(still.displacement.distance(rest) < 1e-15 * limit && !still.has_slipped);
        }
    }
}
