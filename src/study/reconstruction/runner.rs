//! Runs a reconstruction study: touches once, dictionaries once, then every ensemble, m, noise, dictionary and solver.

use super::plan::ReconstructionPlan;
use super::score::{Outcome, pareto, square_errors};
use super::table::{
    EnsembleStatistics, ReconstructionCell, ReconstructionTables, ReconstructionTime,
};
use super::touches::{Noisy, SampleFrames, Touches};
use crate::error::Result;
use crate::random::Seed;
use crate::sensing::{
    Dictionary, Extremes, Projection, Reconstruction, Reconstructor, SensedDictionary, Solver,
};
use crate::study::progress::Progress;
use crate::study::simulation::TouchedObject;
use ndarray::{Array2, ArrayView2, Axis};
use rayon::prelude::*;
use std::time::Instant;

/// Frames reconstructed together by one thread: enough for matrix products, few enough to share out.
const BLOCK: usize = 64;

/// What a reconstruction study found.
#[derive(Clone, Debug)]
pub struct ReconstructionOutcome {
    /// All tables.
    pub tables: ReconstructionTables,
    /// Training touches.
    pub n_train: usize,
    /// A few test frames as they were, as they were read, and as they came back.
    pub samples: SampleFrames,
}

/// Runs a study. The tables but for times are the same bytes at any number of threads.
///
/// # Errors
/// Too few touches for a split; what a stage refuses.
pub fn reconstruct(
    plan: &ReconstructionPlan,
    touched: &[TouchedObject],
    progress: &dyn Progress,
) -> Result<ReconstructionOutcome> {
    let touches = Touches::simulate(plan, touched, progress)?;
    progress.stage("dictionaries", plan.dictionaries.len() as u64);
    let dictionaries = touches.learn(plan, progress)?;
    let mut tables = ReconstructionTables::default();
    let mut reconstructed = Vec::new();
    progress.stage("reconstruct", plan.n_cells() as u64);
    for &ensemble in &plan.ensembles {
        for m in plan.measurement_counts(ensemble) {
            let projection = plan.projection(ensemble, m)?;
            let sensed = dictionaries
                .par_iter()
                .map(|dictionary| Sensing::new(plan, &projection, dictionary))
                .collect::<Result<Vec<_>>>()?;
            for sensing in &sensed {
                tables.ensembles.extend(sensing.statistics.iter().cloned());
            }
            for noisy in &touches.noisy {
                let measurements = projection.measure(noisy.frames.view());
                for sensing in &sensed {
                    for &solver in &plan.solvers {
                        let cell = sensing.cell(plan, noisy.level, solver, tables.timing.len());
                        let job = Job {
                            cell,
                            sensing,
                            noisy,
                            touches: &touches,
                        };
                        let (samples, outcome, time) = job.run(plan, measurements.view())?;
                        let score = touches.truth.score(&outcome, &noisy.errors);
                        tables.reconstruction.push((job.cell.clone(), score));
                        tables.timing.push((job.cell, time));
                        reconstructed.push(samples);
                        progress.advance(1);
                    }
                }
            }
        }
    }
    tables.pareto = pareto(&tables.reconstruction, &tables.timing);
    let samples = touches.samples(reconstructed);
    Ok(ReconstructionOutcome {
        tables,
        n_train: touches.train.nrows(),
        samples,
    })
}

/// A dictionary seen through a projection, and what that keeps apart.
struct Sensing<'a> {
    sensed: SensedDictionary<'a>,
    statistics: Vec<EnsembleStatistics>,
}

impl<'a> Sensing<'a> {
    fn new(
        plan: &ReconstructionPlan,
        projection: &'a Projection,
        dictionary: &'a Dictionary,
    ) -> Result<Self> {
        let sensed = SensedDictionary::new(projection, dictionary)?;
        let coherence = sensed.coherence();
        let n_subsets = plan.spec.reconstruction.isometry_subsets;
        let seed = Seed::new(plan.spec.seed);
        let statistics = plan.isometry_sparsity.iter().map(|&sparsity| {
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
        let statistics = statistics.collect::<Result<Vec<_>>>()?;
        Ok(Self { sensed, statistics })
    }

    fn cell(
        &self,
        plan: &ReconstructionPlan,
        noise_std: f64,
        solver: Solver,
        cell: usize,
    ) -> ReconstructionCell {
        let projection = self.sensed.projection();
        let m = projection.n_measurements();
        ReconstructionCell {
            cell,
            noise_std,
            noise_unit: plan.noise_unit,
            ensemble: projection.ensemble(),
            measurements: m,
            ratio: projection.n_taxels() as f64 / m as f64,
            dictionary: self.sensed.dictionary().basis(),
            atoms: self.sensed.dictionary().n_atoms(),
            solver,
        }
    }
}

/// One cell.
struct Job<'a> {
    cell: ReconstructionCell,
    sensing: &'a Sensing<'a>,
    noisy: &'a Noisy,
    touches: &'a Touches,
}

impl Job<'_> {
    /// The frames for the eye, the errors, and the time.
    fn run(
        &self,
        plan: &ReconstructionPlan,
        measurements: ArrayView2<f64>,
    ) -> Result<(Array2<f64>, Outcome, ReconstructionTime)> {
        let start = Instant::now();
        let reconstructor = Reconstructor::new(
            self.cell.solver,
            &self.sensing.sensed,
            &plan.effort,
            self.noisy.std,
        )?;
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
        Ok((self.shown(&found), self.outcome(&found), time))
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

    fn shown(&self, found: &[Reconstruction]) -> Array2<f64> {
        let rows = &self.touches.shown;
        let mut samples = Array2::zeros((rows.len(), self.touches.test.ncols()));
        for (mut sample, (row, _)) in samples.outer_iter_mut().zip(rows) {
            sample.assign(&found[row / BLOCK].frames.row(row % BLOCK));
        }
        samples
    }
}
