//! Runs a reconstruction study: touches once, dictionaries once, then every ensemble, m, noise, dictionary and solver.

use super::plan::ReconstructionPlan;
use super::score::{Outcome, Truth, pareto, square_errors};
use super::table::{
    EnsembleStatistics, ReconstructionCell, ReconstructionTables, ReconstructionTime,
};
use crate::error::Result;
use crate::random::Seed;
use crate::recognition::split::{Split, stratified_hold_out};
use crate::sensing::{
    Dictionary, Ensemble, Extremes, Projection, Reconstruction, Reconstructor, SensedDictionary,
    Solver,
};
use crate::signal::{Chain, Noise};
use crate::study::measurement::{Reading, measure, touch_seeds};
use crate::study::progress::Progress;
use crate::study::simulation::{Frames, TouchedObject, simulate_array};
use ndarray::{Array2, ArrayView2, Axis};
use rayon::prelude::*;
use std::time::Instant;

/// Frames reconstructed together by one thread: enough for matrix products, few enough to share out.
const BLOCK: usize = 64;
/// Test frames that are kept for the eye.
const N_SAMPLES: usize = 3;

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

/// Test frames for the eye, n_samples × n each.
#[derive(Clone, Debug)]
pub struct SampleFrames {
    /// Objects' names.
    pub names: Vec<String>,
    /// Without noise.
    pub clean: Array2<f64>,
    /// At each level of the noise axis.
    pub noisy: Vec<(f64, Array2<f64>)>,
    /// As each cell reconstructed them.
    pub reconstructed: Vec<Array2<f64>>,
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
            let projection = draw(plan, ensemble, m)?;
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

/// Frames of all touches, split.
struct Touches {
    /// Clean training frames.
    train: Array2<f64>,
    /// Clean test frames.
    test: Array2<f64>,
    truth: Truth,
    noisy: Vec<Noisy>,
    /// The test rows that are kept for the eye, and their objects.
    shown: Vec<(usize, String)>,
}

/// Test frames at one noise level.
struct Noisy {
    level: f64,
    /// σ of a taxel, in the frame's unit.
    std: f64,
    frames: Array2<f64>,
    /// ‖noise‖² of each frame.
    errors: Vec<f64>,
}

impl Touches {
    fn simulate(
        plan: &ReconstructionPlan,
        touched: &[TouchedObject],
        progress: &dyn Progress,
    ) -> Result<Self> {
        let n_touches: usize = touched.iter().map(|t| t.touches.len()).sum();
        progress.stage("touch", n_touches as u64);
        let frames = simulate_array(touched, &plan.patch, progress);
        let seed = Seed::new(plan.spec.seed);
        let labels = touched
            .iter()
            .enumerate()
            .flat_map(|(label, t)| std::iter::repeat_n(label, t.touches.len()))
            .collect::<ndarray::Array1<usize>>();
        let fraction = plan.spec.reconstruction.test_fraction;
        let split = stratified_hold_out(labels.view(), fraction, &seed.named("split").numbered(0))?;
        let seeds = touch_seeds(touched, &seed.named("signal").numbered(0));
        let read = |rows: &[usize], noise| read(plan, &frames, &seeds, rows, noise);
        let test = read(&split.test, None)?;
        let noisy = plan.noise.iter().map(|&level| {
            let frames = read(&split.test, Some(level))?;
            let noise = Noise {
                std: level,
                unit: plan.noise_unit,
            };
            Ok(Noisy {
                level,
                std: noise.std_of(plan.quantity(), &plan.patch.taxel)?,
                errors: square_errors(frames.view(), test.view()),
                frames,
            })
        });
        let noisy = noisy.collect::<Result<Vec<_>>>()?;
        let one = Noise {
            std: 1.0,
            unit: crate::signal::NoiseUnit::FullScale,
        };
        let full_scale = one.std_of(plan.quantity(), &plan.patch.taxel)?;
        Ok(Self {
            train: read(&split.train, None)?,
            truth: Truth::new(&test, full_scale),
            shown: shown(touched, &labels, &split),
            test,
            noisy,
        })
    }

    fn learn(&self, plan: &ReconstructionPlan, progress: &dyn Progress) -> Result<Vec<Dictionary>> {
        let grid = (plan.patch.grid.ny, plan.patch.grid.nx);
        let atoms = plan.spec.reconstruction.atoms;
        let seed = Seed::new(plan.spec.seed).named("dictionary");
        plan.dictionaries
            .par_iter()
            .map(|&basis| {
                let learned = Dictionary::learned(basis, grid, self.train.view(), atoms, &seed);
                progress.advance(1);
                learned
            })
            .collect()
    }

    fn samples(&self, reconstructed: Vec<Array2<f64>>) -> SampleFrames {
        let rows: Vec<usize> = self.shown.iter().map(|(row, _)| *row).collect();
        let pick = |frames: &Array2<f64>| frames.select(Axis(0), &rows);
        SampleFrames {
            names: self.shown.iter().map(|(_, name)| name.clone()).collect(),
            clean: pick(&self.test),
            noisy: self
                .noisy
                .iter()
                .map(|n| (n.level, pick(&n.frames)))
                .collect(),
            reconstructed,
        }
    }
}

/// Frames of some touches, with or without noise.
fn read(
    plan: &ReconstructionPlan,
    frames: &Frames,
    seeds: &[Seed],
    rows: &[usize],
    noise: Option<f64>,
) -> Result<Array2<f64>> {
    let chain = Chain::new(&plan.signal_steps(noise), &plan.patch)?;
    let projection = draw(plan, Ensemble::Identity, 1)?;
    let reading = Reading {
        chain: &chain,
        projection: &projection,
        taxel: plan.patch.taxel,
        speed: plan.speed,
    };
    let deflection = frames.deflection.select(Axis(0), rows);
    let seeds: Vec<Seed> = rows.iter().map(|&row| seeds[row]).collect();
    Ok(measure(reading, deflection.view(), &seeds).values)
}

fn draw(plan: &ReconstructionPlan, ensemble: Ensemble, m: usize) -> Result<Projection> {
    let grid = (plan.patch.grid.ny, plan.patch.grid.nx);
    let seed = Seed::new(plan.spec.seed).named("projection").numbered(0);
    Projection::new(ensemble, grid, m, &seed)
}

/// The first test touch of a few objects spread over the list.
fn shown(
    touched: &[TouchedObject],
    labels: &ndarray::Array1<usize>,
    split: &Split,
) -> Vec<(usize, String)> {
    let n = N_SAMPLES.min(touched.len());
    let objects = (0..n).map(|sample| sample * touched.len() / n);
    objects
        .filter_map(|object| {
            let row = split
                .test
                .iter()
                .position(|&touch| labels[touch] == object)?;
            Some((row, touched[object].object.name.clone()))
        })
        .collect()
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
