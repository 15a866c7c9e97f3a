//! Frames of all touches, divided into training and test frames, with and without noise, and the dictionaries computed from them.

use crate::engine::progress::Progress;
use crate::engine::work_items::shared::Shared;
use crate::error::Result;
use crate::learning::data::split::stratified_hold_out;
use crate::random::Seed;
use crate::sensing::{Basis, Dictionary, Ensemble};
use crate::signal::{Chain, Noise, NoiseUnit};
use crate::studies::recognition::frames::frame_store::Frames;
use crate::studies::recognition::frames::reading::{
    ReadSkin, Reading, TouchToRead, measure, touches_to_read,
};
use crate::studies::recognition::frames::simulation::simulate_array;
use crate::studies::recognition::frames::touch_set::TouchSet;
use crate::studies::recognition::touches::drawn_touches::TouchedObject;
use crate::studies::reconstruction::plan::ReconstructionPlan;
use crate::studies::reconstruction::score::{Truth, square_errors};
use bubbletouch_svm::split::Split;
use ndarray::{Array1, Array2, Axis};

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
            Dictionary::learned(basis, plan.shape(), self.train.view(), atoms, &seed)
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
        taxel: *plan.array.taxel(),
        speed: plan.speed,
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
