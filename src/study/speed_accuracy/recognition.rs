//! The part on recognition: what each chain from touch to answer costs, and how often it is right.

use super::plan::{RecognitionSweep, SpeedAccuracyPlan, Tolerance};
use super::subject::{Subject, spread_evenly};
use super::table::{ChainCell, ChainScore, ChainTime, SpeedAccuracyTables};
use crate::error::{Error, Result};
use crate::objects::{Model, Object};
use crate::random::Seed;
use crate::recognition::ClassifierKind;
use crate::recognition::classifier::Classifier;
use crate::recognition::dataset::{Dataset, dataset};
use crate::recognition::interval::Interval;
use crate::sensing::Projection;
use crate::signal::{Chain, Noise, NoiseUnit, SignalStep};
use crate::study::CONFIDENCE;
use crate::study::frames::KeptFrames;
use crate::study::measurement::{Reading, TouchToRead, measure, touches_to_read};
use crate::study::plan::millimetres;
use crate::study::progress::{Progress, Silent};
use crate::study::simulation::{TouchedObject, draw_touches, simulate_array};
use crate::world::{Patch, Placement};
use ndarray::{Array1, Array2, ArrayView2, Axis};
use rayon::prelude::*;
use std::path::Path;
use std::time::Instant;

/// Objects of one detail: what is touched, in places that all details share.
type Details = Vec<Model>;

/// Fills the tables of recognition. Touches are made on all threads; fits and decisions are timed on one.
pub(super) fn measure_recognition(
    plan: &SpeedAccuracyPlan,
    sweep: &RecognitionSweep,
    (subjects, packings): (&[Subject], Option<&Path>),
    progress: &dyn Progress,
    tables: &mut SpeedAccuracyTables,
) -> Result<()> {
    let chosen = spread_evenly(subjects, sweep.spec.objects);
    if chosen.len() < 2 {
        let given = format!("{} objects", chosen.len());
        return Err(Error::input(&plan.place, given, "at least 2 to tell apart"));
    }
    let finest = plan.levels[plan.levels.len() - 1];
    progress.stage("objects", (1 + sweep.levels.len()) as u64);
    let build = |make: &(dyn Fn(&Subject) -> Result<Model> + Sync)| -> Result<Details> {
        let models = chosen
            .par_iter()
            .with_max_len(1)
            .map(|subject| make(subject));
        let models = models.collect::<Result<Vec<_>>>();
        progress.advance(1);
        models
    };
    let exact = build(&|subject| subject.exact(finest))?;
    let mut levels = Vec::new();
    for &level in &sweep.levels {
        let models = build(&|subject| subject.packed(level, packings))?;
        levels.push((level, models));
    }
    let seed = Seed::new(plan.spec.seed);
    let placement = Placement {
        per_object: Some(sweep.spec.training_touches + sweep.spec.test_touches),
        ..plan.placement.clone()
    };
    let objects = |models: &Details| -> Vec<Object> {
        let pairs = chosen.iter().zip(models);
        pairs
            .map(|(subject, model)| Object::of_one_part(subject.name(), model.clone()))
            .collect()
    };
    let exact = draw_touches(objects(&exact), &placement, &seed)?;
    let n_chains = sweep.spec.ensemble.len() * sweep.spec.ratio.len() * sweep.spec.classifier.len();
    let n_cells = sweep.patches.len() * levels.len() * n_chains;
    progress.stage("recognise", n_cells as u64);
    let one_thread = one_thread()?;
    for patch in &sweep.patches {
        let truth = simulate_array(&exact, patch, 1, &Silent).kept;
        for (level, models) in &levels {
            let mut touched = exact.clone();
            for (touched, object) in touched.iter_mut().zip(objects(models)) {
                touched.object = object;
            }
            let learned = simulate_array(&touched, patch, 1, &Silent).kept;
            let bench = Bench {
                sweep,
                patch,
                level: *level,
                touched: &touched,
                learned: &learned,
                tested: &truth,
                seed,
                one_thread: &one_thread,
            };
            bench.run(progress, tables)?;
        }
    }
    Ok(())
}

fn one_thread() -> Result<rayon::ThreadPool> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.map_err(|error| Error::input("threads", error, "a system that can start one"))
}

/// All chains on one array and detail.
pub(super) struct Bench<'a> {
    pub sweep: &'a RecognitionSweep,
    pub patch: &'a Patch,
    level: Tolerance,
    pub touched: &'a [TouchedObject],
    /// A frame a touch, of this detail.
    pub learned: &'a KeptFrames,
    /// The same touches of the exact objects.
    tested: &'a KeptFrames,
    seed: Seed,
    one_thread: &'a rayon::ThreadPool,
}

/// Noise and a projection, ready for one touch after the other.
pub(super) struct Front {
    pub chain: Chain,
    pub projection: Projection,
}

impl Bench<'_> {
    fn run(&self, progress: &dyn Progress, tables: &mut SpeedAccuracyTables) -> Result<()> {
        let spec = &self.sweep.spec;
        let sense_us = self.one_thread.install(|| self.time_presses());
        for &ensemble in &spec.ensemble {
            for &ratio in &spec.ratio {
                let n_taxels = self.patch.grid.n_taxels();
                let measurements = ((n_taxels as f64 / ratio).round() as usize).max(1);
                let size = (self.patch.grid.ny, self.patch.grid.nx);
                let stream = self.seed.named("speed accuracy projection");
                let noise = Noise {
                    std: spec.noise_std_full_scale,
                    unit: NoiseUnit::FullScale,
                };
                let front = Front {
                    chain: Chain::new(&[SignalStep::Noise(noise)], self.patch)?,
                    projection: Projection::new(ensemble, size, measurements, &stream)?,
                };
                let learned = self.measured(&front, self.learned)?;
                let tested = self.measured(&front, self.tested)?;
                let project_us = self.one_thread.install(|| self.time_front(&front))?;
                for &classifier in &spec.classifier {
                    let cell = ChainCell {
                        pitch_mm: millimetres(self.patch.grid.pitch),
                        n_taxels,
                        tolerance_mm: self.level.mm,
                        ensemble,
                        ratio,
                        measurements,
                        classifier,
                    };
                    let rows = (learned.view(), tested.view());
                    let (score, [classify_us, fit_s]) =
                        self.one_thread.install(|| self.learn(classifier, rows))?;
                    let time = ChainTime {
                        sense_us,
                        project_us,
                        classify_us,
                        decision_us: sense_us + project_us + classify_us,
                        fit_s,
                    };
                    tables.recognition.push((cell.clone(), score));
                    tables.recognition_timing.push((cell, time));
                    progress.advance(1);
                }
            }
        }
        Ok(())
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
