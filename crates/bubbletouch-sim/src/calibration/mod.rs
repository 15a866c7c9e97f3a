//! Calibration: frames that a skin has recorded → the `[signal]` that makes simulated frames like them.
//!
//! Frames are taken for what a [`Chain`](crate::signal::Chain) in the order of the signal's way makes of deflections: crosstalk, gain, drift, noise, smoothing,
//! faults, converter. Each is estimated from what it alone does, and from what is known by then:
//!
//! | parameter | from | by |
//! |---|---|---|
//! | [`converter`] | all readings | the step of which all their differences are multiples |
//! | [`faults`] | touched frames | taxels that stay as they are where their neighbours move |
//! | [`noise`] | untouched frames | differences of a taxel from frame to frame |
//! | [`smoothing`] | untouched frames | how much the noise of neighbours is alike |
//! | [`drift`] | untouched frames | how far zeros moved from the beginning to the end |
//! | [`gain`] | touched frames | what taxels read of what their neighbours read, even and odd frames apart |
//! | [`crosstalk`] | touched frames | what untouched taxels beside an edge of contact read of their neighbours |
//! | [`stiffness`] | touched frames, forces | force over the sum of deflections |
//!
//! Each is a number with a 95 % interval, or [not identifiable](Estimate::NotIdentifiable) with the reason. Zero is a number: frames may well tell that
//! there is none of something.

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

pub use estimate::Estimate;
pub use recorded_skin::RecordedSkin;
pub use saturation::plateau;

use crate::error::Result;

/// What frames say of the skin that read them.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// Bits of the converter; 0 for none.
    pub converter: Estimate,
    /// Share of taxels that read 0.
    pub dead: Estimate,
    /// Share of taxels that read one level.
    pub stuck: Estimate,
    /// Standard deviation of the noise, of the full scale.
    pub noise: Estimate,
    /// σ of the Gaussian that smooths, in taxel pitches.
    pub smoothing: Estimate,
    /// Standard deviation of the zeros at the end of the session, of the full scale.
    pub drift: Estimate,
    /// Standard deviation of the gains.
    pub gain: Estimate,
    /// What a taxel leaks to its neighbours, a fraction.
    pub crosstalk: Estimate,
    /// Of a taxel's spring, N/m.
    pub stiffness: Estimate,
}

/// Estimates all parameters.
///
/// # Errors
/// Frames, times or forces that do not fit each other; readings that are not finite.
pub fn calibrate(skin: &RecordedSkin) -> Result<Calibration> {
    skin.check()?;
    let faults = faults::find(skin);
    let saturation = touched::saturation(skin, &faults);
    let converter = converter::estimate(skin, saturation);
    let step = converter.value().map_or(0.0, converter::step_of);
    let untouched = untouched::Untouched::new(skin, &faults, step);
    let untouched = untouched.as_ref();
    let smoothing = smoothing::estimate(skin, untouched);
    let width = smoothing.value().unwrap_or(0.0);
    let read_noise = noise::of_readings(untouched);
    let std = read_noise.value().unwrap_or(0.0);
    let drift = drift::estimate(skin, untouched, (std, width));
    let drifts = drift.value().unwrap_or(1.0);
    let touched = touched::touched(skin, &faults, (untouched, drifts), saturation);
    let is_clipped = untouched.is_some_and(|untouched| untouched.is_clipped);
    let hides_zeros = is_clipped && drift.value() != Some(0.0);
    let told = |estimate: Estimate| match hides_zeros {
        true => Estimate::unknown("readings are clipped at zeros that drift"),
        false => estimate.resolved(),
    };
    let levels = (std, width);
    let gains = gain::Gains::of(skin, &touched, levels);
    let of_gains = match is_clipped && width > 0.0 {
        true => {
            Estimate::unknown("readings are clipped at the zero, and smoothing mixes the gains")
        }
        false => gains.spread.clone(),
    };
    Ok(Calibration {
        noise: noise::before_smoothing(read_noise, skin, width).resolved(),
        crosstalk: told(crosstalk::estimate(skin, &touched, &gains, levels)),
        stiffness: told(stiffness::estimate(
            skin,
            &touched,
            is_clipped.then_some(std),
        )),
        gain: of_gains.resolved(),
        dead: faults.share(|fault| fault.is_dead),
        stuck: faults.share(|fault| !fault.is_dead),
        converter,
        smoothing,
        drift: drift.resolved(),
    })
}
