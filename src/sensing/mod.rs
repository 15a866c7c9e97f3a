//! Sensing: frames → measurements `y = Φx`.

use serde::{Deserialize, Serialize};

/// How measurements are made from a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ensemble {
    /// Independent Gaussian entries.
    Gaussian,
    /// Scrambled block Hadamard [SBHE].
    Sbhe,
    /// Averages over blocks of neighbouring taxels.
    BlockAverage,
    /// Some taxels, drawn without replacement.
    Subsample,
    /// The frame itself.
    Identity,
}
