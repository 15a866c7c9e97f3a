//! The part on recognition: what each chain from touch to answer costs, and how often it is right.

use super::plan::{RecognitionSweep, Tolerance};
use super::recognition_part::RecognitionPart;
use super::table::{ChainCell, ChainScore, ChainTime, SpeedAccuracyTables};
use crate::error::{Error, Result};
use crate::random::Seed;
use crate::recognition::ClassifierKind;
use crate::recognition::classifier::Classifier;
use crate::recognition::dataset::{Dataset, dataset};
use crate::recognition::interval::Interval;
use crate::sensing::{Ensemble, Projection};
use crate::signal::{Chain, Noise, NoiseUnit, SignalStep};
use crate::study::CONFIDENCE;
use crate::study::frames::KeptFrames;
use crate::study::measurement::{Reading, TouchToRead, measure, touches_to_read};
use crate::study::pieces::PiecesLeft;
use crate::study::plan::millimetres;
use crate::study::simulation::TouchedObject;
use crate::world::Patch;
use ndarray::{Array1, Array2, ArrayView2, Axis};
use std::time::Instant;

/// A pool of one thread, to time on.
pub(super) fn one_thread() -> Result<rayon::ThreadPool> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.map_err(|error| Error::input("threads", error, "a system that can start one"))
}

/// All chains on one array and detail.
pub(super) struct Bench<'a> {
    pub part: &'a RecognitionPart<'a>,
    pub number: (usize, usize),
    pub sweep: &'a RecognitionSweep,
    pub patch: &'a Patch,
    pub level: Tolerance,
    pub touched: &'a [TouchedObject],
    /// A frame a touch, of this detail.
    pub learned: &'a KeptFrames,
    /// The same touches of the exact objects.
    pub tested: &'a KeptFrames,
    pub seed: Seed,
    pub one_thread: &'a rayon::ThreadPool,
}

/// Noise and a projection, ready for one touch after the other.
pub(super) struct Front {
    pub chain: Chain,
    pub projection: Projection,
}

/// Measurements of all touches, of the detail and of the exact objects, and what one takes.
struct Compressed {
    learned: Array2<f64>,
    tested: Array2<f64>,
    project_us: f64,
}

impl Bench<'_> {
    /// Does the chains that are left.
    pub fn run(&self, left: &PiecesLeft<SpeedAccuracyTables>) -> Result<()> {
        let sense_us = self.one_thread.install(|| self.time_presses());
        for (front, kinds) in self.part.fronts_left(self.number, left) {
            let name = |kind| self.part.chain_name(self.number, front, kind);
            let names: Vec<String> = kinds.iter().map(|&kind| name(kind)).collect();
            let work = self.part.front_work(self.number, front);
            let compress = || left.during(&work, || self.compress(front));
            let Some(before) = left.prepare(&names, compress)? else {
                continue;
            };
            for classifier in kinds {
                left.finish(&name(classifier), || {
                    self.chain(front, classifier, &before, sense_us)
                })?;
            }
        }
        Ok(())
    }

    /// What comes before every classifier.
    fn compress(&self, (ensemble, ratio): (Ensemble, f64)) -> Result<Compressed> {
        let n_taxels = self.patch.grid.n_taxels();
        let measurements = ((n_taxels as f64 / ratio).round() as usize).max(1);
        let size = (self.patch.grid.ny, self.patch.grid.nx);
        let stream = self.seed.named("speed accuracy projection");
        let noise = Noise {
            std: self.sweep.spec.noise_std_full_scale,
            unit: NoiseUnit::FullScale,
        };
        let front = Front {
            chain: Chain::new(&[SignalStep::Noise(noise)], self.patch)?,
            projection: Projection::new(ensemble, size, measurements, &stream)?,
        };
        Ok(Compressed {
            learned: self.measured(&front, self.learned)?,
            tested: self.measured(&front, self.tested)?,
            project_us: self.one_thread.install(|| self.time_front(&front))?,
        })
    }

    fn chain(
        &self,
        (ensemble, ratio): (Ensemble, f64),
        classifier: ClassifierKind,
        before: &Compressed,
        sense_us: f64,
    ) -> Result<SpeedAccuracyTables> {
        let cell = ChainCell {
            pitch_mm: millimetres(self.patch.grid.pitch),
            n_taxels: self.patch.grid.n_taxels(),
            tolerance_mm: self.level.mm,
            ensemble,
            ratio,
            measurements: before.learned.ncols(),
            classifier,
        };
        let rows = (before.learned.view(), before.tested.view());
        let (score, [classify_us, fit_s]) =
            self.one_thread.install(|| self.learn(classifier, rows))?;
        let project_us = before.project_us;
        let time = ChainTime {
            sense_us,
            project_us,
            classify_us,
            decision_us: sense_us + project_us + classify_us,
            fit_s,
        };
        Ok(SpeedAccuracyTables {
            recognition: vec![(cell.clone(), score)],
            recognition_timing: vec![(cell, time)],
            ..SpeedAccuracyTables::default()
        })
    }

    /// Each touch is noisy in its own way, by its name.
    pub fn to_read(&self) -> Vec<TouchToRead> {
        touches_to_read(self.touched, &self.seed.named("speed accuracy signal"))
    }

    fn measured(&self, front: &Front, frames: &KeptFrames) -> Result<Array2<f64>> {
        let reading = Reading {
            chains: std::slice::from_ref(&front.chain),
            projection: &front.projection,
            taxel: self.patch.taxel,
            speed: 0.0,
        };
        Ok(measure(reading, (frames, 1), &self.to_read())?.0)
    }

    /// Numbers of the touches of each object from `first` to before `last`.
    fn numbers(&self, first: usize, last: usize) -> Vec<usize> {
        let per_object = self.sweep.spec.training_touches + self.sweep.spec.test_touches;
        let objects = 0..self.touched.len();
        objects
            .flat_map(|object| (first..last).map(move |touch| object * per_object + touch))
            .collect()
    }

    fn part(&self, rows: ArrayView2<f64>, (first, last): (usize, usize)) -> Result<Dataset> {
        let numbers = self.numbers(first, last);
        let labels: Array1<usize> = (0..self.touched.len())
            .flat_map(|label| std::iter::repeat_n(label, last - first))
            .collect();
        dataset(rows.select(Axis(0), &numbers), labels)
    }

    /// Learns from the first touches of the detail and answers to the others of the exact objects; with the score the microseconds of an
    /// answer and the seconds of the fit.
    fn learn(
        &self,
        kind: ClassifierKind,
        (learned, tested): (ArrayView2<f64>, ArrayView2<f64>),
    ) -> Result<(ChainScore, [f64; 2])> {
        let n_training = self.sweep.spec.training_touches;
        let n_all = n_training + self.sweep.spec.test_touches;
        let training = self.part(learned, (0, n_training))?;
        let test = self.part(tested, (n_training, n_all))?;
        let stream = self.seed.named("speed accuracy training");
        let start = Instant::now();
        let classifier = Classifier::new(kind).train(&training, &stream)?;
        let fit_s = start.elapsed().as_secs_f64();
        let answers = classifier.labels(test.records.view())?;
        let pairs = answers.iter().zip(&test.targets);
        let n_right = pairs.filter(|(answer, truth)| answer == truth).count();
        let n_test = test.targets.len();
        let interval = Interval::wilson(n_right, n_test, CONFIDENCE)?;
        let score = ChainScore {
            n_objects: self.touched.len(),
            n_training: training.targets.len(),
            n_test,
            accuracy: n_right as f64 / n_test as f64,
            accuracy_low: interval.low,
            accuracy_high: interval.high,
            n_capped: classifier.n_capped(),
        };
        Ok((score, [self.time_answers(&classifier, &test)?, fit_s]))
    }
}
