//! All chains on one array that learn from objects of one detail: how often they are right, and what a decision takes: a press, noise
//! and compression, an answer, one touch after the other.

use super::rows::{ChainCell, ChainScore, ChainTime};
use super::spec::RecognitionSweepSpec;
use super::study::ChainRow;
use super::subject::spread_evenly;
use crate::contact::{Workspace, press_to_depth};
use crate::error::Result;
use crate::kinds::median_time::median_s;
use crate::kinds::model_recognition::{accuracy, touches_of};
use crate::random::Seed;
use crate::recognition::classifiers::classifier::Classifier;
use crate::sensing::Projection;
use crate::signal::{Chain, Scratch};
use crate::study::Frames;
use crate::study::measurement::{Reading, TouchToRead, measure};
use crate::study::simulation::TouchedObject;
use crate::study::taxel_array::TaxelArray;
use ndarray::{Array2, Axis, s};
use std::time::Instant;

/// What they share.
pub(super) struct Bench<'a> {
    pub spec: &'a RecognitionSweepSpec,
    pub seed: Seed,
    pub array: &'a TaxelArray,
    /// Objects of this detail.
    pub touched: &'a [TouchedObject],
    /// A frame a touch of them.
    pub learned: &'a Frames,
    /// The same touches of the exact objects.
    pub tested: &'a Frames,
    /// How each touch is read, noisy in its own way, by its name.
    pub to_read: &'a [TouchToRead],
    /// The noise.
    pub chain: &'a Chain,
    pub one_thread: &'a rayon::ThreadPool,
}

/// What comes before every classifier: measurements of all touches, of the detail and of the exact objects, and the time of a press and of a
/// compression, microseconds.
pub(super) struct Measured {
    learned: Array2<f64>,
    tested: Array2<f64>,
    sense_us: f64,
    project_us: f64,
}

impl Bench<'_> {
    /// Median microseconds of a press.
    pub fn time_presses(&self) -> f64 {
        let per_object = self.spec.n_touches();
        let mut workspace = Workspace::new();
        self.median_us(self.learned.n(), |touch| {
            let touched = &self.touched[touch / per_object];
            let place = &touched.touches[touch % per_object];
            let pose = place.patch_from_object(&touched.rests[place.rest]);
            let object = std::slice::from_ref(&touched.object.model);
            press_to_depth(
                self.array.patch(),
                object,
                &[pose],
                place.depth,
                &mut workspace,
            );
        })
    }

    /// Measures all touches as a chain does.
    pub fn compress(&self, cell: &ChainCell, sense_us: f64) -> Result<Measured> {
        let size = self.array.shape();
        let stream = self.seed.named("speed accuracy projection");
        let projection = Projection::new(cell.ensemble, size, cell.measurements, &stream)?;
        let reading = Reading {
            chains: &[vec![self.chain.clone()]],
            projection: &projection,
            taxel: *self.array.taxel(),
            speed: 0.0,
        };
        Ok(Measured {
            learned: measure(reading, self.learned, self.to_read)?.0,
            tested: measure(reading, self.tested, self.to_read)?.0,
            sense_us,
            project_us: self
                .one_thread
                .install(|| self.time_compression(&projection))?,
        })
    }

    /// Median microseconds of noise and compression.
    fn time_compression(&self, projection: &Projection) -> Result<f64> {
        let mut scratch = Scratch::default();
        let mut frame = Array2::zeros((1, self.learned.n_values));
        let mut row = Array2::zeros((1, projection.n_measurements()));
        let felt = self.learned.to_array()?;
        Ok(self.median_us(self.learned.n(), |touch| {
            frame.row_mut(0).assign(&felt.row(touch));
            let values = frame.as_slice_mut().expect("one whole row");
            let seed = &self.to_read[touch].seed;
            self.chain.apply(values, None, seed, &mut scratch);
            projection.measure_into(frame.view(), row.view_mut());
        }))
    }

    /// Learns from the leading touches of the detail and answers to the others of the exact objects.
    pub fn row(&self, cell: &ChainCell, measured: &Measured) -> Result<ChainRow> {
        let (n_training, n_all) = (self.spec.training_touches, self.spec.n_touches());
        let learned = measured.learned.axis_chunks_iter(Axis(0), n_all);
        let training = touches_of(learned, 0..n_training)?;
        let tested = measured.tested.axis_chunks_iter(Axis(0), n_all);
        let test = touches_of(tested, n_training..n_all)?;
        let stream = self.seed.named("speed accuracy training");
        let start = Instant::now();
        let classifier = Classifier::new(cell.classifier).train(&training, &stream)?;
        let fit_s = start.elapsed().as_secs_f64();
        let (accuracy, interval) = accuracy(&classifier, &test)?;
        let one = |touch: usize| test.records.slice(s![touch..touch + 1, ..]);
        let classify_us = self.median_us(test.targets.len(), |touch| {
            let answer = classifier.labels(one(touch));
            answer.expect("all were answered at once before");
        });
        let cell = ChainCell {
            measurements: measured.learned.ncols(),
            ..cell.clone()
        };
        let score = ChainScore {
            n_objects: self.touched.len(),
            n_training: training.targets.len(),
            n_test: test.targets.len(),
            accuracy,
            accuracy_low: interval.low,
            accuracy_high: interval.high,
            n_capped: classifier.n_capped(),
        };
        let time = ChainTime {
            sense_us: measured.sense_us,
            project_us: measured.project_us,
            classify_us,
            decision_us: measured.sense_us + measured.project_us + classify_us,
            fit_s,
        };
        Ok((cell, score, time))
    }

    /// Of touches spread evenly over all: once before it counts, and once that counts.
    fn median_us(&self, n_touches: usize, mut act: impl FnMut(usize)) -> f64 {
        let all: Vec<usize> = (0..n_touches).collect();
        let timed = || {
            let timed = spread_evenly(&all, self.spec.timed_touches);
            timed.into_iter().copied()
        };
        timed().for_each(&mut act);
        1e6 * median_s(timed(), act)
    }
}
