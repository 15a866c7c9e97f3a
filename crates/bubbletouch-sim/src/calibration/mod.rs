//! Calibration: estimates the `[signal]` settings of a skin from its recorded frames.
//!
//! The model is a [`Chain`](crate::signal::Chain) in physical order, which consists of crosstalk, gain, drift, noise, smoothing, faults, and converter. Each
//! parameter is estimated from an effect that no other parameter has, and from parameters estimated before:
//!
//! | parameter | from | by |
//! |---|---|---|
//! | [`converter`] | all readings | the largest step of which all differences of readings are multiples |
//! | [`faults`] | touched frames | taxels that stay constant while their neighbours change |
//! | [`noise`] | untouched frames | differences of a taxel from frame to frame |
//! | [`smoothing`] | untouched frames | the correlation of the noise of neighbours |
//! | [`drift`] | untouched frames | the change of the zeros from the beginning to the end |
//! | [`gain`] | touched frames | readings of taxels relative to their neighbours, in even and odd frames separately |
//! | [`crosstalk`] | touched frames | readings of untouched taxels beside an edge of contact, relative to their neighbours |
//! | [`stiffness`] | touched frames, forces | force over the sum of deflections |
//!
//! Each estimate is a number with a 95 % interval, or [not identifiable](NotIdentifiable) with the reason. Zero is a valid estimate: frames can
//! show that an effect is absent.

pub mod converter;
pub mod crosstalk;
pub mod drift;
mod estimate;
pub mod faults;
pub mod gain;
pub mod noise;
mod recorded_skin;
mod robust;
mod saturation;
mod signal_table;
pub mod smoothing;
pub mod stiffness;
mod touched;
mod untouched;

pub use estimate::{Estimate, Measured, NotIdentifiable};
pub use recorded_skin::RecordedSkin;
pub use saturation::plateau;

use crate::error::Result;
use estimate::value;

/// Estimated signal parameters of a recorded skin, each with a 95 % interval.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// Number of bits of the analogue-to-digital converter; 0 if there is none.
    pub converter: Estimate,
    /// Fraction of taxels that always read 0.
    pub dead: Estimate,
    /// Fraction of taxels that always read another constant level.
    pub stuck: Estimate,
    /// Standard deviation of the noise, as a fraction of the full scale.
    pub noise: Estimate,
    /// Standard deviation of the Gaussian kernel that smooths the frames, in taxel pitches.
    pub smoothing: Estimate,
    /// Standard deviation of the zero offsets at the end of the recording session, as a fraction of the full scale.
    pub drift: Estimate,
    /// Standard deviation of the gains, relative to their mean 1.
    pub gain: Estimate,
    /// Fraction of a taxel's value that leaks to its neighbours.
    pub crosstalk: Estimate,
    /// Stiffness of a taxel's spring, N/m.
    pub stiffness: Estimate,
}

/// Estimates all parameters of the signal chain of a recorded skin.
///
/// # Errors
/// If frames, times or forces have inconsistent sizes, if readings are not finite, or if frames given as untouched have contacts.
pub fn calibrate(skin: &RecordedSkin) -> Result<Calibration> {
    skin.check()?;
    let faults = faults::find(skin);
    let saturation = touched::saturation(skin, &faults);
    let converter = converter::estimate(skin, saturation);
    let step = value(&converter).map_or(0.0, converter::step_of);
    let untouched = untouched::Untouched::new(skin, &faults, step);
    let untouched = untouched.as_ref();
    if let Some(untouched) = untouched {
        untouched.check(&faults)?;
    }
    let smoothing = smoothing::estimate(skin, untouched);
    let width = value(&smoothing).unwrap_or(0.0);
    let read_noise = noise::of_readings(untouched);
    let std = value(&read_noise).unwrap_or(0.0);
    let drift = drift::estimate(skin, untouched, (std, width));
    let drifts = value(&drift).unwrap_or(1.0);
    let read_noise = noise::without_drift(read_noise, untouched, &drift);
    let touched = touched::touched(skin, &faults, (untouched, drifts), saturation);
    let is_clipped = untouched.is_some_and(|untouched| untouched.is_clipped);
    let hides_zeros = is_clipped && value(&drift) != Some(0.0);
    let told = |estimate: Estimate| match hides_zeros {
        true => Err("readings are clipped at zeros that drift".into()),
        false => estimate.and_then(Measured::resolved),
    };
    let errors = touched::Errors::new(skin, &touched, untouched, (&drift, &read_noise));
    let gains = gain::Gains::new(skin, &touched, (&errors, width));
    let of_gains = match is_clipped && width > 0.0 {
        true => Err("readings are clipped at the zero, and smoothing mixes the gains".into()),
        false => gains.spread.clone(),
    };
    Ok(Calibration {
        noise: noise::before_smoothing(read_noise, skin, width),
        crosstalk: told(crosstalk::estimate(
            skin,
            &touched,
            &gains,
            (errors.total(), width),
        )),
        stiffness: told(stiffness::estimate(
            skin,
            &touched,
            is_clipped.then_some(std),
        )),
        gain: of_gains.and_then(Measured::resolved),
        dead: faults.share(|fault| fault.is_dead),
        stuck: faults.share(|fault| !fault.is_dead),
        converter,
        smoothing,
        drift: drift.and_then(Measured::resolved),
    })
}
