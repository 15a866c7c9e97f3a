//! Signal: deflections → frames.
//!
//! A [`Chain`] is a list of [`SignalStep`]s, applied to one frame at a time in the order in which the study lists them.
//! A frame is one number per taxel: ny × nx on a grid, row = patch y, ascending, stored row after row; else in the order of the layout.
//! Crosstalk and smoothing go over the [neighbours](crate::world::Neighbours) of a layout that is no grid; a matrix readout needs a grid.
//!
//! | step | equation | symbols |
//! |---|---|---|
//! | [`Force`](SignalStep::Force) | fᵢ = max(0, k δᵢ + c δ̇ᵢ) where δᵢ > 0, else 0 \[BT\] | k N/m, c N·s/m, δ m, δ̇ m/s |
//! | [`Noise`](SignalStep::Noise) | xᵢ ← xᵢ + σ zᵢ, zᵢ ~ N(0, 1), independent | σ in the frame's unit |
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
//! The others are what real skins do to a signal: what \[SD\] calls mismatching, drift, hysteresis and crosstalk, and
//! what readers add. A step of no strength is exactly as if it were not listed. A chain that follows the signal's way
//! lists them as above, noise after drift: the material first, then what each taxel is read at, the converter last.
//!
//! **Units.** A chain starts from deflections in metres. `Force` turns them into newtons, once. [`Noise`] turns its
//! standard deviation into whichever unit the frame has by then; so does each step with a fraction of the full scale.
//!
//! **Randomness.** The draws z belong to a touch (a [`Seed`](crate::random::Seed)) and to the place among the chain's noise steps, never to
//! the level σ: two chains that differ in σ alone add the same pattern, louder or quieter, so a sweep over noise
//! compares like with like. What belongs to one piece of hardware and is the same in each touch (gains, the drift's walk,
//! faults) has the `skin`'s name and is drawn in [`Chain::new`]; what changes from touch to touch is drawn in
//! [`Chain::apply`]. There too, strengths share their pattern.
//!
//! **Whole bodies.** A [`BodyReadout`] has the steps that each taxel takes by itself, with draws by number in the place of streams: it reads
//! the touched taxels of millions, and nobody pays for the others.
//!
//! **Time.** A touch is a [`Recording`]: frames in the order of time, which hysteresis and scan order connect. A frame alone is a
//! recording of one: read at rest, by a skin that nothing has touched before.

mod body_readout;
mod chain;
mod force;
mod noise;
mod quantity;
#[macro_use]
mod sensor_error;
mod smoothing;
mod step;
mod surface_smoothing;
mod taxel_effect;

// Everything that a study may say of a sensor error follows from its line here and from the file that it names.
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
pub use chain::{Chain, Recording, Scratch};
pub use crosstalk::Crosstalk;
pub use force::force;
pub use noise::{Noise, NoiseUnit};
pub use quantisation::Quantisation;
pub use quantity::Quantity;
pub use sensor_error::{Effect, ErrorAbout, MAX_STRENGTHS, Prepare, Skin, Strength, TouchRead};
pub use smoothing::Smoothing;
pub use step::SignalStep;
pub use taxel_effect::Moment;
