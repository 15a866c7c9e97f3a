//! Signal: deflections → frames.
//!
//! A [`Chain`] is a list of [`SignalStep`]s, applied to one frame at a time in the order in which the study lists them.
//! A frame is ny × nx numbers, one per taxel, row = patch y, ascending, stored row after row.
//!
//! | step | equation | symbols |
//! |---|---|---|
//! | [`Force`](SignalStep::Force) | fᵢ = max(0, k δᵢ + c δ̇ᵢ) where δᵢ > 0, else 0 \[BT\] | k N/m, c N·s/m, δ m, δ̇ m/s |
//! | [`Noise`](SignalStep::Noise) | xᵢ ← xᵢ + σ zᵢ, zᵢ ~ N(0, 1), independent | σ in the frame's unit |
//! | [`Smoothing`](SignalStep::Smoothing) | x ← G_w ∗ x along y, then along x | w metres |
//!
//! **Units.** A chain starts from deflections in metres. `Force` turns them into newtons, once. [`Noise`] turns its
//! standard deviation into whichever unit the frame has by then.
//!
//! **Randomness.** The draws z belong to a touch (a [`Seed`](crate::random::Seed)) and to the place among the chain's noise steps, never to
//! the level σ: two chains that differ in σ alone add the same pattern, louder or quieter, so a sweep over noise
//! compares like with like.
//!
//! **A further hardware model** (gain mismatch, drift, crosstalk, quantisation …) is one more file with one more variant.
//! What belongs to one piece of hardware and is the same on each touch is drawn in [`Chain::new`]; what changes from
//! touch to touch is drawn in [`Chain::apply`].

mod chain;
mod force;
mod noise;
mod smoothing;

pub use chain::{Chain, Scratch, SignalStep};
pub use force::force;
pub use noise::{Noise, NoiseUnit};
pub use smoothing::Smoothing;

/// What the numbers of a frame are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Metres.
    Deflection,
    /// Newtons.
    Force,
}

impl Quantity {
    /// Shown value = stored value × this: deflections are shown in millimetres.
    pub fn factor(self) -> f64 {
        match self {
            Self::Deflection => 1e3,
            Self::Force => 1.0,
        }
    }

    /// The unit of the shown value.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Deflection => "mm",
            Self::Force => "N",
        }
    }

    /// The name of the shown value.
    pub fn name(self) -> &'static str {
        match self {
            Self::Deflection => "deflection",
            Self::Force => "force",
        }
    }
}
