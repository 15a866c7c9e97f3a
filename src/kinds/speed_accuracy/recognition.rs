//! The part on recognition: what each chain from touch to answer costs, and how often it is right.

use super::chain_times::Bench;
use super::plan::{RecognitionSweep, SpeedAccuracyPlan};
use super::rows::{ChainCell, ChainScore, ChainTime};
use super::study::SpeedAccuracyRows;
use super::subject::{Subject, spread_evenly};
use crate::error::{Error, Result};
use crate::kinds::model_recognition::{Accuracy, touches_of};
use crate::objects::{Model, Object};
use crate::random::Seed;
use crate::recognition::ClassifierKind;
use crate::recognition::classifier::Classifier;
use crate::sensing::{Ensemble, Projection};
use crate::signal::{Chain, Noise, NoiseUnit, SignalStep};
use crate::study::measurement::{Reading, measure};
use crate::study::pieces::{NamedPiece, PiecesLeft};
use crate::study::plan::millimetres;
use crate::study::progress::{Progress, Silent};
use crate::study::simulation::{TouchedObject, draw_touches, simulate_array};
use crate::study::time_left::Piece;
use crate::world::Placement;
use ndarray::{Array2, Axis};
use rayon::prelude::*;
use std::path::Path;
use std::time::Instant;

/// Every chain from touch to answer, on some of the objects.
pub(super) struct RecognitionPart<'a> {
    plan: &'a SpeedAccuracyPlan,
    sweep: &'a RecognitionSweep,
    chosen: Vec<&'a Subject>,
    packings: Option<&'a Path>,
}

/// A chain: the numbers of its array and its level of detail, how it compresses, and what answers.
#[derive(Clone, Copy, PartialEq)]
struct Setting {
    array: usize,
    level: usize,
    ensemble: Ensemble,
    ratio: f64,
    classifier: ClassifierKind,
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

/// Seconds of a chain, about.
const CHAIN_S: f64 = 0.15;

impl<'a> RecognitionPart<'a> {
    pub fn new(
        plan: &'a SpeedAccuracyPlan,
        sweep: &'a RecognitionSweep,
        (subjects, packings): (&'a [Subject], Option<&'a Path>),
    ) -> Self {
        Self {
            plan,
            sweep,
            chosen: spread_evenly(subjects, sweep.spec.objects),
            packings,
        }
    }

    /// Chains on the same array and detail share their touches.
    pub fn pieces(&self) -> Vec<NamedPiece> {
        let n_levels = self.sweep.levels.len();
        let pieces = self.settings().into_iter().map(|setting| {
            let group = setting.array * n_levels + setting.level;
            NamedPiece::new(self.name(&setting), group, Piece::one_by_one(2, CHAIN_S))
        });
        pieces.collect()
    }

    /// All chains, array by array, of each level by level, ensemble by ensemble, ratio by ratio.
    fn settings(&self) -> Vec<Setting> {
        let spec = &self.sweep.spec;
        let mut settings = Vec::new();
        for array in 0..self.sweep.patches.len() {
            for level in 0..self.sweep.levels.len() {
                for &ensemble in &spec.ensemble {
                    for &ratio in &spec.ratio {
                        settings.extend(spec.classifier.iter().map(|&classifier| Setting {
                            array,
                            level,
                            ensemble,
                            ratio,
                            classifier,
                        }));
                    }
                }
            }
        }
        settings
    }

    /// What a chain is called as a work item.
    fn name(&self, setting: &Setting) -> String {
        let Setting {
            classifier,
            ensemble,
            ratio,
            ..
        } = setting;
        let pitch_mm = millimetres(self.sweep.patches[setting.array].grid.pitch);
        let tolerance_mm = self.sweep.levels[setting.level];
        format!(
            "{classifier:?} after {ensemble:?} {ratio}:1 at {pitch_mm} mm, objects within {tolerance_mm} mm"
        )
    }

    /// Touches are made on all threads; fits and decisions are timed on one.
    pub fn measure(&self, left: &PiecesLeft<SpeedAccuracyRows>) -> Result<()> {
        let settings = left.of(self.settings(), |setting| self.name(setting));
        if settings.is_empty() {
            return Ok(());
        }
        if self.chosen.len() < 2 {
            let given = format!("{} objects", self.chosen.len());
            return Err(Error::input(
                &self.plan.place,
                given,
                "at least 2 to tell apart",
            ));
        }
        let names = |settings: &[Setting]| -> Vec<String> {
            settings.iter().map(|setting| self.name(setting)).collect()
        };
        let build = || self.touched(left.progress);
        let Some((exact, levels)) = left.prepare(&names(&settings), build)? else {
            return Ok(());
        };
        left.progress.stage("recognise", settings.len() as u64);
        let one_thread = one_thread()?;
        for of_array in settings.chunk_by(|a, b| a.array == b.array) {
            let patch = &self.sweep.patches[of_array[0].array];
            let tested = simulate_array(&exact, patch, 1, &Silent).kept;
            for of_bench in of_array.chunk_by(|a, b| a.level == b.level) {
                let touched = &levels[of_bench[0].level];
                let bench = Bench {
                    n_timed: self.sweep.spec.timed_touches,
                    patch,
                    touched,
                    learned: &simulate_array(touched, patch, 1, &Silent).kept,
                    tested: &tested,
                    seed: Seed::new(self.plan.spec.seed),
                    one_thread: &one_thread,
                };
                let sense_us = one_thread.install(|| bench.time_presses());
                for same in of_bench.chunk_by(|a, b| (a.ensemble, a.ratio) == (b.ensemble, b.ratio))
                {
                    let compress = || self.compress(&bench, &same[0]);
                    let Some(before) = left.prepare(&names(same), compress)? else {
                        continue;
                    };
                    for setting in same {
                        left.finish(&self.name(setting), || {
                            self.chain(&bench, setting, (&before, sense_us))
                        })?;
                    }
                }
            }
        }
        Ok(())
    }

    /// The objects, exact and of each level, touched in the same places.
    fn touched(
        &self,
        progress: &dyn Progress,
    ) -> Result<(Vec<TouchedObject>, Vec<Vec<TouchedObject>>)> {
        progress.stage("objects", (1 + self.sweep.levels.len()) as u64);
        let build = |make: &(dyn Fn(&Subject) -> Result<Model> + Sync)| -> Result<Vec<Object>> {
            let objects = self.chosen.par_iter().with_max_len(1).map(|subject| {
                let model = make(subject)?;
                Ok(Object::of_one_part(subject.name(), model))
            });
            let objects = objects.collect();
            progress.advance(1);
            objects
        };
        let finest = self.plan.levels[self.plan.levels.len() - 1];
        let placement = Placement {
            per_object: Some(self.sweep.spec.training_touches + self.sweep.spec.test_touches),
            ..self.plan.placement.clone()
        };
        let seed = Seed::new(self.plan.spec.seed);
        let exact = draw_touches(build(&|subject| subject.exact(finest))?, &placement, &seed)?;
        let levels = self.sweep.levels.iter().map(|&level| {
            let objects = build(&|subject| subject.packed(level, self.packings))?;
            let mut touched = exact.clone();
            for (touched, object) in touched.iter_mut().zip(objects) {
                touched.object = object;
            }
            Ok(touched)
        });
        let levels = levels.collect::<Result<_>>()?;
        Ok((exact, levels))
    }

    /// What comes before every classifier.
    fn compress(&self, bench: &Bench, setting: &Setting) -> Result<Compressed> {
        let grid = bench.patch.grid;
        let measurements = (grid.n_taxels() as f64 / setting.ratio).round().max(1.0) as usize;
        let stream = bench.seed.named("speed accuracy projection");
        let noise = Noise {
            std: self.sweep.spec.noise_std_full_scale,
            unit: NoiseUnit::FullScale,
        };
        let front = Front {
            chain: Chain::new(&[SignalStep::Noise(noise)], bench.patch)?,
            projection: Projection::new(
                setting.ensemble,
                (grid.ny, grid.nx),
                measurements,
                &stream,
            )?,
        };
        let measured = |frames| -> Result<Array2<f64>> {
            let reading = Reading {
                chains: std::slice::from_ref(&front.chain),
                projection: &front.projection,
                taxel: bench.patch.taxel,
                speed: 0.0,
            };
            Ok(measure(reading, (frames, 1), &bench.to_read())?.0)
        };
        Ok(Compressed {
            learned: measured(bench.learned)?,
            tested: measured(bench.tested)?,
            project_us: bench.one_thread.install(|| bench.time_front(&front))?,
        })
    }

    /// Learns from the leading touches of the detail and answers to the others of the exact objects.
    fn chain(
        &self,
        bench: &Bench,
        setting: &Setting,
        (before, sense_us): (&Compressed, f64),
    ) -> Result<SpeedAccuracyRows> {
        let spec = &self.sweep.spec;
        let (n_training, n_all) = (
            spec.training_touches,
            spec.training_touches + spec.test_touches,
        );
        let learned = before.learned.axis_chunks_iter(Axis(0), n_all);
        let training = touches_of(learned, 0..n_training)?;
        let tested = before.tested.axis_chunks_iter(Axis(0), n_all);
        let test = touches_of(tested, n_training..n_all)?;
        let stream = bench.seed.named("speed accuracy training");
        let learn = || -> Result<(ChainScore, [f64; 2])> {
            let start = Instant::now();
            let classifier = Classifier::new(setting.classifier).train(&training, &stream)?;
            let fit_s = start.elapsed().as_secs_f64();
            let accuracy = Accuracy::of(&classifier, &test)?;
            let score = ChainScore {
                n_objects: bench.touched.len(),
                n_training: training.targets.len(),
                n_test: test.targets.len(),
                accuracy: accuracy.share,
                accuracy_low: accuracy.interval.low,
                accuracy_high: accuracy.interval.high,
                n_capped: classifier.n_capped(),
            };
            Ok((score, [bench.time_answers(&classifier, &test)?, fit_s]))
        };
        let (score, [classify_us, fit_s]) = bench.one_thread.install(learn)?;
        let cell = ChainCell {
            pitch_mm: millimetres(bench.patch.grid.pitch),
            n_taxels: bench.patch.grid.n_taxels(),
            tolerance_mm: self.sweep.levels[setting.level],
            ensemble: setting.ensemble,
            ratio: setting.ratio,
            measurements: before.learned.ncols(),
            classifier: setting.classifier,
        };
        let project_us = before.project_us;
        let time = ChainTime {
            sense_us,
            project_us,
            classify_us,
            decision_us: sense_us + project_us + classify_us,
            fit_s,
        };
        Ok(SpeedAccuracyRows {
            chains: vec![(cell, score, time)],
            ..SpeedAccuracyRows::default()
        })
    }
}

/// A pool of one thread, to time on.
fn one_thread() -> Result<rayon::ThreadPool> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.map_err(|error| Error::input("threads", error, "a system that can start one"))
}
