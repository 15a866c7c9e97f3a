//! Signal: converts deflections to the frames that a sensor reads.
//!
//! A [`Chain`] is a list of [`SignalStep`]s, applied to one frame at a time in the order in which the study lists them. A frame has one number per taxel. On a
//! grid its shape is ny × nx, row = patch y, ascending, stored row after row; on other layouts it has the order of the layout. On a layout other than a grid,
//! crosstalk and smoothing use the [neighbours](crate::world::Neighbours); a matrix readout needs a grid.
//!
//! | step | equation | symbols |
//! |---|---|---|
//! | [`Force`](SignalStep::Force) | fᵢ = max(0, k δᵢ + c δ̇ᵢ) where δᵢ > 0, else 0 \[BT\] | k N/m, c N·s/m, δ m, δ̇ m/s |
//! | [`Noise`] | xᵢ ← xᵢ + σ zᵢ, zᵢ ~ N(0, 1), independent | σ in the frame's unit |
//! | [`Smoothing`](SignalStep::Smoothing) | x ← G_w ∗ x along y, then along x | w metres |
//! | [`Hysteresis`](SensorError::Hysteresis) | x ← (1 − 4w) x + w Σⱼ Pⱼ\[x\], Pⱼ play operators over time | w of the full scale |
//! | [`Crosstalk`](SensorError::Crosstalk) | xᵢ ← (1 − κ) xᵢ + κ/4 Σ xⱼ over four neighbours | κ a fraction |
//! | [`MatrixReadout`](SensorError::MatrixReadout) | xᵢⱼ ← X t² (A⁻¹)ᵢⱼ, A the network of taxels and lines, t = 1/ε \[DA\] | ε of a fully pressed taxel's resistance |
//! | [`Scan`](SensorError::Scan) | xᵢ(t) ← xᵢ(t + T i/n), n taxels read one after another | T seconds |
//! | [`Gain`](SensorError::Gain) | xᵢ ← gᵢ xᵢ, g log-normal of mean 1 | std of g |
//! | [`Drift`](SensorError::Drift) | xᵢ ← xᵢ + σ Wᵢ(t), W a Wiener process, t the touch's time | σ of the full scale |
//! | [`Faults`](SensorError::Faults) | xᵢ ← 0 (dead) or a level of its own (stuck) | fractions of taxels |
//! | [`PinkNoise`](SensorError::PinkNoise) | xᵢ ← xᵢ + σ pᵢ, p of a 1/f spectrum in the order of reading | σ of the full scale |
//! | [`Quantisation`](SensorError::Quantisation) | x ← q round(x / q), clipped to the full scale | b bits |
//!
//! Smoothing is a filter. The steps below it are sensor errors of real skins: mismatching, drift, hysteresis and crosstalk \[SD\], and errors of the readout
//! electronics. A step of zero strength has no effect. The table has the physical order: first the material, then the readout of each taxel, then the
//! converter. Noise belongs after drift.
//!
//! **Units.** A chain starts from deflections in metres. `Force` converts them to newtons and may occur once. [`Noise`] converts its
//! standard deviation to the current unit of the frame; so does each step whose strength is a fraction of the full scale.
//!
//! **Randomness.** The draws z depend on the touch (a [`Seed`](crate::random::Seed)) and on the position among the noise steps of the chain, but not on the
//! level σ. Two chains that differ only in σ add the same pattern with another amplitude, so a sweep over noise compares paired frames. Properties of one piece
//! of hardware (gains, the drift's walk, faults) are constant over all touches. These properties depend on the `skin`'s seed and are drawn when the chain is
//! created. Errors that change from touch to touch are drawn when the chain is applied. Their patterns do not depend on the strengths either.
//!
//! **Whole bodies.** A [`BodyReadout`] supports the steps that act on each taxel independently. Its random numbers are counter-based instead of streams, so
//! the touched taxels among millions are read at a cost proportional to their number.
//!
//! **Time.** A touch is a [`Recording`]: frames in the order of time. Hysteresis and scan order depend on several frames. A single frame is
//! a recording of one frame, read at rest, by a skin without earlier touches.

mod body_readout;
mod chain;
mod force;
mod noise;
mod quantity;
mod resampling;
#[macro_use]
mod sensor_error;
mod smoothing;
mod step;
mod surface_smoothing;
mod taxel_effect;

// The properties of a sensor error follow from its line here and from the module that the line names.
sensor_errors! {
    Hysteresis hysteresis "Loading and unloading read differently.";
    Crosstalk crosstalk "Values leak to the neighbours.";
    MatrixReadout matrix_readout "Taxels of a resistive matrix are read through lines that they share.";
    Gain gain "Each taxel has its own gain.";
    Drift drift "Each taxel's zero drifts from touch to touch.";
    Faults faults "Some taxels are dead or stuck.";
    Scan scan "Taxels are read one after another.";
    PinkNoise pink_noise "The amplifier adds 1/f noise from reading to reading.";
    Quantisation quantisation "A converter clips and rounds.";
}

pub use body_readout::{BodyReading, BodyReadout, WORTH_THREADS};
pub use chain::{Chain, Recording, SignalWorkspace};
pub(crate) use crosstalk::Crosstalk;
pub use noise::{Noise, NoiseUnit};
pub use quantity::Quantity;
pub use resampling::{resample, resampled_instant};
pub use sensor_error::{Effect, ErrorAbout, MAX_STRENGTHS, Prepare, Skin, Strength, TouchRead};
pub(crate) use smoothing::Smoothing;
pub use step::{MAX_OWN_STRENGTHS, SignalStep};
pub use taxel_effect::Moment;
