//! Frames of all touches, divided into training and test frames, with and without noise. Dictionaries and the errors of reconstructed frames are computed from them.

use crate::learning::data::split::stratified_hold_out;
use crate::sensing::Dictionary;
use crate::signal::{Chain, Noise, NoiseUnit};
use crate::studies::prelude::*;
use crate::studies::recognition::frames::frame_store::Frames;
use crate::studies::recognition::frames::pressed_objects::simulate_array;
use crate::studies::recognition::frames::reading::{
    ReadSkin, Reading, TouchToRead, measure, touches_to_read,
};
use crate::studies::recognition::frames::touch_set::TouchSet;
use crate::studies::reconstruction::plan::*;
use crate::studies::reconstruction::rows::*;
use crate::table::front;
use bubbletouch_svm::split::Split;
use ndarray::{Array1, Array2, ArrayView2, Axis};

/// Number of test frames that the picture shows.
const N_SAMPLES: usize = 3;

/// Frames of all touches, divided into training and test frames.
pub(super) struct Touches {
    /// Training frames without noise, one per row.
    pub train: Array2<f64>,
    /// Test frames without noise, one per row.
    pub test: Array2<f64>,
    pub truth: Truth,
    pub noisy: Vec<Noisy>,
    /// Dictionaries (sets of atoms) in the order of the plan; each is computed from the training frames when it is first needed.
    dictionaries: Vec<Shared<Dictionary>>,
    /// Row numbers of the test frames that the picture shows, each with the name of its object.
    pub shown: Vec<(usize, String)>,
}

/// Test frames with noise of one standard deviation.
pub(super) struct Noisy {
    pub level: f64,
    /// Noise standard deviation σ of a taxel, in the unit of the frame.
    pub std: f64,
    pub frames: Array2<f64>,
    /// Squared norm ‖y − x‖² of the noise in each test frame: y is the noisy frame, x the frame without noise.
    pub errors: Vec<f64>,
}

impl Touches {
    pub(super) fn simulate(
        plan: &ReconstructionPlan,
        touched: &Vec<TouchedObject>,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let labels = touched.labels();
        progress.stage("touch", labels.len() as u64);
        let frames = simulate_array(touched, &plan.array, 1, progress);
        let seed = Seed::new(plan.spec.seed);
        let fraction = plan.spec.reconstruction.test_fraction;
        let split = stratified_hold_out(labels.view(), fraction, &seed.named("split").numbered(0))?;
        let touches = touches_to_read(touched.classes(), &seed.named("signal").numbered(0));
        let read = |rows: &[usize], noise| read(plan, &frames, &touches, rows, noise);
        let test = read(&split.test, None)?;
        let unit = plan.noise_unit;
        let std = |std, unit| Noise { std, unit }.std_of(plan.quantity(), plan.array.taxel());
        let noisy = plan.noise.iter().map(|&level| {
            let frames = read(&split.test, Some(level))?;
            Ok(Noisy {
                level,
                std: std(level, unit)?,
                errors: square_errors(frames.view(), test.view()),
                frames,
            })
        });
        let noisy = noisy.collect::<Result<Vec<_>>>()?;
        Ok(Self {
            train: read(&split.train, None)?,
            truth: Truth::new(&test, std(1.0, NoiseUnit::FullScale)?),
            dictionaries: plan.of_each_dictionary(),
            shown: shown(touched, &labels, &split),
            test,
            noisy,
        })
    }

    /// Returns a dictionary of atoms that is computed from the training frames at the first call.
    pub(super) fn dictionary(
        &self,
        plan: &ReconstructionPlan,
        basis: Basis,
    ) -> Result<&Dictionary> {
        self.dictionaries[plan.place_of(basis)].get(|| {
            let atoms = plan.spec.reconstruction.atoms;
            let seed = Seed::new(plan.spec.seed).named("dictionary");
            Dictionary::learned(basis, plan.array.shape(), self.train.view(), atoms, &seed)
        })
    }

    /// Returns the rows of `frames` that the picture shows.
    pub(super) fn pick(&self, frames: &Array2<f64>) -> Array2<f64> {
        let rows: Vec<usize> = self.shown.iter().map(|(row, _)| *row).collect();
        frames.select(Axis(0), &rows)
    }
}

/// Simulates the given touches and applies the signal chain; returns one frame per row. The noise step is included on request.
fn read(
    plan: &ReconstructionPlan,
    frames: &Frames,
    touches: &[TouchToRead],
    rows: &[usize],
    noise: Option<f64>,
) -> Result<Array2<f64>> {
    let skin = ReadSkin {
        chains: vec![Chain::new(&plan.signal_steps(noise), plan.array.patch())?],
        array: &plan.array,
        speed: plan.spec.touches.speed_mm_per_s * MM,
        frames,
    };
    let projection = plan.projection(Ensemble::Identity, 1)?;
    let reading = Reading {
        skins: &[skin],
        projection: &projection,
    };
    let touches: Vec<TouchToRead> = rows.iter().map(|&row| touches[row]).collect();
    Ok(measure(reading, &touches)?.0)
}

/// Selects a few objects that are evenly spread over the list of objects. For each, returns the row of its first test touch and its name.
fn shown(touched: &[TouchedObject], labels: &Array1<usize>, split: &Split) -> Vec<(usize, String)> {
    let n = N_SAMPLES.min(touched.len());
    let objects = (0..n).map(|sample| sample * touched.len() / n);
    let first = |object: usize| {
        let mut tested = split.test.iter();
        let row = tested.position(|&touch| labels[touch] == object)?;
        Some((row, touched[object].object.name.clone()))
    };
    objects.filter_map(first).collect()
}

/// Half width of the central 95 % of a normal distribution, in standard deviations.
const NORMAL_95: f64 = 1.959_963_984_540_054;

/// Returns the squared distance ‖aᵢ − bᵢ‖² between row i of `a` and row i of `b`, for each i.
pub(super) fn square_errors(a: ArrayView2<f64>, b: ArrayView2<f64>) -> Vec<f64> {
    let rows = a.outer_iter().zip(b.outer_iter());
    rows.map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum())
        .collect()
}

/// Test frames without noise, with which reconstructed frames are compared.
pub(super) struct Truth {
    /// Squared norm ‖x‖² of each test frame x without noise.
    squares: Vec<f64>,
    n_taxels: usize,
    /// Largest value that a taxel reading can have.
    full_scale: f64,
}

/// Reconstructed frames of a block of test frames.
pub(super) struct Found {
    /// Squared error ‖x̂ − x‖² of each frame: x̂ is the reconstructed frame, x the frame without noise.
    pub errors: Vec<f64>,
    /// Number of non-zero dictionary coefficients, summed over a block of frames.
    pub n_atoms: usize,
    pub n_capped: usize,
    pub seconds: f64,
}

impl Truth {
    pub(super) fn new(frames: &Array2<f64>, full_scale: f64) -> Self {
        let rows = frames.outer_iter();
        Self {
            squares: rows.map(|x| x.dot(&x)).collect(),
            n_taxels: frames.ncols(),
            full_scale,
        }
    }

    /// Returns the score of the reconstructions of all test frames. The slice `full` contains the squared error ‖y − x‖² of each noisy frame y, where x is the
    /// clean frame.
    pub(super) fn score(&self, found: &[Found], full: &[f64]) -> ReconstructionScore {
        let n_frames = self.squares.len();
        let errors: Vec<f64> = found.iter().flat_map(|f| f.errors.clone()).collect();
        let n_atoms: usize = found.iter().map(|found| found.n_atoms).sum();
        let (error, half_width) = self.ratio(&errors);
        let (full_sampling, _) = self.ratio(full);
        let n_values = (n_frames * self.n_taxels) as f64;
        let mean_square = errors.iter().sum::<f64>() / n_values;
        ReconstructionScore {
            n_frames,
            error: error.sqrt(),
            error_low: (error - half_width).max(0.0).sqrt(),
            error_high: (error + half_width).sqrt(),
            full_sampling_error: full_sampling.sqrt(),
            snr_db: -10.0 * error.log10(),
            psnr_db: -10.0 * (mean_square / (self.full_scale * self.full_scale)).log10(),
            atoms_used: n_atoms as f64 / n_frames as f64,
            n_capped: found.iter().map(|found| found.n_capped).sum(),
        }
    }

    /// Returns Σe / Σ‖x‖² for the given squared errors e, and the half width of its 95 % interval over frames x. Here e are the `errors` of single frames, and
    /// x are the clean frames. The interval is computed by linearisation of the ratio of means (delta method).
    fn ratio(&self, errors: &[f64]) -> (f64, f64) {
        let n = errors.len() as f64;
        let mean = self.squares.iter().sum::<f64>() / n;
        let ratio = errors.iter().sum::<f64>() / n / mean;
        let pairs = errors.iter().zip(&self.squares);
        let spread: f64 = pairs.map(|(e, x)| (e - ratio * x).powi(2)).sum();
        let variance = spread / (n * (n - 1.0).max(1.0)) / (mean * mean);
        (ratio, NORMAL_95 * variance.sqrt())
    }
}

/// Marks the configurations of one noise level for which no other configuration has a smaller error and a higher frame rate.
pub(super) fn pareto(
    rows: &[ReconstructionRow],
    levels: &[f64],
) -> Vec<(ReconstructionConfiguration, ReconstructionPareto)> {
    let row = |(configuration, score, time): &ReconstructionRow| {
        let row = ReconstructionPareto {
            error: score.error,
            us_per_frame: time.us_per_frame,
            frames_per_s_per_core: time.frames_per_s_per_core,
            on_front: false,
        };
        (configuration.clone(), row)
    };
    let mut all: Vec<_> = rows.iter().map(row).collect();
    for &level in levels {
        let of_level = all
            .iter_mut()
            .filter(|(configuration, _)| configuration.noise_std == level);
        let of_level: Vec<_> = of_level.map(|(_, row)| row).collect();
        let points = of_level.iter().map(|row| (row.us_per_frame, row.error));
        let on_front = front(&points.collect::<Vec<_>>(), |a, b| a < b);
        for (row, on_front) in of_level.into_iter().zip(on_front) {
            row.on_front = on_front;
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn the_error_is_relative_to_the_clean_frames_and_its_interval_covers_it() {
        let clean = array![[3.0, 4.0], [0.0, 5.0], [5.0, 0.0]];
        let truth = Truth::new(&clean, 10.0);
        let found = Found {
            errors: vec![1.0, 2.0, 0.0],
            n_atoms: 6,
            n_capped: 1,
            seconds: 1.0,
        };
        let score = truth.score(&[found], &[25.0, 25.0, 25.0]);
        // 3 of 75.
        assert!((score.error - 0.2).abs() < 1e-15);
        assert_eq!((score.full_sampling_error, score.atoms_used), (1.0, 2.0));
        assert!(score.error_low < 0.2 && 0.2 < score.error_high);
        assert!((score.snr_db - 13.979_400_086_720_376).abs() < 1e-12);
        // Mean square error of 0.5 per taxel, relative to 10².
        assert!((score.psnr_db - 23.010_299_956_639_813).abs() < 1e-12);
    }
}
