//! What a decision takes: a press, noise and compression, an answer, one touch after the other.

use super::recognition::{Bench, Front};
use super::subject::spread_evenly;
use crate::contact::{Workspace, press_to_depth};
use crate::error::Result;
use crate::geometry::Pose;
use crate::quantile::quantile;
use crate::recognition::classifier::TrainedClassifier;
use crate::recognition::dataset::Dataset;
use crate::signal::Scratch;
use crate::world::Scene;
use ndarray::{Array2, s};
use std::time::Instant;

impl Bench<'_> {
    /// Every touch that is timed: spread evenly over all.
    fn timed(&self) -> Vec<usize> {
        let all: Vec<usize> = (0..self.learned.len()).collect();
        let chosen = spread_evenly(&all, self.sweep.spec.timed_touches);
        chosen.into_iter().copied().collect()
    }

    /// Median microseconds of a press.
    pub fn time_presses(&self) -> f64 {
        let per_object = self.learned.len() / self.touched.len();
        let scenes = self.touched.iter();
        let scenes: Vec<Scene> = scenes
            .map(|touched| Scene::of_one(self.patch, &touched.object.model))
            .collect();
        let mut workspace = Workspace::new();
        self.median_us(&self.timed(), |touch| {
            let touched = &self.touched[touch / per_object];
            let place = &touched.touches[touch % per_object];
            let pose: Pose = place.patch_from_object(&touched.rests[place.rest]);
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
        Ok(self.median_us(&self.timed(), |touch| {
            frame.row_mut(0).assign(&felt.row(touch));
            let values = frame.as_slice_mut().expect("one whole row");
            front
                .chain
                .apply(values, None, &to_read[touch].seed, &mut scratch);
            front.projection.measure_into(frame.view(), row.view_mut());
        }))
    }

    /// Median microseconds of an answer.
    pub fn time_answers(&self, classifier: &TrainedClassifier, test: &Dataset) -> Result<f64> {
        let all: Vec<usize> = (0..test.targets.len()).collect();
        let chosen = spread_evenly(&all, self.sweep.spec.timed_touches);
        let chosen: Vec<usize> = chosen.into_iter().copied().collect();
        let row = |touch: usize| test.records.slice(s![touch..touch + 1, ..]);
        // What fails fails at once.
        classifier.labels(row(0))?;
        Ok(self.median_us(&chosen, |touch| {
            classifier.labels(row(touch)).expect("rows like the first");
        }))
    }

    /// Once over all before it counts, and once that counts.
    fn median_us(&self, touches: &[usize], mut act: impl FnMut(usize)) -> f64 {
        touches.iter().for_each(|&touch| act(touch));
        let timed = touches.iter().map(|&touch| {
            let start = Instant::now();
            act(touch);
            1e6 * start.elapsed().as_secs_f64()
        });
        quantile(&mut timed.collect::<Vec<_>>(), 0.5)
    }
}
