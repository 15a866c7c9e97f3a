//! The part on recognition: what each chain from touch to answer costs, and how often it is right.

use super::bench::Bench;
use super::plan::coarsest_first;
use super::rows::ChainCell;
use super::spec::RecognitionSweepSpec;
use super::study::{SpeedAccuracyRows, SpeedAccuracyStudy};
use super::subject::{Subject, spread_evenly};
use crate::error::{Error, Result};
use crate::objects::{Model, Object};
use crate::random::Seed;
use crate::signal::{Chain, Noise, NoiseUnit, SignalStep};
use crate::study::TouchSet;
use crate::study::measurement::touches_to_read;
use crate::study::pieces::{NamedPiece, PiecesLeft};
use crate::study::plan::millimetres;
use crate::study::progress::{Progress, Silent};
use crate::study::simulation::{TouchedObject, draw_touches, simulate_array};
use crate::study::sweep::nested;
use crate::study::time_left::Piece;
use rayon::prelude::*;

/// A chain, on an array of this number, and objects of a level of this number.
struct Setting {
    array: usize,
    level: usize,
    cell: ChainCell,
}

/// Seconds of a chain, about.
const CHAIN_S: f64 = 0.15;

impl Setting {
    /// What it is called as a work item.
    fn name(&self) -> String {
        let ChainCell {
            classifier,
            ensemble,
            ratio,
            pitch_mm,
            tolerance_mm,
            ..
        } = &self.cell;
        format!(
            "{classifier:?} after {ensemble:?} {ratio}:1 at {pitch_mm} mm, objects within {tolerance_mm} mm"
        )
    }
}

impl SpeedAccuracyStudy {
    /// All chains, those on the same touches and after the same compression following each other.
    fn settings(&self) -> Vec<Setting> {
        let mut settings = Vec::new();
        let Some(spec) = &self.plan.parts().recognition else {
            return settings;
        };
        let levels = coarsest_first(&spec.tolerances_mm);
        nested! {
            (array, on) in self.plan.arrays.iter().enumerate();
            (level, &tolerance_mm) in levels.iter().enumerate();
            &ensemble in &spec.ensemble;
            &ratio in &spec.ratio;
            &classifier in &spec.classifier;
            settings.push(Setting {
                array,
                level,
                cell: ChainCell {
                    pitch_mm: millimetres(on.pitch()),
                    n_taxels: on.n_taxels(),
                    tolerance_mm,
                    ensemble,
                    ratio,
                    measurements: (on.n_taxels() as f64 / ratio).round().max(1.0) as usize,
                    classifier,
                },
            })
        }
        settings
    }

    /// Chains on the same array and detail share their touches; groups before `first_group` are of the other part.
    pub(super) fn chain_pieces(&self, first_group: usize) -> Vec<NamedPiece> {
        let settings = self.settings();
        let n_levels = settings.last().map_or(0, |last| last.level + 1);
        let pieces = settings.iter().map(|setting| {
            let group = first_group + setting.array * n_levels + setting.level;
            NamedPiece::new(setting.name(), group, Piece::one_by_one(2, CHAIN_S))
        });
        pieces.collect()
    }

    /// Touches are made on all threads; fits and decisions are timed on one.
    pub(super) fn measure_chains(&self, left: &PiecesLeft<SpeedAccuracyRows>) -> Result<()> {
        let settings = left.of(self.contact_pieces().len(), self.settings());
        let (Some(spec), false) = (&self.plan.parts().recognition, settings.is_empty()) else {
            return Ok(());
        };
        let build = || self.touched(spec, left.progress);
        let Some((exact, levels)) = left.prepare(&numbers(&settings), build)? else {
            return Ok(());
        };
        left.progress.stage("recognise", settings.len() as u64);
        let seed = Seed::new(self.plan.spec.seed);
        let to_read = &touches_to_read(exact.classes(), &seed.named("speed accuracy signal"));
        let one_thread = &one_thread()?;
        for of_array in settings.chunk_by(|(_, a), (_, b)| a.array == b.array) {
            let array = &self.plan.arrays[of_array[0].1.array];
            let noise = SignalStep::Noise(Noise {
                std: spec.noise_std_full_scale,
                unit: NoiseUnit::FullScale,
            });
            let chain = &Chain::new(&[noise], array.patch())?;
            let tested = &simulate_array(&exact, array, 1, &Silent);
            for of_level in of_array.chunk_by(|(_, a), (_, b)| a.level == b.level) {
                let touched = &levels[of_level[0].1.level];
                let bench = Bench {
                    spec,
                    seed,
                    array,
                    touched,
                    learned: &simulate_array(touched, array, 1, &Silent),
                    tested,
                    to_read,
                    chain,
                    one_thread,
                };
                let sense_us = one_thread.install(|| bench.time_presses());
                let compression =
                    |(_, setting): &(usize, Setting)| (setting.cell.ensemble, setting.cell.ratio);
                for same in of_level.chunk_by(|a, b| compression(a) == compression(b)) {
                    let compress = || bench.compress(&same[0].1.cell, sense_us);
                    let Some(measured) = left.prepare(&numbers(same), compress)? else {
                        continue;
                    };
                    for (number, setting) in same {
                        left.finish(*number, || {
                            let row = one_thread.install(|| bench.row(&setting.cell, &measured))?;
                            Ok((Vec::new(), vec![row]))
                        })?;
                    }
                }
            }
        }
        Ok(())
    }

    /// Some of the objects, exact and of each level, touched in the same places.
    fn touched(
        &self,
        spec: &RecognitionSweepSpec,
        progress: &dyn Progress,
    ) -> Result<(Vec<TouchedObject>, Vec<Vec<TouchedObject>>)> {
        let chosen = spread_evenly(&self.subjects, spec.objects);
        let levels = coarsest_first(&spec.tolerances_mm);
        progress.stage("objects", (1 + levels.len()) as u64);
        let build = |make: &(dyn Fn(&Subject) -> Result<Model> + Sync)| -> Result<Vec<Object>> {
            let objects = chosen.par_iter().with_max_len(1).map(|subject| {
                let model = make(subject)?;
                Ok(Object::of_one_part(subject.name(), model))
            });
            let objects = objects.collect();
            progress.advance(1);
            objects
        };
        let placement = self.plan.placement_of(spec.n_touches());
        let seed = Seed::new(self.plan.spec.seed);
        let exact = build(&|subject| subject.exact(self.plan.finest()))?;
        let exact = draw_touches(exact, &placement, &seed)?;
        let levels = levels.iter().map(|&level| {
            let objects = build(&|subject| subject.packed(level, self.packings.as_deref()))?;
            let touched = exact.iter().zip(objects);
            let touched = touched.map(|(exact, object)| TouchedObject {
                object,
                ..exact.clone()
            });
            Ok(touched.collect())
        });
        let levels = levels.collect::<Result<_>>()?;
        Ok((exact, levels))
    }
}

fn numbers(settings: &[(usize, Setting)]) -> Vec<usize> {
    settings.iter().map(|(number, _)| *number).collect()
}

/// A pool of one thread, to time on.
fn one_thread() -> Result<rayon::ThreadPool> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.map_err(|error| Error::input("threads", error, "a system that can start one"))
}
