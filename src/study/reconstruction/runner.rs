//! Runs a reconstruction study: touches once, dictionaries once, then every ensemble, m, noise, dictionary and solver.

use super::plan::ReconstructionPlan;
use super::score::{Outcome, pareto, square_errors};
use super::table::{
    EnsembleStatistics, ReconstructionCell, ReconstructionScore, ReconstructionTables,
    ReconstructionTime,
};
use super::touches::{Noisy, SampleFrames, Touches};
use crate::error::Result;
use crate::random::Seed;
use crate::sensing::{
    Basis, Dictionary, Ensemble, Extremes, Reconstruction, Reconstructor, SensedDictionary, Solver,
};
use crate::study::pieces::{NamedPiece, PieceRows, PieceStudy, PiecesLeft};
use crate::study::progress::{Progress, Silent};
use crate::study::simulation::TouchedObject;
use ndarray::{ArrayView2, Axis};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::OnceLock;
use std::time::Instant;

/// Frames reconstructed together by one thread: enough for matrix products, few enough to share out.
const BLOCK: usize = 64;

/// A reconstruction study and its touches.
pub struct ReconstructionStudy {
    /// What to run.
    pub plan: ReconstructionPlan,
    /// What is touched.
    pub touched: Vec<TouchedObject>,
    /// Their frames, once something needed them.
    frames: OnceLock<Touches>,
}

/// An ensemble with its m: what reconstructs from the same measurements.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Measured {
    ensemble: Ensemble,
    m: usize,
}

/// A cell that is to be: its number, its noise level by number, dictionary and solver.
#[derive(Clone, Copy, Debug)]
struct Wanted {
    number: usize,
    noise: usize,
    dictionary: Basis,
    solver: Solver,
}

impl PieceStudy for ReconstructionStudy {
    type Rows = ReconstructionTables;
    type Tables = ReconstructionTables;

    /// Of each ensemble and m what every dictionary keeps apart, then its cells.
    fn pieces(&self) -> Vec<NamedPiece> {
        let mut pieces = Vec::new();
        for (group, measured) in self.measured().into_iter().enumerate() {
            let dictionaries = self.plan.dictionaries.iter();
            let statistics = dictionaries.map(|&basis| statistics_name(measured, basis));
            let cells = self.cells(group).into_iter();
            let names = statistics.chain(cells.map(|cell| cell_name(measured, &cell)));
            pieces.extend(names.map(|name| NamedPiece { name, group }));
        }
        pieces
    }

    fn measure(&self, left: &PiecesLeft<ReconstructionTables>) -> Result<()> {
        let all: Vec<String> = self.pieces().into_iter().map(|piece| piece.name).collect();
        let names = left.of(all, String::clone);
        let Some(touches) = left.prepare(&names, || self.frames(left.progress))? else {
            return Ok(());
        };
        let bases = self.plan.dictionaries.iter().copied();
        let bases: Vec<Basis> = bases.filter(|&basis| self.needs(left, basis)).collect();
        left.progress.stage("dictionaries", bases.len() as u64);
        let learn = || touches.learn(&self.plan, &bases, left.progress);
        let Some(dictionaries) = left.prepare(&names, learn)? else {
            return Ok(());
        };
        left.progress.stage("reconstruct", names.len() as u64);
        for (group, measured) in self.measured().into_iter().enumerate() {
            let on = OnMeasured {
                study: self,
                measured,
                cells: self.cells(group),
                touches,
            };
            on.measure(&dictionaries, left)?;
        }
        Ok(())
    }

    fn tables(&self, mut tables: ReconstructionTables) -> Result<ReconstructionTables> {
        tables.pareto = pareto(&tables.reconstruction, &tables.timing);
        Ok(tables)
    }
}

impl PieceRows for ReconstructionTables {
    fn append(&mut self, next: Self) {
        self.reconstruction.extend(next.reconstruction);
        self.timing.extend(next.timing);
        self.ensembles.extend(next.ensembles);
    }
}

fn statistics_name(Measured { ensemble, m }: Measured, basis: Basis) -> String {
    format!("isometry of {ensemble:?}, m = {m}, {basis:?}")
}

fn cell_name(Measured { ensemble, m }: Measured, cell: &Wanted) -> String {
    let Wanted {
        number,
        dictionary,
        solver,
        ..
    } = cell;
    format!("cell {number}: {solver:?} in {dictionary:?} of {ensemble:?}, m = {m}")
}

impl ReconstructionStudy {
    /// Of a plan and its touches.
    pub fn new(plan: ReconstructionPlan, touched: Vec<TouchedObject>) -> Self {
        Self {
            plan,
            touched,
            frames: OnceLock::new(),
        }
    }

    /// Training touches, and test touches.
    ///
    /// # Errors
    /// Too few touches for a split.
    pub fn n_touches(&self) -> Result<(usize, usize)> {
        let touches = self.frames(&Silent)?;
        Ok((touches.train.nrows(), touches.test.nrows()))
    }

    /// A few test frames as they were, as they were read, and as some cells reconstruct them.
    ///
    /// # Errors
    /// As of a run.
    pub fn samples(&self, cells: &[&ReconstructionCell]) -> Result<SampleFrames> {
        let touches = self.frames(&Silent)?;
        let mut reconstructed = BTreeMap::new();
        for cell in cells {
            let dictionaries = touches.learn(&self.plan, &[cell.dictionary], &Silent)?;
            let projection = self.plan.projection(cell.ensemble, cell.measurements)?;
            let sensed = SensedDictionary::new(&projection, &dictionaries[0])?;
            let levels = touches.noisy.iter();
            let mut of_level = levels.filter(|noisy| noisy.level == cell.noise_std);
            let Some(noisy) = of_level.next() else {
                continue;
            };
            let (solver, effort) = (cell.solver, &self.plan.effort);
            let reconstructor = Reconstructor::new(solver, &sensed, effort, noisy.std)?;
            let shown = touches.pick(&noisy.frames);
            let found = reconstructor.reconstruct(projection.measure(shown.view()).view())?;
            reconstructed.insert(cell.cell, found.frames);
        }
        Ok(touches.samples(reconstructed))
    }

    fn frames(&self, progress: &dyn Progress) -> Result<&Touches> {
        if let Some(frames) = self.frames.get() {
            return Ok(frames);
        }
        let made = Touches::simulate(&self.plan, &self.touched, progress)?;
        Ok(self.frames.get_or_init(|| made))
    }

    /// Ensembles outside, m inside: each a group of pieces.
    fn measured(&self) -> Vec<Measured> {
        let of_ensemble = |&ensemble: &Ensemble| {
            let counts = self.plan.measurement_counts(ensemble).into_iter();
            counts.map(move |m| Measured { ensemble, m })
        };
        self.plan.ensembles.iter().flat_map(of_ensemble).collect()
    }

    /// The cells of a group; as many as of every other.
    fn cells(&self, group: usize) -> Vec<Wanted> {
        let plan = &self.plan;
        let per_group = plan.noise.len() * plan.dictionaries.len() * plan.solvers.len();
        let mut cells = Vec::with_capacity(per_group);
        for noise in 0..plan.noise.len() {
            for &dictionary in &plan.dictionaries {
                for &solver in &plan.solvers {
                    cells.push(Wanted {
                        number: group * per_group + cells.len(),
                        noise,
                        dictionary,
                        solver,
                    });
                }
            }
        }
        cells
    }

    /// Whether something that is left is made of a dictionary.
    fn needs(&self, left: &PiecesLeft<ReconstructionTables>, basis: Basis) -> bool {
        let mut groups = self.measured().into_iter().enumerate();
        groups.any(|(group, measured)| {
            let cells = self.cells(group);
            let of_basis = cells.iter().filter(|cell| cell.dictionary == basis);
            let mut names = of_basis.map(|cell| cell_name(measured, cell));
            left.has(&statistics_name(measured, basis)) || names.any(|name| left.has(&name))
        })
    }
}

/// All that is made of an ensemble and m.
struct OnMeasured<'a> {
    study: &'a ReconstructionStudy,
    measured: Measured,
    cells: Vec<Wanted>,
    touches: &'a Touches,
}

impl OnMeasured<'_> {
    fn measure(
        &self,
        dictionaries: &[Dictionary],
        left: &PiecesLeft<ReconstructionTables>,
    ) -> Result<()> {
        let plan = &self.study.plan;
        let Measured { ensemble, m } = self.measured;
        let needed = dictionaries.iter();
        let needed: Vec<(&Dictionary, Vec<String>)> = needed
            .map(|dictionary| (dictionary, self.names(dictionary.basis(), left)))
            .filter(|(_, names)| !names.is_empty())
            .collect();
        let names: Vec<String> = needed.iter().flat_map(|(_, names)| names.clone()).collect();
        if names.is_empty() {
            return Ok(());
        }
        let Some(projection) = left.prepare(&names, || plan.projection(ensemble, m))? else {
            return Ok(());
        };
        let sensed = needed
            .into_par_iter()
            .map(|(dictionary, names)| {
                let sensed =
                    left.prepare(&names, || SensedDictionary::new(&projection, dictionary))?;
                if let Some(sensed) = &sensed {
                    let name = statistics_name(self.measured, dictionary.basis());
                    left.finish(&name, || {
                        Ok(ReconstructionTables {
                            ensembles: statistics(plan, sensed)?,
                            ..ReconstructionTables::default()
                        })
                    })?;
                }
                Ok(sensed)
            })
            .collect::<Result<Vec<_>>>()?;
        let sensed: Vec<SensedDictionary> = sensed.into_iter().flatten().collect();
        for (noise, noisy) in self.touches.noisy.iter().enumerate() {
            let cells = self.cells.iter().filter(|cell| cell.noise == noise);
            let cells = left.of(cells, |cell| cell_name(self.measured, cell));
            if cells.is_empty() {
                continue;
            }
            let measurements = projection.measure(noisy.frames.view());
            for wanted in cells {
                let basis = wanted.dictionary;
                let Some(sensed) = sensed.iter().find(|s| s.dictionary().basis() == basis) else {
                    continue;
                };
                let job = Job {
                    cell: cell(plan, sensed, noisy.level, wanted),
                    sensed,
                    noisy,
                    touches: self.touches,
                };
                left.finish(&cell_name(self.measured, wanted), || {
                    let (score, time) = job.run(plan, measurements.view())?;
                    Ok(ReconstructionTables {
                        reconstruction: vec![(job.cell.clone(), score)],
                        timing: vec![(job.cell.clone(), time)],
                        ..ReconstructionTables::default()
                    })
                })?;
            }
        }
        Ok(())
    }

    /// What is left that is made of a dictionary.
    fn names(&self, basis: Basis, left: &PiecesLeft<ReconstructionTables>) -> Vec<String> {
        let cells = self.cells.iter().filter(|cell| cell.dictionary == basis);
        let cells = cells.map(|cell| cell_name(self.measured, cell));
        let names = cells.chain([statistics_name(self.measured, basis)]);
        left.of(names, String::clone)
    }
}

/// What a dictionary keeps apart, seen through a projection.
fn statistics(
    plan: &ReconstructionPlan,
    sensed: &SensedDictionary,
) -> Result<Vec<EnsembleStatistics>> {
    let (projection, dictionary) = (sensed.projection(), sensed.dictionary());
    let coherence = sensed.coherence();
    let n_subsets = plan.spec.reconstruction.isometry_subsets;
    let seed = Seed::new(plan.spec.seed);
    let rows = plan.isometry_sparsity.iter().map(|&sparsity| {
        let sparsity = sparsity.min(dictionary.n_atoms());
        let extremes = sensed.isometry(sparsity, n_subsets, &seed)?;
        let quantile = |of: fn(&Extremes) -> f64, part: f64| {
            let mut values: Vec<f64> = extremes.iter().map(of).collect();
            values.sort_by(f64::total_cmp);
            values[((values.len() - 1) as f64 * part).round() as usize]
        };
        let low = |e: &Extremes| e.low;
        let high = |e: &Extremes| e.high;
        Ok(EnsembleStatistics {
            ensemble: projection.ensemble(),
            measurements: projection.n_measurements(),
            ratio: projection.n_taxels() as f64 / projection.n_measurements() as f64,
            dictionary: dictionary.basis(),
            atoms: dictionary.n_atoms(),
            coherence: coherence.mutual,
            welch_bound: coherence.welch_bound,
            n_invisible: coherence.n_invisible,
            sparsity,
            n_subsets,
            low_min: quantile(low, 0.0),
            low_median: quantile(low, 0.5),
            high_median: quantile(high, 0.5),
            high_max: quantile(high, 1.0),
            deviation_median: quantile(Extremes::deviation, 0.5),
            delta_lower_bound: quantile(Extremes::deviation, 1.0),
        })
    });
    rows.collect()
}

fn cell(
    plan: &ReconstructionPlan,
    sensed: &SensedDictionary,
    noise_std: f64,
    wanted: &Wanted,
) -> ReconstructionCell {
    let projection = sensed.projection();
    let m = projection.n_measurements();
    ReconstructionCell {
        cell: wanted.number,
        noise_std,
        noise_unit: plan.noise_unit,
        ensemble: projection.ensemble(),
        measurements: m,
        ratio: projection.n_taxels() as f64 / m as f64,
        dictionary: wanted.dictionary,
        atoms: sensed.dictionary().n_atoms(),
        solver: wanted.solver,
    }
}

/// One cell.
struct Job<'a> {
    cell: ReconstructionCell,
    sensed: &'a SensedDictionary<'a>,
    noisy: &'a Noisy,
    touches: &'a Touches,
}

impl Job<'_> {
    /// The errors, and the time.
    fn run(
        &self,
        plan: &ReconstructionPlan,
        measurements: ArrayView2<f64>,
    ) -> Result<(ReconstructionScore, ReconstructionTime)> {
        let start = Instant::now();
        let reconstructor =
            Reconstructor::new(self.cell.solver, self.sensed, &plan.effort, self.noisy.std)?;
        let prepare_s = start.elapsed().as_secs_f64();
        let blocks = measurements
            .axis_chunks_iter(Axis(0), BLOCK)
            .into_par_iter()
            .map(|block| {
                let start = Instant::now();
                let found = reconstructor.reconstruct(block)?;
                Ok((found, start.elapsed().as_secs_f64()))
            })
            .collect::<Result<Vec<_>>>()?;
        let seconds = blocks.iter().map(|(_, seconds)| seconds).sum::<f64>();
        let us_per_frame = 1e6 * seconds / measurements.nrows() as f64;
        let time = ReconstructionTime {
            prepare_s,
            us_per_frame,
            frames_per_s_per_core: 1e6 / us_per_frame,
        };
        let found: Vec<Reconstruction> = blocks.into_iter().map(|(found, _)| found).collect();
        let truth = &self.touches.truth;
        let score = truth.score(&self.outcome(&found), &self.noisy.errors);
        Ok((score, time))
    }

    fn outcome(&self, found: &[Reconstruction]) -> Outcome {
        let clean = self.touches.test.axis_chunks_iter(Axis(0), BLOCK);
        let blocks = found.iter().zip(clean);
        Outcome {
            errors: blocks
                .flat_map(|(block, clean)| square_errors(block.frames.view(), clean))
                .collect(),
            n_atoms: found.iter().flat_map(|block| &block.n_atoms).sum(),
            n_capped: found
                .iter()
                .flat_map(|block| &block.capped)
                .filter(|&&capped| capped)
                .count(),
        }
    }
}
