//! Untouched frames: the zero of each taxel in runs of frames, also where a converter that clips hides what is below it.
//!
//! Of a reading max(0, z), z ~ N(μ, σ²), that is above 0 in a share p of a run's frames and has the mean m, with a = Φ⁻¹(p):
//! σ = m / (a p + φ(a)) and μ = a σ (Tobin, Econometrica 26, 1958, by moments). A converter of step q rounds to 0 what is below q/2, so there p
//! and m are those of z − q/2.

use super::RecordedSkin;
use super::faults::FoundFaults;
use super::robust::mean;
use ndarray::{Array2, ArrayView1, s};
use statrs::distribution::{Continuous, ContinuousCDF, Normal};

/// Frames of a run. Fewer say less of its zero; more let it drift meanwhile.
const N_RUN: usize = 50;
/// Frames that say something.
const FEWEST: usize = 20;
/// Shares of frames above the least reading from which on, and up to which, a clipped zero is computed. Wider ends lie on too few frames.
const CLIPPED: [f64; 2] = [0.3, 0.98];
/// Share of runs that must be clear of the least reading for the others to be left out.
const SUFFICIENT_CLEAR: f64 = 0.1;

/// What untouched frames say of a taxel in a run of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Zero {
    /// It never reads the least that the skin can; its mean.
    Clear(f64),
    /// It often does; mean and standard deviation of what is clipped.
    Clipped { mean: f64, std: f64 },
    /// It nearly always does, or is at fault.
    Lost,
}

/// Untouched frames and their zeros.
#[derive(Debug)]
pub struct Untouched<'a> {
    pub skin: &'a RecordedSkin,
    /// The converter's step, of the full scale.
    pub step: f64,
    /// Runs × taxels.
    pub runs: Array2<Zero>,
    /// When each run was read.
    pub times: Vec<f64>,
    /// Frames of each run.
    pub n_run: usize,
    /// Whether what is below the zero of readings is lost.
    pub is_clipped: bool,
    /// Whether there are clear runs enough to leave out the others.
    pub is_clear: bool,
}

impl<'a> Untouched<'a> {
    /// None of too few frames.
    pub fn new(skin: &'a RecordedSkin, faults: &FoundFaults, step: f64) -> Option<Self> {
        let n = skin.untouched.nrows();
        if n < FEWEST {
            return None;
        }
        let n_run = N_RUN.min(n / 2);
        let n_runs = n / n_run;
        let readings = || skin.untouched.iter();
        let is_clipped = readings().all(|&reading| reading >= 0.0) && readings().any(|&r| r > 0.0);
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

    /// What a taxel reads untouched at a time, on a straight line between the runs before and after; none where one of them is lost.
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

    /// Runs of taxels that are clear.
    pub fn clear(&self, taxel: usize) -> impl Iterator<Item = usize> + '_ {
        let runs = self.runs.column(taxel).into_iter().enumerate();
        runs.filter_map(|(run, zero)| matches!(zero, Zero::Clear(_)).then_some(run))
    }

    /// Readings of a taxel in a run.
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
