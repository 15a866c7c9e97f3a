//! Reconstruction of frames by all configurations that use equal measurements.

use crate::sensing::{Extremes, Reconstructor, SensedDictionary};
use crate::studies::prelude::*;
use crate::studies::reconstruction::plan::*;
use crate::studies::reconstruction::rows::*;
use crate::studies::reconstruction::touches::{Found, Noisy, Touches, square_errors};
use ndarray::{Array2, Axis};
use rayon::prelude::*;
use std::time::Instant;

/// Number of frames that a thread reconstructs together. With a smaller value, matrix products are less efficient; with a larger value, threads finish at
/// different times.
const BLOCK: usize = 64;

/// Computes the pending configurations, given by index, of one ensemble and one number m of measurements. A dictionary is computed when the first work item
/// needs it.
pub(super) fn measure_cells(
    (plan, touches): (&ReconstructionPlan, &Touches),
    (group, configurations): (usize, &[ReconstructionConfiguration]),
    left: &PendingItems<ReconstructionRows>,
) -> Result<()> {
    let first = &configurations[0];
    // In each group, the isometry items of all dictionaries come before the configurations.
    let n_dictionaries = plan.dictionaries.len();
    let isometries = first.configuration + group * n_dictionaries;
    let projection = Shared::default();
    let projection = || projection.get(|| plan.projection(first.ensemble, first.measurements));
    let sensed = plan.of_each_dictionary();
    let sense = |basis: Basis| {
        let sense = || SensedDictionary::new(projection()?, touches.dictionary(plan, basis)?);
        sensed[plan.place_of(basis)].get(sense)
    };
    let dictionaries = plan.dictionaries.par_iter().enumerate();
    dictionaries.try_for_each(|(place, &basis)| {
        left.finish(isometries + place, || {
            Ok((Vec::new(), statistics(plan, sense(basis)?)?))
        })
    })?;
    let of_levels = configurations.chunk_by(|a, b| a.noise_std == b.noise_std);
    for (noisy, configurations) in touches.noisy.iter().zip(of_levels) {
        let measurements = Shared::default();
        for configuration in configurations {
            left.finish(
                configuration.configuration + (group + 1) * n_dictionaries,
                || {
                    let measure = || Ok(projection()?.measure(noisy.frames.view()));
                    let measurements = measurements.get(measure)?;
                    let sensed = sense(configuration.dictionary)?;
                    let row = reconstruct(
                        (plan, touches),
                        configuration,
                        sensed,
                        (noisy, measurements),
                    )?;
                    Ok((vec![row], Vec::new()))
                },
            )?;
        }
    }
    Ok(())
}

/// Reconstructs all test frames with one configuration; returns the reconstruction errors and the computing times.
fn reconstruct(
    (plan, touches): (&ReconstructionPlan, &Touches),
    configuration: &ReconstructionConfiguration,
    sensed: &SensedDictionary,
    (noisy, measurements): (&Noisy, &Array2<f64>),
) -> Result<ReconstructionRow> {
    let start = Instant::now();
    let effort = &plan.spec.reconstruction.effort();
    let reconstructor = Reconstructor::new(configuration.solver, sensed, effort, noisy.std)?;
    let prepare_s = start.elapsed().as_secs_f64();
    let clean = touches.test.axis_chunks_iter(Axis(0), BLOCK);
    let blocks = measurements.axis_chunks_iter(Axis(0), BLOCK);
    let blocks = blocks.into_par_iter().zip(clean.into_par_iter());
    let found = blocks.map(|(measurements, clean)| {
        let start = Instant::now();
        let back = reconstructor.reconstruct(measurements)?;
        Ok(Found {
            seconds: start.elapsed().as_secs_f64(),
            errors: square_errors(back.frames.view(), clean),
            n_atoms: back.n_atoms.iter().sum(),
            n_capped: back.capped.iter().filter(|&&capped| capped).count(),
        })
    });
    let found = found.collect::<Result<Vec<Found>>>()?;
    let seconds: f64 = found.iter().map(|block| block.seconds).sum();
    let us_per_frame = 1e6 * seconds / measurements.nrows() as f64;
    let configuration = ReconstructionConfiguration {
        atoms: sensed.dictionary().n_atoms(),
        ..configuration.clone()
    };
    let time = ReconstructionTime {
        prepare_s,
        us_per_frame,
        frames_per_s_per_core: 1e6 / us_per_frame,
    };
    Ok((
        configuration,
        touches.truth.score(&found, &noisy.errors),
        time,
    ))
}

/// Returns the isometry statistics of a measurement matrix times a dictionary, with one row per support size (number of drawn columns).
fn statistics(
    plan: &ReconstructionPlan,
    sensed: &SensedDictionary,
) -> Result<Vec<EnsembleStatistics>> {
    let (projection, dictionary) = (sensed.projection(), sensed.dictionary());
    let coherence = sensed.coherence();
    let n_subsets = plan.spec.reconstruction.isometry_subsets;
    let seed = Seed::new(plan.spec.seed);
    let sizes = plan.spec.reconstruction.isometry_sparsity.values();
    let rows = sizes.into_iter().map(|sparsity| {
        let sparsity = sparsity.min(dictionary.n_atoms());
        let extremes = sensed.isometry(sparsity, n_subsets, &seed)?;
        let quantile = |of: fn(&Extremes) -> f64, part: f64| {
            let mut values: Vec<f64> = extremes.iter().map(of).collect();
            values.sort_by(f64::total_cmp);
            values[((values.len() - 1) as f64 * part).round() as usize]
        };
        let (low, high) = (|e: &Extremes| e.low, |e: &Extremes| e.high);
        Ok(EnsembleStatistics {
            ensemble: projection.ensemble().expect("a study draws its matrix"),
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
