//! End of a search that no longer gains.
//!
//! Contacts of meshes begin and end where a corner passes the border of a face. A search among such contacts can go on for ever with tiny or no gains, so these rules
//! end it. Contacts of spheres have no borders, and their searches converge without such rules.

/// Number of poses after which a descent that gains less than [`STAGNANT_GAIN`] ends, and the multipliers are updated. If larger, a search that does not converge takes
/// longer; if smaller, multipliers are updated far from the minimum.
const STAGNANT_STEPS: usize = 100;
/// Least decrease of the energy within [`STAGNANT_STEPS`] poses, relative to the sum of weights times radii.
const STAGNANT_GAIN: f64 = 1e-6;
/// Number of updates of the multipliers without halving the residuals after which a search ends. If larger, failures take longer; if smaller, a search that would
/// still converge ends.
const STAGNANT_ROUNDS: usize = 10;

/// Gain of one descent since it was last checked.
pub(super) struct DescentGain {
    n_steps: usize,
    descended: f64,
    least: f64,
}

impl DescentGain {
    /// Starts after `n_steps` poses and a decrease of the energy by `descended` joules. `size` is the sum of weights times radii, joules.
    pub fn new((n_steps, descended): (usize, f64), size: f64) -> Self {
        Self {
            n_steps,
            descended,
            least: STAGNANT_GAIN * size,
        }
    }

    /// Returns whether the energy decreased by too little within the last [`STAGNANT_STEPS`] poses.
    pub fn is_stagnant(&mut self, (n_steps, descended): (usize, f64)) -> bool {
        if n_steps < self.n_steps + STAGNANT_STEPS {
            return false;
        }
        let gain = descended - self.descended;
        (self.n_steps, self.descended) = (n_steps, descended);
        gain < self.least
    }
}

/// Decrease of the residuals in successive updates of the multipliers.
pub(super) struct ResidualDecrease {
    least: f64,
    n_rounds: usize,
}

impl ResidualDecrease {
    pub fn new() -> Self {
        Self {
            least: f64::INFINITY,
            n_rounds: 0,
        }
    }

    /// Returns whether [`STAGNANT_ROUNDS`] updates have not halved the residual. `residual` is the present one, relative to the accepted one.
    pub fn is_stagnant(&mut self, residual: f64) -> bool {
        self.n_rounds += 1;
        if residual < 0.5 * self.least {
            (self.least, self.n_rounds) = (residual, 0);
        }
        self.n_rounds >= STAGNANT_ROUNDS
    }
}
