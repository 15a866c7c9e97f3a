//! Dampers of the taxels: free relaxation and rate-dependent forces.
//!
//! Over a step Δt a free taxel relaxes as `δ → δ e^(−k Δt / c)`, exactly for any Δt. So
//! `δ(t + Δt) = max(δ(t) e^(−k Δt / c), δ*(t + Δt))`.
//! The force is the constant force that moves the taxel to δ(t + Δt) within the step,
//!
//! ```text
//! f = k (δ(t + Δt) − δ(t) φ) / (1 − φ),   φ = e^(−k Δt / c)
//! ```
//!
//! The force is zero exactly if the taxel relaxes freely, and positive if the taxel is pushed. The step thus solves the complementarity
//! problem 0 ≤ f ⟂ gap ≥ 0 of \[PT\] in closed form. The force tends to `k δ + c δ̇` for Δt → 0 and equals `k δ` for c = 0 or at rest.

use crate::world::{Taxel, Taxels};

/// Returns e^(−k Δt / c), the fraction of a free taxel's deflection that remains after `dt` seconds, for stiffness k and damping c; 0 without a damper.
pub fn relaxation_factor(taxel: &Taxel, dt: f64) -> f64 {
    if taxel.damping == 0.0 {
        return 0.0;
    }
    (-taxel.stiffness * dt / taxel.damping).exp()
}

/// Deflections and forces of the taxels of one patch, carried from one time step to the next.
///
/// The state has all taxels, because a damper has no limit below which its taxel counts as at rest. The deflections of a press are in a
/// [`Workspace`](super::Workspace), which the next press overwrites. A [`BodyState`](crate::whole_body::BodyState) stores the ranges of deflected taxels of a skin
/// with millions of taxels, and sets relaxing taxels to rest at [`AT_REST`](crate::whole_body::AT_REST).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DamperState {
    /// Deflection of each taxel, metres, shape (n_taxels,).
    pub deflection: Vec<f64>,
    /// Force of each taxel, newtons, never negative, shape (n_taxels,).
    pub force: Vec<f64>,
}

impl DamperState {
    /// Creates the state of an untouched patch with `n_taxels` taxels.
    pub fn at_rest(n_taxels: usize) -> Self {
        Self {
            deflection: vec![0.0; n_taxels],
            force: vec![0.0; n_taxels],
        }
    }

    /// Advances the state by `dt` seconds (positive). `contact` contains the deflections that the objects require at the end of the step, metres, shape
    /// (n_taxels,).
    ///
    /// # Panics
    /// If `contact`, or a list with one entry per taxel, has another length than the state.
    pub fn step(&mut self, taxels: &Taxels, dt: f64, contact: &[f64]) {
        assert_eq!(contact.len(), self.deflection.len());
        let states = self.deflection.iter_mut().zip(&mut self.force).zip(contact);
        match taxels {
            Taxels::Equal(taxel) => {
                let relaxation = Relaxation::new(taxel, dt);
                for ((deflection, force), &pushed) in states {
                    *force = relaxation.advance(deflection, pushed);
                }
            }
            Taxels::Each(each) => {
                assert_eq!(each.len(), contact.len());
                for (((deflection, force), &pushed), taxel) in states.zip(each) {
                    // Most taxels remain undeflected; this branch skips their exponential.
                    if *deflection == 0.0 && pushed == 0.0 {
                        *force = 0.0;
                        continue;
                    }
                    *force = Relaxation::new(taxel, dt).advance(deflection, pushed);
                }
            }
        }
    }
}

/// Relaxation factors of taxels with equal stiffness and damping, for a time step of fixed length.
pub struct Relaxation {
    stiffness: f64,
    /// Fraction of a free taxel's deflection that remains after the time step.
    left: f64,
    /// Fraction of a free taxel's deflection that is lost during the time step.
    gone: f64,
}

impl Relaxation {
    pub(crate) fn new(taxel: &Taxel, dt: f64) -> Self {
        // Computes 1 − φ without cancellation for steps much shorter than c / k.
        let gone = if taxel.damping == 0.0 {
            1.0
        } else {
            -(-taxel.stiffness * dt / taxel.damping).exp_m1()
        };
        Self {
            stiffness: taxel.stiffness,
            left: relaxation_factor(taxel, dt),
            gone,
        }
    }

    /// Advances the deflection of a taxel to the end of the time step and returns the force, newtons. `pushed` is the deflection that the objects require.
    #[inline]
    fn advance(&self, deflection: &mut f64, pushed: f64) -> f64 {
        let before = *deflection;
        *deflection = (before * self.left).max(pushed);
        self.force(before, *deflection)
    }

    /// Returns the force, newtons, that moves a taxel from the deflection `before` to the deflection `after`, metres, within the time step.
    #[inline]
    pub(crate) fn force(&self, before: f64, after: f64) -> f64 {
        self.stiffness * (after - before * self.left) / self.gone
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taxel(damping: f64) -> Taxels {
        Taxels::Equal(Taxel {
            radius: 1e-3,
            stiffness: 100.0,
            damping,
            stroke: 5e-3,
        })
    }

    #[test]
    fn a_free_taxel_relaxes_the_same_in_one_step_or_a_thousand() {
        let taxel = taxel(0.5);
        let start = DamperState {
            deflection: vec![2e-3],
            force: vec![0.0],
        };
        let mut once = start.clone();
        once.step(&taxel, 0.01, &[0.0]);
        let mut often = start;
        for _ in 0..1000 {
            often.step(&taxel, 1e-5, &[0.0]);
            assert_eq!(often.force[0], 0.0, "nothing pushes");
        }
        let exact = 2e-3 * (-100.0 * 0.01 / 0.5_f64).exp();
        assert!((once.deflection[0] - exact).abs() < 1e-18);
        assert!((often.deflection[0] - exact).abs() < 1e-15);
    }

    #[test]
    fn the_force_tends_to_spring_plus_damper() {
        let taxel = taxel(0.5);
        let (rate, dt) = (0.01, 1e-7);
        let mut state = DamperState {
            deflection: vec![1e-3],
            force: vec![0.0],
        };
        state.step(&taxel, dt, &[1e-3 + rate * dt]);
        let exact = 100.0 * 1e-3 + 0.5 * rate;
        assert!((state.force[0] - exact).abs() < 1e-6 * exact);
    }

    #[test]
    fn a_held_taxel_carries_its_spring_only_and_none_is_ever_pulled() {
        let taxel = taxel(0.5);
        let mut state = DamperState::at_rest(1);
        for step in 0..2000 {
            let pushed = 1e-3 * (0.01 * f64::from(step)).sin().max(0.0);
            state.step(&taxel, 1e-3, &[pushed]);
            assert!(state.force[0] >= 0.0);
            assert!(state.deflection[0] >= pushed);
        }
        state.step(&taxel, 1e-3, &[2e-3]);
        state.step(&taxel, 1e-3, &[2e-3]);
        assert!((state.force[0] - 0.2).abs() < 1e-15);
    }

    #[test]
    fn a_step_of_any_length_stays_within_stroke_and_contact() {
        let taxel = taxel(0.5);
        for dt in [1e-12, 1e-6, 1.0, 1e12] {
            let mut state = DamperState {
                deflection: vec![4e-3],
                force: vec![0.0],
            };
            state.step(&taxel, dt, &[1e-3]);
            assert!((1e-3..=4e-3).contains(&state.deflection[0]), "{dt}");
            assert!(state.force[0].is_finite());
        }
    }

    #[test]
    fn equal_taxels_one_each_move_exactly_as_one_for_all() {
        let Taxels::Equal(soft) = taxel(0.5) else {
            panic!("one for all")
        };
        let stiff = Taxel {
            stiffness: 400.0,
            ..soft
        };
        let dry = Taxel {
            damping: 0.0,
            ..soft
        };
        let pushed = |step: usize| 1e-3 * (0.3 * step as f64).sin().max(0.0);
        let mut mixed = DamperState::at_rest(3);
        let mut alone = [
            DamperState::at_rest(1),
            DamperState::at_rest(1),
            DamperState::at_rest(1),
        ];
        for step in 0..100 {
            let each = vec![soft, stiff, dry];
            mixed.step(&Taxels::Each(each.clone()), 1e-3, &[pushed(step); 3]);
            for (k, state) in alone.iter_mut().enumerate() {
                state.step(&Taxels::Equal(each[k]), 1e-3, &[pushed(step)]);
                assert_eq!(mixed.deflection[k], state.deflection[0]);
                assert_eq!(mixed.force[k], state.force[0]);
            }
        }
        assert!(mixed.deflection[0] != mixed.deflection[1]);
    }
}
