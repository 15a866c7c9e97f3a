//! All that is reconstructed from the same measurements.

use super::isometry::statistics;
use super::plan::ReconstructionPlan;
use super::rows::{ReconstructionCell, ReconstructionRows, ReconstructionTime};
use super::score::{Outcome, square_errors};
use super::touches::{Noisy, Touches};
use crate::error::Result;
use crate::sensing::{Basis, Dictionary, Reconstruction, Reconstructor, SensedDictionary};
use crate::study::pieces::{PiecesLeft, Shared};
use ndarray::{Array2, Axis};
use rayon::prelude::*;
use std::time::Instant;

/// Frames reconstructed together by one thread: enough for matrix products, few enough to share out.
const BLOCK: usize = 64;

/// All cells of an ensemble and m.
pub(super) struct OnMeasured<'a> {
    pub plan: &'a ReconstructionPlan,
    /// At least one.
    pub cells: &'a [ReconstructionCell],
    pub touches: &'a Touches,
}

impl OnMeasured<'_> {
    /// Does what is left of it; a dictionary is learned when something needs it.
    pub fn measure<'d>(
        &self,
        learned: &(impl Fn(Basis) -> Result<&'d Dictionary> + Sync),
        left: &PiecesLeft<ReconstructionRows>,
    ) -> Result<()> {
        let (plan, first) = (self.plan, &self.cells[0]);
        let isometry = |basis: &&Basis| left.has(&first.isometry_name(**basis));
        let isometries: Vec<&Basis> = plan.dictionaries.iter().filter(isometry).collect();
        let cells = left.of(self.cells, |cell| cell.name());
        if isometries.is_empty() && cells.is_empty() {
            return Ok(());
        }
        let projection = Shared::default();
        let projection = || projection.get(|| plan.projection(first.ensemble, first.measurements));
        // By one, before several ask for it at once; whoever needs it says what is wrong with it.
        let _ = projection();
        let n_bases = plan.dictionaries.len();
        let sensed: Vec<_> = (0..n_bases).map(|_| Shared::default()).collect();
        let sense = |basis: Basis| {
            sensed[plan.place_of(basis)]
                .get(|| SensedDictionary::new(projection()?, learned(basis)?))
        };
        isometries.into_par_iter().try_for_each(|&basis| {
            left.finish(&first.isometry_name(basis), || {
                Ok(ReconstructionRows {
                    ensembles: statistics(plan, sense(basis)?)?,
                    ..ReconstructionRows::default()
                })
            })
        })?;
        for noisy in &self.touches.noisy {
            let measurements = Shared::default();
            for cell in cells.iter().filter(|cell| cell.noise_std == noisy.level) {
                left.finish(&cell.name(), || {
                    let measure = || Ok(projection()?.measure(noisy.frames.view()));
                    let measurements = measurements.get(measure)?;
                    self.reconstruct(cell, sense(cell.dictionary)?, noisy, measurements)
                })?;
            }
        }
        Ok(())
    }

    /// Errors and times of a cell.
    fn reconstruct(
        &self,
        cell: &ReconstructionCell,
        sensed: &SensedDictionary,
        noisy: &Noisy,
        measurements: &Array2<f64>,
    ) -> Result<ReconstructionRows> {
        let start = Instant::now();
        let effort = &self.plan.spec.reconstruction.effort();
        let reconstructor = Reconstructor::new(cell.solver, sensed, effort, noisy.std)?;
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
        let score = truth.score(&self.outcome(&found), &noisy.errors);
        let cell = ReconstructionCell {
            atoms: sensed.dictionary().n_atoms(),
            ..cell.clone()
        };
        Ok(ReconstructionRows {
            reconstruction: vec![(cell.clone(), score)],
            timing: vec![(cell, time)],
            ..ReconstructionRows::default()
        })
    }

    fn outcome(&self, found: &[Reconstruction]) -> Outcome {
        let clean = self.touches.test.axis_chunks_iter(Axis(0), BLOCK);
        let blocks = found.iter().zip(clean);
        let capped = found.iter().flat_map(|block| &block.capped);
        Outcome {
            errors: blocks
                .flat_map(|(block, clean)| square_errors(block.frames.view(), clean))
                .collect(),
            n_atoms: found.iter().flat_map(|block| &block.n_atoms).sum(),
            n_capped: capped.filter(|&&capped| capped).count(),
        }
    }
}
