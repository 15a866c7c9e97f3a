//! Normal forces from deflections and their rates.

use super::{Effect, TouchRead};
use crate::world::Taxel;

/// Step that converts deflections of these taxels to forces.
#[derive(Debug)]
pub(super) struct Force(pub Taxel);

impl Effect for Force {
    fn apply(&self, frames: &mut [f64], touch: &TouchRead, _: &mut [f64]) {
        force(frames, touch.rates, &self.0);
    }
}

/// Replaces deflections (metres) by normal forces (newtons): f = max(0, k δ + c δ̇) where δ > 0, otherwise 0 \[BT\].
///
/// The argument `rate` is δ̇ in m/s, one value per taxel; `None` if the patch does not move. A free taxel relaxes with k δ + c δ̇ = 0, where k is the
/// stiffness and c the damping. After a step of length Δt, its backward difference gives k δ + c δ̇ ≤ 0, because (1 + a) e⁻ᵃ ≤ 1 with a = k Δt / c. The
/// maximum therefore sets its force to 0, and no list of contacts is needed.
///
/// # Panics
/// If `rate` and `frame` differ in length.
fn force(frame: &mut [f64], rate: Option<&[f64]>, taxel: &Taxel) {
    let Some(rate) = rate else {
        for value in frame {
            *value = (taxel.stiffness * *value).max(0.0);
        }
        return;
    };
    assert_eq!(rate.len(), frame.len(), "one rate for each taxel");
    for (value, rate) in frame.iter_mut().zip(rate) {
        let pushed = *value > 0.0;
        let balance = taxel.stiffness * *value + taxel.damping * rate;
        *value = if pushed { balance.max(0.0) } else { 0.0 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TAXEL: Taxel = Taxel {
        radius: 1e-3,
        stiffness: 200.0,
        damping: 0.5,
        stroke: 5e-3,
    };

    #[test]
    fn force_is_spring_plus_damper_and_never_negative() {
        let mut frame = [0.0, 1e-3, 1e-3, 2e-3, 0.0];
        force(&mut frame, Some(&[0.0, 0.1, -0.1, -10.0, 1.0]), &TAXEL);
        assert_eq!(frame, [0.0, 0.2 + 0.05, 0.2 - 0.05, 0.0, 0.0]);
    }

    #[test]
    fn a_patch_at_rest_is_a_patch_with_zero_rates() {
        let mut at_rest = [0.0, 1e-3, 4e-3];
        let mut with_rates = at_rest;
        force(&mut at_rest, None, &TAXEL);
        force(&mut with_rates, Some(&[0.0; 3]), &TAXEL);
        assert_eq!(at_rest, with_rates);
    }

    #[test]
    fn a_taxel_that_relaxes_freely_feels_no_force() {
        for exponent in -6..3 {
            let dt = 10f64.powi(exponent);
            let before: f64 = 3e-3;
            let after = before * (-TAXEL.stiffness * dt / TAXEL.damping).exp();
            let mut frame = [after];
            force(&mut frame, Some(&[(after - before) / dt]), &TAXEL);
            assert!(frame[0] < 1e-12, "Δt = {dt} s gives {} N", frame[0]);
        }
    }
}
