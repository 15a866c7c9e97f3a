//! Frames with contact after subtraction of the taxels' zero offsets.

use super::estimate::value;
use super::faults::FoundFaults;
use super::robust::{mean, median, mode, variance};
use super::saturation::plateau;
use super::untouched::Untouched;
use super::{Estimate, RecordedSkin};
use ndarray::{Array2, ArrayView1, Axis};

/// Number of periods of the session in which the zero offsets of touched frames are determined. With more periods, a period has fewer frames without contact;
/// with fewer, the zero offset drifts within a period.
const N_PERIODS: usize = 4;
/// Standard deviation of normal data divided by the median distance of the values below their mode.
const STD_OF_MEDIAN: f64 = 1.4826;

/// Returns the smallest reading at which a taxel counts as saturated: the full scale, or a smaller largest reading that many frames share.
pub(super) fn saturation(skin: &RecordedSkin, faults: &FoundFaults) -> f64 {
    let frames = || {
        skin.touched.outer_iter().map(|frame| {
            let readings = frame.into_iter().zip(&faults.is_sound);
            readings.map(|(&reading, &is_sound)| if is_sound { reading } else { f64::NAN })
        })
    };
    plateau(frames).map_or(1.0, |level| level.min(1.0))
}

/// Returns the frames with contact after subtraction of the zero offsets, which are interpolated between runs of frames without contact. Unknown readings and
/// readings of faulty taxels are NaN. Readings that the converter clipped at zero stay at zero. Saturated readings become 1, and all estimates omit them.
pub(super) fn touched(
    skin: &RecordedSkin,
    faults: &FoundFaults,
    (untouched, drift): (Option<&Untouched>, f64),
    saturation: f64,
) -> Array2<f64> {
    let mut touched = skin.touched.clone();
    for (mut frame, &time) in touched.outer_iter_mut().zip(&skin.touched_times) {
        for (taxel, reading) in frame.iter_mut().enumerate() {
            *reading = match untouched {
                _ if !faults.is_sound[taxel] => f64::NAN,
                _ if *reading >= saturation => 1.0,
                Some(untouched) if !(untouched.is_clipped && *reading == 0.0) => {
                    // Without drift, the zero of a taxel whose zero is unknown is at the lowest reading.
                    let zero = untouched.zero(taxel, time);
                    let zero = zero.unwrap_or(if drift > 0.0 { f64::NAN } else { 0.0 });
                    *reading - zero
                }
                _ => *reading,
            };
        }
    }
    touched
}

/// Errors of the readings of frames with contact, standard deviations as fractions of the full scale.
pub(super) struct Errors {
    /// Error of the subtracted zero offset in a frame; infinite if nothing determines it.
    of_zeros: f64,
    /// Mean error of the subtracted zero offset over all frames; infinite if nothing determines it.
    pub of_mean_zeros: f64,
    /// Noise of the readings.
    noise: f64,
}

impl Errors {
    /// Determines the errors of the frames of `touched`, given the estimates of drift and noise from untouched frames.
    ///
    /// The errors of the zero offsets are the smaller ones of two bounds: the readings at which taxels rest, and the drift since the nearest untouched frames. A
    /// taxel rests at the mode of its readings, because a contact moves. Without untouched frames, noise is the spread of the readings below their mode.
    pub fn new(
        skin: &RecordedSkin,
        touched: &Array2<f64>,
        untouched: Option<&Untouched>,
        (drift, noise): (&Estimate, &Estimate),
    ) -> Self {
        let n_frames = touched.nrows().div_ceil(N_PERIODS).max(1);
        let (mut squares, mut spreads) = (Vec::new(), Vec::new());
        let mut of_taxels = vec![0.0; touched.ncols()];
        let n_periods = touched.nrows().div_ceil(n_frames) as f64;
        for frames in touched.axis_chunks_iter(Axis(0), n_frames) {
            let rests: Vec<_> = frames.columns().into_iter().map(rest).collect();
            for (of_taxel, rest) in of_taxels.iter_mut().zip(&rests) {
                *of_taxel += rest.map_or(f64::NAN, |(rest, _)| rest) / n_periods;
            }
            let (rests, mut below): (Vec<f64>, Vec<f64>) = rests.into_iter().flatten().unzip();
            squares.push(mean_square(rests));
            spreads.push(STD_OF_MEDIAN * median(&mut below));
        }
        of_taxels.retain(|rest| rest.is_finite());
        let seen = [mean(squares.into_iter()), mean_square(of_taxels)];
        let noise = value(noise).unwrap_or_else(|| mean(spreads.into_iter()));
        let known = untouched.zip(drift.as_ref().ok().map(|drift| drift.interval[1]));
        let known = known.map_or([f64::INFINITY; 2], |(untouched, drift)| {
            untouched.square_errors(&skin.touched_times, (drift, noise))
        });
        // The smaller one of two numbers is the known one if the other is NaN.
        let [of_zeros, of_mean_zeros] = [0, 1].map(|k| known[k].min(seen[k]).sqrt());
        Self {
            of_zeros,
            of_mean_zeros,
            noise: if noise.is_finite() { noise } else { 0.0 },
        }
    }

    /// Returns the error of a reading minus its zero offset.
    pub fn total(&self) -> f64 {
        self.noise.hypot(self.of_zeros)
    }
}

/// Returns the mean square of values, without outliers; NaN if there are none.
fn mean_square(mut values: Vec<f64>) -> f64 {
    variance(&values) + median(&mut values).powi(2)
}

/// Returns the mode of the readings of a taxel, and the median distance of the readings below the mode; `None` if no reading is known.
pub(super) fn rest(readings: ArrayView1<f64>) -> Option<(f64, f64)> {
    let known = readings.iter().copied().filter(|reading| !reading.is_nan());
    let mut known: Vec<f64> = known.collect();
    let rest = mode(&mut known);
    let below = known.iter().take_while(|&&reading| reading < rest);
    let spread = median(&mut below.map(|reading| rest - reading).collect::<Vec<_>>());
    let spread = if spread.is_nan() { 0.0 } else { spread };
    rest.is_finite().then_some((rest, spread))
}
