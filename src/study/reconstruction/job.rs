//! One cell of a reconstruction study: frames come back, and are compared with what they were.

use super::plan::ReconstructionPlan;
use super::score::{Outcome, square_errors};
use super::table::{ReconstructionCell, ReconstructionScore, ReconstructionTime};
use super::touches::{Noisy, Touches};
use crate::error::Result;
use crate::sensing::{Reconstruction, Reconstructor, SensedDictionary};
use ndarray::{ArrayView2, Axis};
use rayon::prelude::*;
use std::time::Instant;

/// Frames reconstructed together by one thread: enough for matrix products, few enough to share out.
const BLOCK: usize = 64;

/// One cell.
pub(super) struct Job<'a> {
    pub cell: ReconstructionCell,
    pub sensed: &'a SensedDictionary<'a>,
    pub noisy: &'a Noisy,
    pub touches: &'a Touches,
}

impl Job<'_> {
    /// The errors, and the time.
    pub fn run(
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
