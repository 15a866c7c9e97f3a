//! What a decision takes: a press, noise and compression, an answer, one touch after the other.

use super::recognition::Front;
use super::subject::spread_evenly;
use crate::contact::{Workspace, press_to_depth};
use crate::error::Result;
use crate::kinds::median_time::median_s;
use crate::random::Seed;
use crate::recognition::classifier::TrainedClassifier;
use crate::recognition::dataset::Dataset;
use crate::signal::Scratch;
use crate::study::frames::KeptFrames;
use crate::study::measurement::{TouchToRead, touches_to_read};
use crate::study::simulation::{TouchedObject, touched_classes};
use crate::world::{Patch, Scene};
use ndarray::{Array2, s};

/// All chains on one array and detail.
pub(super) struct Bench<'a> {
    /// Touches that are timed, at most.
    pub n_timed: usize,
    pub patch: &'a Patch,
    /// Objects of this detail.
    pub touched: &'a [TouchedObject],
    /// A frame a touch of them.
    pub learned: &'a KeptFrames,
    /// The same touches of the exact objects.
    pub tested: &'a KeptFrames,
    pub seed: Seed,
    pub one_thread: &'a rayon::ThreadPool,
}

impl Bench<'_> {
    /// Each touch is noisy in its own way, by its name.
    pub fn to_read(&self) -> Vec<TouchToRead> {
        touches_to_read(
            touched_classes(self.touched),
            &self.seed.named("speed accuracy signal"),
        )
    }

    /// Median microseconds of a press.
    pub fn time_presses(&self) -> f64 {
        let per_object = self.learned.len() / self.touched.len();
        let scenes = self.touched.iter();
        let scenes = scenes.map(|touched| Scene::of_one(self.patch, &touched.object.model));
        let scenes: Vec<Scene> = scenes.collect();
        let mut workspace = Workspace::new();
        self.median_us(self.learned.len(), |touch| {
            let touched = &self.touched[touch / per_object];
            let place = &touched.touches[touch % per_object];
            let pose = place.patch_from_object(&touched.rests[place.rest]);
            let scene = &scenes[touch / per_object];
            press_to_depth(scene, &[pose], place.depth, &mut workspace);
        })
    }

    /// Median microseconds of noise and compression.
    pub fn time_front(&self, front: &Front) -> Result<f64> {
        let to_read = self.to_read();
        let mut scratch = Scratch::default();
        let mut frame = Array2::zeros((1, self.learned.n_taxels()));
        let mut row = Array2::zeros((1, front.projection.n_measurements()));
        let felt = self.learned.to_array()?;
        Ok(self.median_us(self.learned.len(), |touch| {
            frame.row_mut(0).assign(&felt.row(touch));
            let values = frame.as_slice_mut().expect("one whole row");
            let seed = &to_read[touch].seed;
            front.chain.apply(values, None, seed, &mut scratch);
            front.projection.measure_into(frame.view(), row.view_mut());
        }))
    }

    /// Median microseconds of an answer.
    pub fn time_answers(&self, classifier: &TrainedClassifier, test: &Dataset) -> Result<f64> {
        let row = |touch: usize| test.records.slice(s![touch..touch + 1, ..]);
        // What fails fails at once.
        classifier.labels(row(0))?;
        Ok(self.median_us(test.targets.len(), |touch| {
            classifier.labels(row(touch)).expect("rows like the first");
        }))
    }

    /// Of touches spread evenly over all: once before it counts, and once that counts.
    fn median_us(&self, n_touches: usize, mut act: impl FnMut(usize)) -> f64 {
        let all: Vec<usize> = (0..n_touches).collect();
        let timed = || spread_evenly(&all, self.n_timed).into_iter().copied();
        timed().for_each(&mut act);
        1e6 * median_s(timed(), act)
    }
}
