//! All that is reconstructed from the same measurements.

use super::isometry::statistics;
use super::plan::ReconstructionPlan;
use super::rows::{ReconstructionCell, ReconstructionRows, ReconstructionTime};
use super::score::{Outcome, square_errors};
use super::touches::{Noisy, Touches};
use crate::error::Result;
use crate::sensing::{Basis, Dictionary, Reconstruction, Reconstructor, SensedDictionary};
use crate::study::pieces::PiecesLeft;
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
    /// Does what is left of it.
    pub fn measure(
        &self,
        dictionaries: &[Dictionary],
        left: &PiecesLeft<ReconstructionRows>,
    ) -> Result<()> {
        let needed = dictionaries.iter();
        let needed: Vec<(&Dictionary, Vec<String>)> = needed
            .map(|dictionary| (dictionary, self.names(dictionary.basis(), left)))
            .filter(|(_, names)| !names.is_empty())
            .collect();
        let names: Vec<String> = needed.iter().flat_map(|(_, names)| names.clone()).collect();
        let ReconstructionCell {
            ensemble,
            measurements,
            ..
        } = self.cells[0];
        if names.is_empty() {
            return Ok(());
        }
        let make = || self.plan.projection(ensemble, measurements);
        let Some(projection) = left.prepare(&names, make)? else {
            return Ok(());
        };
        let sensed = needed
            .into_par_iter()
            .map(|(dictionary, names)| {
                let sense = || SensedDictionary::new(&projection, dictionary);
                let sensed = left.prepare(&names, sense)?;
                if let Some(sensed) = &sensed {
                    self.isometry(sensed, left)?;
                }
                Ok(sensed)
            })
            .collect::<Result<Vec<_>>>()?;
        let sensed: Vec<SensedDictionary> = sensed.into_iter().flatten().collect();
        for noisy in &self.touches.noisy {
            let of_level = self
                .cells
                .iter()
                .filter(|cell| cell.noise_std == noisy.level);
            let cells = left.of(of_level, |cell| cell.name());
            if cells.is_empty() {
                continue;
            }
            let measurements = projection.measure(noisy.frames.view());
            for cell in cells {
                let mut sensed = sensed.iter();
                let of_cell = sensed.find(|s| s.dictionary().basis() == cell.dictionary);
                let Some(sensed) = of_cell else {
                    continue;
                };
                left.finish(&cell.name(), || {
                    self.reconstruct(cell, sensed, noisy, &measurements)
                })?;
            }
        }
        Ok(())
    }

    /// What is left that is made of a dictionary.
    fn names(&self, basis: Basis, left: &PiecesLeft<ReconstructionRows>) -> Vec<String> {
        let cells = self.cells.iter().filter(|cell| cell.dictionary == basis);
        let names = cells.map(ReconstructionCell::name);
        let names = names.chain([self.cells[0].isometry_name(basis)]);
        left.of(names, String::clone)
    }

    fn isometry(
        &self,
        sensed: &SensedDictionary,
        left: &PiecesLeft<ReconstructionRows>,
    ) -> Result<()> {
        let name = self.cells[0].isometry_name(sensed.dictionary().basis());
        left.finish(&name, || {
            Ok(ReconstructionRows {
                ensembles: statistics(self.plan, sensed)?,
                ..ReconstructionRows::default()
            })
        })
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
        let effort = &self.plan.effort;
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
