//! Signal: deflections → frames: force, noise, smoothing, in the order in which the study lists them.

use serde::{Deserialize, Serialize};

/// What a noise standard deviation is measured in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NoiseUnit {
    /// A fraction of the full scale: the stroke, or the stroke times the stiffness for forces.
    FullScale,
    /// Millimetres of deflection.
    Mm,
    /// Newtons of force.
    N,
}
