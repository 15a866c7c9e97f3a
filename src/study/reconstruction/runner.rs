//! Runs a reconstruction study: touches once, dictionaries once, then every ensemble, m, noise, dictionary and solver.

use super::measured::{Measured, OnMeasured, Wanted, cell_name, statistics_name};
use super::plan::ReconstructionPlan;
use super::score::pareto;
use super::table::{ReconstructionCell, ReconstructionTables};
use super::touches::{SampleFrames, Touches};
use crate::error::Result;
use crate::sensing::{Basis, Ensemble, Reconstructor, SensedDictionary, Solver};
use crate::study::pieces::{NamedPiece, PieceRows, PieceStudy, PiecesLeft};
use crate::study::progress::{Progress, Silent};
use crate::study::simulation::TouchedObject;
use crate::study::time_left::Piece;
use std::collections::BTreeMap;
use std::sync::OnceLock;

/// A reconstruction study and its touches.
pub struct ReconstructionStudy {
    /// What to run.
    pub plan: ReconstructionPlan,
    /// What is touched.
    pub touched: Vec<TouchedObject>,
    /// Their frames, once something needed them.
    frames: OnceLock<Touches>,
}

/// Stages, for the time left.
const TOUCHES: u8 = 0;
const STATISTICS: u8 = 1;
const CELLS: u8 = 2;

/// Seconds by the clock to make and read a touch's taxel, and to learn a dictionary, about.
const TOUCH_S: f64 = 1e-7;
const LEARN_S: f64 = 1.0;
/// Seconds of a dictionary's isometry, and seconds by the clock of a cell with sparse codes, both whatever the measurements, and of one
/// with a linear estimate for each measurement: from 256 to 4,096 measurements, on 342 frames.
const ISOMETRY_S: f64 = 0.1;
const SPARSE_S: f64 = 0.25;
const LINEAR_S: f64 = 2.6e-4;

impl PieceStudy for ReconstructionStudy {
    type Rows = ReconstructionTables;
    type Tables = ReconstructionTables;

    /// Of each ensemble and m what every dictionary keeps apart, then its cells.
    fn pieces(&self) -> Vec<NamedPiece> {
        let mut pieces = Vec::new();
        for (group, measured) in self.measured().into_iter().enumerate() {
            pieces.extend(self.plan.dictionaries.iter().map(|&basis| {
                let work = Piece::of_stage(STATISTICS, ISOMETRY_S);
                NamedPiece::new(statistics_name(measured, basis), group, work)
            }));
            pieces.extend(self.cells(group).iter().map(|cell| {
                let name = cell_name(&self.plan, measured, cell);
                NamedPiece::new(name, group, self.cell_work(measured, cell))
            }));
        }
        pieces
    }

    fn measure(&self, left: &PiecesLeft<ReconstructionTables>) -> Result<()> {
        let all: Vec<String> = self.pieces().into_iter().map(|piece| piece.name).collect();
        let names = left.of(all, String::clone);
        let Some(touches) = left.prepare(&names, || {
            left.during(&self.touch_work(), || self.frames(left.progress))
        })?
        else {
            return Ok(());
        };
        let bases = self.plan.dictionaries.iter().copied();
        let bases: Vec<Basis> = bases.filter(|&basis| self.needs(left, basis)).collect();
        left.progress.stage("dictionaries", bases.len() as u64);
        let learn = || {
            left.during(&self.learn_work(bases.len()), || {
                touches.learn(&self.plan, &bases, left.progress)
            })
        };
        let Some(dictionaries) = left.prepare(&names, learn)? else {
            return Ok(());
        };
        left.progress.stage("reconstruct", names.len() as u64);
        for (group, measured) in self.measured().into_iter().enumerate() {
            let on = OnMeasured {
                plan: &self.plan,
                measured,
                cells: self.cells(group),
                touches,
            };
            on.measure(&dictionaries, left)?;
        }
        Ok(())
    }

    fn shared_work(&self, left: &PiecesLeft<ReconstructionTables>) -> Vec<Piece> {
        let bases = self.plan.dictionaries.iter();
        let n_bases = bases.filter(|&&basis| self.needs(left, basis)).count();
        vec![self.touch_work(), self.learn_work(n_bases)]
    }

    fn tables(&self, mut tables: ReconstructionTables) -> Result<ReconstructionTables> {
        self.number_cells(&mut tables);
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

impl ReconstructionStudy {
    /// Of a plan and its touches.
    pub fn new(plan: ReconstructionPlan, touched: Vec<TouchedObject>) -> Self {
        Self {
            plan,
            touched,
            frames: OnceLock::new(),
        }
    }

    /// Cells: ensemble, m, noise, dictionary and solver.
    pub fn n_cells(&self) -> usize {
        let groups = 0..self.measured().len();
        groups.map(|group| self.cells(group).len()).sum()
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
        let bases = self.plan.dictionaries.iter().copied();
        let is_shown = |basis: &Basis| cells.iter().any(|cell| cell.dictionary == *basis);
        let bases: Vec<Basis> = bases.filter(is_shown).collect();
        let dictionaries = touches.learn(&self.plan, &bases, &Silent)?;
        let mut reconstructed = BTreeMap::new();
        for cell in cells {
            let mut of_cell = dictionaries.iter();
            let Some(dictionary) = of_cell.find(|found| found.basis() == cell.dictionary) else {
                continue;
            };
            let projection = self.plan.projection(cell.ensemble, cell.measurements)?;
            let sensed = SensedDictionary::new(&projection, dictionary)?;
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

    fn touch_work(&self) -> Piece {
        let n_touches: usize = self.touched.iter().map(|object| object.touches.len()).sum();
        let n_taxels = self.plan.patch.grid.n_taxels();
        Piece::one_by_one(TOUCHES, TOUCH_S * (n_touches * n_taxels) as f64)
    }

    fn learn_work(&self, n_bases: usize) -> Piece {
        Piece::one_by_one(TOUCHES, LEARN_S * n_bases as f64)
    }

    fn cell_work(&self, measured: Measured, cell: &Wanted) -> Piece {
        let planned_s = match cell.solver {
            Solver::Omp | Solver::L1 => SPARSE_S,
            Solver::Lmmse => LINEAR_S * measured.m as f64,
        };
        Piece::one_by_one(CELLS, planned_s)
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

    /// Gives rows the numbers of their cells: those that were finished when axes had other values have others.
    fn number_cells(&self, tables: &mut ReconstructionTables) {
        let mut numbers = BTreeMap::new();
        for (group, measured) in self.measured().into_iter().enumerate() {
            for cell in self.cells(group) {
                numbers.insert(cell_name(&self.plan, measured, &cell), cell.number);
            }
        }
        let number = |row: &mut ReconstructionCell| {
            let measured = Measured {
                ensemble: row.ensemble,
                m: row.measurements,
            };
            let levels = self.plan.noise.iter();
            let cell = Wanted {
                number: row.cell,
                noise: levels.take_while(|&&level| level != row.noise_std).count(),
                dictionary: row.dictionary,
                solver: row.solver,
            };
            row.cell = numbers[&cell_name(&self.plan, measured, &cell)];
        };
        tables
            .reconstruction
            .iter_mut()
            .for_each(|(row, _)| number(row));
        tables.timing.iter_mut().for_each(|(row, _)| number(row));
    }

    /// Whether something that is left is made of a dictionary.
    fn needs(&self, left: &PiecesLeft<ReconstructionTables>, basis: Basis) -> bool {
        let mut groups = self.measured().into_iter().enumerate();
        groups.any(|(group, measured)| {
            let cells = self.cells(group);
            let of_basis = cells.iter().filter(|cell| cell.dictionary == basis);
            let mut names = of_basis.map(|cell| cell_name(&self.plan, measured, cell));
            left.has(&statistics_name(measured, basis)) || names.any(|name| left.has(&name))
        })
    }
}
