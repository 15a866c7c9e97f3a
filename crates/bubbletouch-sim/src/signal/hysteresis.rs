//! Hysteresis: during unloading, a taxel reads a higher value than during loading at equal depth.
//!
//! The hysteresis is a Prandtl–Ishlinskii model, as fitted to tactile sensors \[GPI\]: y = (1 − 4w) x + w Σⱼ Pⱼ(x). The sum is over eight play operators
//! with thresholds rⱼ = (j − ½) X/8, where X is the full scale. A play operator starts at 0 and follows its input at a distance of at most rⱼ: Pⱼ ← max(x −
//! rⱼ, min(x + rⱼ, Pⱼ)). The model is rate-independent: only the turning points of the input matter.
//!
//! - The first loading of a fresh taxel follows y = (1 − 4w) x + w Σ max(0, x − rⱼ). This curve has no history and reaches X at the full scale.
//! - Cycles between 0 and X form a closed loop of width w X in its middle and area 11/16 w X².
//! - A taxel does not return to 0 after a press. The residual is 2 w X after a full press, and a quarter of this value after a press of half the depth. It
//!   remains until the taxel is pressed deeper. The readings of a touch therefore depend on the touches before it. (Skins that recover with time lie
//!   between this model and a fresh skin.)

use super::sensor_error::{Effect, ErrorAbout, Strength, TouchRead};

/// Number of play operators in the hysteresis model. If the value is smaller, the hysteresis loop has visible corners; if the value is larger, the cost
/// increases.
const N_PLAYS: usize = 8;
/// Largest width of the hysteresis loop for which all weights of the model are positive. Above this width, the reading would fall while the load increases.
const MAX_WIDTH: f64 = 0.25;

/// Hysteresis with one loop width, for frames with one full scale.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Hysteresis {
    /// Width of the hysteresis loop, a fraction of the full scale.
    width: f64,
    /// Thresholds of the play operators, in the unit of the frame.
    thresholds: [f64; N_PLAYS],
}

impl Hysteresis {
    /// Prepares a hysteresis model. `width` is the width of the loop, as a fraction of the full scale from 0 to 0.25. `full_scale` is in the unit of the
    /// frames.
    fn new(width: f64, full_scale: f64) -> Self {
        let threshold = |j: usize| (j as f64 + 0.5) * full_scale / N_PLAYS as f64;
        Self {
            width,
            thresholds: std::array::from_fn(threshold),
        }
    }

    /// Replaces true values by readings with hysteresis, starting with unloaded taxels. `frames` has n_taxels values per frame, frames in the order of time.
    ///
    /// # Panics
    /// If `n_taxels` is zero or a frame is incomplete.
    fn follow(&self, frames: &mut [f64], n_taxels: usize) {
        assert!(
            frames.len().is_multiple_of(n_taxels),
            "one value for each taxel"
        );
        let direct = 1.0 - self.width * N_PLAYS as f64 / 2.0;
        for taxel in 0..n_taxels {
            let mut plays = [0.0f64; N_PLAYS];
            for value in frames[taxel..].iter_mut().step_by(n_taxels) {
                let mut sum = 0.0;
                for (play, r) in plays.iter_mut().zip(self.thresholds) {
                    *play = (*value - r).max(play.min(*value + r));
                    sum += *play;
                }
                *value = direct * *value + self.width * sum;
            }
        }
    }
}

pub(super) const ABOUT: ErrorAbout = ErrorAbout {
    remembers: true,
    ..ErrorAbout::new(
        "hysteresis",
        &[Strength {
            range: [0.0, MAX_WIDTH],
            allowed: "a fraction of the full scale, 0 to 0.25",
            names: &[],
            ..Strength::fraction("hysteresis_full_scale", "hysteresis")
        }],
        |&[width, _], skin| Ok(Box::new(Hysteresis::new(width, skin.full_scale))),
    )
};

impl Effect for Hysteresis {
    fn apply(&self, frames: &mut [f64], touch: &TouchRead, _: &mut [f64]) {
        self.follow(frames, touch.n_taxels);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FULL_SCALE: f64 = 5e-3;

    /// Returns the readings with hysteresis of one taxel for a sequence of deflections.
    fn read(width: f64, felt: &[f64]) -> Vec<f64> {
        let mut frames = felt.to_vec();
        Hysteresis::new(width, FULL_SCALE).follow(&mut frames, 1);
        frames
    }

    /// Returns `steps` + 1 equally spaced values from `a` to `b`, both included.
    fn ramp(a: f64, b: f64, steps: usize) -> Vec<f64> {
        (0..=steps)
            .map(|i| a + (b - a) * i as f64 / steps as f64)
            .collect()
    }

    #[test]
    fn a_cycle_between_zero_and_full_scale_is_a_closed_loop_of_the_asked_width_and_area() {
        let steps = 1600;
        let (up, down) = (ramp(0.0, FULL_SCALE, steps), ramp(FULL_SCALE, 0.0, steps));
        let felt = [up.clone(), down.clone(), up.clone(), down.clone()].concat();
        for width in [0.01, 0.1, 0.25] {
            let out = read(width, &felt);
            let branches: Vec<&[f64]> = out.chunks_exact(steps + 1).collect();
            let (unloading, loading, again) = (branches[1], branches[2], branches[3]);
            // The second cycle ends where the first did: the loop is closed.
            assert_eq!(unloading.last(), loading.first());
            for (first, second) in unloading.iter().zip(again) {
                assert!((first - second).abs() < 1e-15);
            }
            let gap: Vec<f64> = loading
                .iter()
                .zip(unloading.iter().rev())
                .map(|(loading, unloading)| unloading - loading)
                .collect();
            assert!(gap.iter().all(|&g| g > -1e-15));
            assert!((gap[steps / 2] - width * FULL_SCALE).abs() < 1e-15);
            let widest = gap.iter().copied().fold(0.0, f64::max);
            assert!((widest - width * FULL_SCALE).abs() < 1e-15);
            let area = gap.iter().sum::<f64>() * FULL_SCALE / steps as f64;
            let expected = 11.0 / 16.0 * width * FULL_SCALE.powi(2);
            assert!((area / expected - 1.0).abs() < 1e-4, "{area} {expected}");
        }
    }

    #[test]
    fn a_fresh_skin_reads_zero_at_zero_the_full_scale_at_full_scale_and_more_when_pressed_more() {
        for width in [0.0, 0.1, 0.25] {
            let felt = ramp(0.0, FULL_SCALE, 100);
            let out = read(width, &felt);
            assert_eq!(out[0], 0.0);
            assert!((out[100] - FULL_SCALE).abs() < 1e-17);
            assert!(out.windows(2).all(|w| w[1] >= w[0]));
            // A direct press equals the end of a slow press, because only turning points of the load matter.
            for (deflection, slow) in felt.iter().zip(&out) {
                assert!((read(width, &[*deflection])[0] - slow).abs() < 1e-17);
            }
        }
    }

    #[test]
    fn a_small_load_before_a_larger_one_is_forgotten() {
        let out = read(0.2, &[2e-3, 0.0, 4e-3]);
        assert!((out[2] - read(0.2, &[4e-3])[0]).abs() < 1e-18);
        // A larger press affects later readings, at zero and under a smaller load.
        let after = read(0.2, &[FULL_SCALE, 0.0, 2e-3]);
        assert!((after[1] - 2.0 * 0.2 * FULL_SCALE).abs() < 1e-15);
        assert!(after[2] > read(0.2, &[2e-3])[0] + 0.05e-3);
    }

    #[test]
    fn each_taxel_has_a_history_of_its_own() {
        let mut frames = [4e-3, 1e-3, 0.0, 3e-3, 2e-3, 0.0];
        Hysteresis::new(0.1, FULL_SCALE).follow(&mut frames, 2);
        let first = read(0.1, &[4e-3, 0.0, 2e-3]);
        let second = read(0.1, &[1e-3, 3e-3, 0.0]);
        assert_eq!([frames[0], frames[2], frames[4]], first[..]);
        assert_eq!([frames[1], frames[3], frames[5]], second[..]);
    }
}
