//! Memory estimate of a reconstruction study.

use crate::engine::work_items::scale::Stage;
use crate::sensing::{Basis, PCA_ATOMS, Solver};
use crate::studies::reconstruction::plan::ReconstructionPlan;

/// Memory of the charts and of the picture of sample frames, bytes.
const PICTURE_BYTES: f64 = 1.4e8;

/// Returns the memory of the frames of a study with `n_touches` touches, bytes, which the whole run keeps, and the memory of its stages.
pub(super) fn memory(plan: &ReconstructionPlan, n_touches: usize) -> (f64, Vec<Stage>) {
    let wanted = &plan.spec.reconstruction;
    let n = plan.array.n_taxels() as f64;
    let n_test = (n_touches as f64 * wanted.test_fraction).ceil();
    let n_train = n_touches as f64 - n_test;
    let atoms = |basis: &Basis| {
        let asked = wanted.atoms.map(|k| k as f64);
        match basis {
            Basis::Pca => asked.unwrap_or(PCA_ATOMS as f64).min(n).min(n_train),
            _ => asked.unwrap_or(n).min(n),
        }
    };
    let stored = plan
        .dictionaries
        .iter()
        .filter(|basis| **basis == Basis::Pca);
    let stored: f64 = stored.map(|basis| atoms(basis) * n).sum();
    // Test frames are kept without noise and at each noise level.
    let frames = n_train + n_test * (1.0 + plan.noise.len() as f64);
    let kept = 8.0 * (n * frames + stored);
    let is_linear = wanted.solver.values().contains(&Solver::Lmmse);
    let matrices = plan
        .spec
        .sensing
        .ensemble
        .values()
        .into_iter()
        .flat_map(|ensemble| {
            let counts = plan.measurement_counts(ensemble).into_iter();
            counts.map(move |m| (ensemble, m as f64))
        });
    let matrices = matrices.map(|(ensemble, m)| {
        // Measured atoms and their Gram matrix, of each dictionary.
        let sensed: f64 = plan
            .dictionaries
            .iter()
            .map(atoms)
            .map(|k| k * m + k * k)
            .sum();
        // The linear estimate needs the covariances of the measurements and of their noise, and its maps to coefficients and to frames.
        let linear = plan.dictionaries.iter().map(atoms).map(|k| {
            let map = if k * (m + n) < m * n { k * n } else { m * n };
            2.0 * k * m + 2.0 * m * m + map
        });
        let linear = if is_linear {
            linear.fold(0.0, f64::max)
        } else {
            0.0
        };
        (ensemble.about().bytes)(m, n) + 8.0 * (sensed + linear + n_test * m)
    });
    let stages = [matrices.fold(0.0, f64::max), PICTURE_BYTES];
    let stage = |bytes: f64| Stage {
        bytes,
        items: Vec::new(),
    };
    (kept, stages.map(stage).to_vec())
}
