//! All that is reconstructed from the same measurements.

use super::isometry::statistics;
use super::job::Job;
use super::plan::ReconstructionPlan;
use super::table::{ReconstructionCell, ReconstructionTables};
use super::touches::Touches;
use crate::error::Result;
use crate::sensing::{Basis, Dictionary, Ensemble, SensedDictionary, Solver};
use crate::study::pieces::PiecesLeft;
use rayon::prelude::*;

/// An ensemble with its m: what reconstructs from the same measurements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Measured {
    pub ensemble: Ensemble,
    pub m: usize,
}

/// A cell that is to be: its number, its noise level by number, dictionary and solver.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    pub number: usize,
    pub noise: usize,
    pub dictionary: Basis,
    pub solver: Solver,
}

/// What the isometry of a dictionary is called as a piece.
pub(super) fn statistics_name(Measured { ensemble, m }: Measured, basis: Basis) -> String {
    format!("isometry of {ensemble:?}, m = {m}, {basis:?}")
}

/// What a cell is called as a piece: by its settings, since its number is another where an axis has more values.
pub(super) fn cell_name(
    plan: &ReconstructionPlan,
    Measured { ensemble, m }: Measured,
    cell: &Wanted,
) -> String {
    let Wanted {
        noise,
        dictionary,
        solver,
        ..
    } = cell;
    let (level, unit) = (plan.noise[*noise], plan.noise_unit);
    format!("{solver:?} in {dictionary:?} of {ensemble:?}, m = {m}, noise {level} {unit:?}")
}

/// All that is made of an ensemble and m.
pub(super) struct OnMeasured<'a> {
    pub plan: &'a ReconstructionPlan,
    pub measured: Measured,
    pub cells: Vec<Wanted>,
    pub touches: &'a Touches,
}

impl OnMeasured<'_> {
    /// Does what is left of it.
    pub fn measure(
        &self,
        dictionaries: &[Dictionary],
        left: &PiecesLeft<ReconstructionTables>,
    ) -> Result<()> {
        let plan = self.plan;
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
            let cells = left.of(cells, |cell| cell_name(self.plan, self.measured, cell));
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
                left.finish(&cell_name(self.plan, self.measured, wanted), || {
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
        let cells = cells.map(|cell| cell_name(self.plan, self.measured, cell));
        let names = cells.chain([statistics_name(self.measured, basis)]);
        left.of(names, String::clone)
    }
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
