//! What a dictionary keeps apart, seen through a projection.

use super::plan::ReconstructionPlan;
use super::rows::EnsembleStatistics;
use crate::error::Result;
use crate::random::Seed;
use crate::sensing::{Extremes, SensedDictionary};

/// A row a size of supports.
pub(super) fn statistics(
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
