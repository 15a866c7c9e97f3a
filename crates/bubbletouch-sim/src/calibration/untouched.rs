//! Frames without contact: the zero offset of each taxel in runs of frames, even if a converter clips values below zero.
//!
//! Let a clipped reading be max(0, z), z ~ N(μ, σ²). Let p be the fraction of a run's readings above 0, m their mean, and a = Φ⁻¹(p). Then σ = m / (a p +
//! φ(a)) and μ = a σ (Tobin, Econometrica 26, 1958, by moments). A converter of step q rounds values below q/2 to 0; for it, p and m refer to z − q/2.

use super::RecordedSkin;
use super::faults::FoundFaults;
use super::robust::{mean, variance};
use super::touched::rest;
use crate::error::{Error, Result};
use ndarray::{Array1, Array2, ArrayView1, s};
use statrs::distribution::{Continuous, ContinuousCDF, Normal};

/// Number of consecutive frames per run. If smaller, the zero offset is less accurate; if larger, the zero offset drifts during a run.
const N_RUN: usize = 50;
/// Minimum number of frames without contact for an estimate.
const FEWEST: usize = 20;
/// Range of the fraction of unclipped frames for which the zero offset of a taxel with clipped readings can be computed. A wider range uses too few frames at
/// its ends.
const CLIPPED: [f64; 2] = [0.3, 0.98];
/// Minimum fraction of runs without clipped readings. If at least this fraction of the runs is free of clipping, the other runs are omitted.
const SUFFICIENT_CLEAR: f64 = 0.1;

/// Smallest change of a reading that a contact explains better than noise or drift: as a fraction of the full scale, and in standard deviations of the changes.
/// If smaller, noise counts as contact; if larger, light contacts in untouched frames are missed.
const CONTACT: [f64; 2] = [0.1, 8.0];
/// Minimum number of taxels that a contact changes. A single taxel may have spikes.
const MIN_TOUCHED: usize = 3;
/// Approximate maximum number of changes from which their standard deviation is estimated.
const N_CHANGES: usize = 200_000;

/// Zero offset of a taxel in a run of frames without contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Zero {
    /// No reading is clipped at the lowest possible value; contains the mean of the readings.
    Clear(f64),
    /// Many readings are clipped; contains mean and standard deviation of the values before clipping.
    Clipped { mean: f64, std: f64 },
    /// The zero offset is unknown: nearly all readings are clipped, or the taxel is faulty.
    Lost,
}

/// Frames without contact, and the zero offsets of the taxels in them.
#[derive(Debug)]
pub struct Untouched<'a> {
    pub skin: &'a RecordedSkin,
    /// Step of the converter, as a fraction of the full scale.
    pub step: f64,
    /// Zero offsets of the taxels in each run of frames, shape (n_runs, n_taxels).
    pub runs: Array2<Zero>,
    /// Mean time of each run of frames, as a fraction of the recording session from 0 to 1.
    pub times: Vec<f64>,
    /// Number of consecutive frames per run.
    pub n_run: usize,
    /// Whether the recorded readings are clipped at zero.
    pub is_clipped: bool,
    /// Whether enough runs are free of clipped readings to omit the other runs.
    pub is_clear: bool,
}

impl<'a> Untouched<'a> {
    /// Estimates the zero offsets of all taxels in each run. Returns `None` if there are too few frames.
    pub fn new(skin: &'a RecordedSkin, faults: &FoundFaults, step: f64) -> Option<Self> {
        let n = skin.untouched.nrows();
        if n < FEWEST {
            return None;
        }
        let n_run = N_RUN.min(n / 2);
        let n_runs = n / n_run;
        // Readings whose zero offset is above the lowest reading are not clipped, and all of them are positive.
        let columns = skin.untouched.columns().into_iter().zip(&faults.is_sound);
        let sound = columns.filter(|(_, is_sound)| **is_sound);
        let readings: Vec<f64> = sound.flat_map(|(column, _)| column.to_vec()).collect();
        let least = readings.iter().copied().fold(f64::INFINITY, f64::min);
        let is_clipped = least == 0.0 && readings.iter().any(|&reading| reading > 0.0);
        let of = |(run, taxel): (usize, usize)| {
            let readings = skin.untouched.column(taxel);
            let readings = readings.slice(s![run * n_run..(run + 1) * n_run]);
            match faults.is_sound[taxel] {
                true => zero_of(readings, is_clipped, step),
                false => Zero::Lost,
            }
        };
        let runs = Array2::from_shape_fn((n_runs, skin.n_taxels()), of);
        let n_clear = runs.iter().filter(|run| matches!(run, Zero::Clear(_)));
        let is_clear = n_clear.count() as f64 >= SUFFICIENT_CLEAR * runs.len() as f64;
        let times = (0..n_runs).map(|run| {
            let times = skin
                .untouched_times
                .slice(s![run * n_run..(run + 1) * n_run]);
            mean(times.iter().copied())
        });
        Some(Self {
            skin,
            step,
            times: times.collect(),
            runs,
            n_run,
            is_clipped,
            is_clear,
        })
    }

    /// Checks that nothing touches the skin in the untouched frames.
    ///
    /// # Errors
    /// If several taxels change between consecutive untouched frames by much more than the noise, or rest far below their zero offsets in the other frames.
    pub fn check(&self, faults: &FoundFaults) -> Result<()> {
        let refused = |given: String| {
            let allowed = "frames in which nothing touches the skin";
            Err(Error::input("untouched frames", given, allowed))
        };
        let (times, skin) = (&self.skin.untouched_times, self.skin);
        let gaps = || times.windows(2).into_iter().map(|pair| pair[1] - pair[0]);
        let usual = self.frame_interval();
        // The zero offsets may drift in a gap between two ranges of frames.
        let pairs = || {
            (1..times.len())
                .zip(gaps())
                .filter(|(_, gap)| *gap <= 1.5 * usual)
        };
        let change = |frame: usize| &skin.untouched.row(frame) - &skin.untouched.row(frame - 1);
        let stride = (skin.untouched.len() / N_CHANGES).max(1);
        let changes = pairs().flat_map(|(frame, _)| change(frame)).step_by(stride);
        let changes: Vec<f64> = changes.collect();
        // Clipped readings do not change.
        let varying: Vec<f64> = changes
            .iter()
            .copied()
            .filter(|&change| change != 0.0)
            .collect();
        let std = match 4 * varying.len() > changes.len() {
            true => variance(&varying).sqrt(),
            false => 0.0,
        };
        let least = CONTACT[0].max(CONTACT[1] * std);
        for (frame, _) in pairs() {
            let changed = change(frame)
                .into_iter()
                .filter(|change| change.abs() > least);
            let n = changed.count();
            if n >= MIN_TOUCHED {
                return refused(format!(
                    "{n} taxels change by more than {least:.2} of the full scale at frame {frame} of them"
                ));
            }
        }
        let rests = (0..skin.n_taxels()).filter(|&taxel| faults.is_sound[taxel]);
        let rests = rests.filter_map(|taxel| {
            let readings = skin
                .touched
                .column(taxel)
                .into_iter()
                .zip(&skin.touched_times);
            let above = readings.map(|(reading, &time)| Some(reading - self.zero(taxel, time)?));
            Some(rest(above.collect::<Option<Array1<f64>>>()?.view())?.0)
        });
        let rests: Vec<f64> = rests.collect();
        let least = CONTACT[0].max(CONTACT[1] * variance(&rests).sqrt());
        let n = rests.iter().filter(|&&rest| rest < -least).count();
        match n >= MIN_TOUCHED {
            true => refused(format!(
                "{n} taxels read more than in the other frames, by over {least:.2} of the full scale"
            )),
            false => Ok(()),
        }
    }

    /// Returns the zero offset of a taxel at a time, interpolated linearly between the runs before and after this time. Returns `None` if the zero offset is
    /// unknown in one of these runs.
    pub fn zero(&self, taxel: usize, time: f64) -> Option<f64> {
        let after = self.times.partition_point(|&run| run <= time);
        let after = after.min(self.times.len() - 1);
        let before = after.saturating_sub(1);
        let [first, second] = [before, after].map(|run| match self.runs[(run, taxel)] {
            Zero::Clear(zero) | Zero::Clipped { mean: zero, .. } => Some(zero),
            Zero::Lost => None,
        });
        let (first, second) = first.zip(second)?;
        let span = self.times[after] - self.times[before];
        let share = match span > 0.0 {
            true => ((time - self.times[before]) / span).clamp(0.0, 1.0),
            false => 0.0,
        };
        Some(first + share * (second - first))
    }

    /// Returns the mean square error of an interpolated zero offset over some times, and the square of its mean error, for drift of the standard deviation `drift`
    /// and noise of the standard deviation `noise`. Over a gap L between two runs, a Wiener process of known ends has the mean square σ² L / 6 and the mean of
    /// variance σ² L / 12; before the first and after the last run, these are σ² L / 2 and σ² L / 3. Gaps are independent.
    pub fn square_errors(&self, times: &Array1<f64>, (drift, noise): (f64, f64)) -> [f64; 2] {
        let of_runs = noise.powi(2) / self.n_run as f64;
        let mut errors = [of_runs, of_runs];
        for gap in 0..=self.times.len() {
            let is_within = |time: &&f64| self.times.partition_point(|run| run <= *time) == gap;
            let share = times.iter().filter(is_within).count() as f64 / times.len() as f64;
            let before = gap.checked_sub(1).map(|run| self.times[run]);
            let (length, [of_squares, of_mean]) = match (before, self.times.get(gap)) {
                (Some(before), Some(after)) => (after - before, [6.0, 12.0]),
                (Some(before), None) => (1.0 - before, [2.0, 3.0]),
                (None, after) => (after.copied().unwrap_or(1.0), [2.0, 3.0]),
            };
            errors[0] += drift.powi(2) * share * length / of_squares;
            errors[1] += drift.powi(2) * share.powi(2) * length / of_mean;
        }
        errors
    }

    /// Returns the shortest time between consecutive untouched frames, as a fraction of the recording session.
    pub fn frame_interval(&self) -> f64 {
        let times = &self.skin.untouched_times;
        let gaps = times.windows(2).into_iter().map(|pair| pair[1] - pair[0]);
        gaps.fold(f64::INFINITY, f64::min)
    }

    /// Returns the indices of the runs in which no reading of a taxel is clipped.
    pub fn clear(&self, taxel: usize) -> impl Iterator<Item = usize> + '_ {
        let runs = self.runs.column(taxel).into_iter().enumerate();
        runs.filter_map(|(run, zero)| matches!(zero, Zero::Clear(_)).then_some(run))
    }

    /// Returns the readings of a taxel in a run of frames.
    pub fn readings(&self, taxel: usize, run: usize) -> ArrayView1<'_, f64> {
        let run = run * self.n_run..(run + 1) * self.n_run;
        self.skin.untouched.slice(s![run, taxel])
    }
}

fn zero_of(readings: ArrayView1<f64>, is_clipped: bool, step: f64) -> Zero {
    let n = readings.len() as f64;
    let above = readings.iter().filter(|&&reading| reading > 0.0).count() as f64 / n;
    let middle = mean(readings.iter().copied());
    if !is_clipped || above > CLIPPED[1] {
        return Zero::Clear(middle);
    }
    if above < CLIPPED[0] {
        return Zero::Lost;
    }
    let normal = Normal::standard();
    let a = normal.inverse_cdf(above);
    let std = (middle - 0.5 * step * above) / (a * above + normal.pdf(a));
    Zero::Clipped {
        mean: a * std + 0.5 * step,
        std,
    }
}
