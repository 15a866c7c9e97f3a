//! Runs a reconstruction study: touches once, dictionaries once, then every ensemble, m, noise, dictionary and solver.

use super::charts::{answers, charts};
use super::measured::OnMeasured;
use super::plan::ReconstructionPlan;
use super::rows::{
    EnsembleStatistics, ReconstructionBest, ReconstructionCell, ReconstructionPareto,
    ReconstructionRows, ReconstructionScore, ReconstructionTime,
};
use super::score::{best, pareto};
use super::spec::ReconstructionStudySpec;
use super::touches::Touches;
use crate::error::Result;
use crate::kinds::{About, Facts, Kind, Source};
use crate::random::Seed;
use crate::report::study_folder::NamedPicture;
use crate::sensing::Basis;
use crate::study::pieces::{NamedPiece, PieceRows, PieceStudy, PiecesLeft, Scale};
use crate::study::progress::Progress;
use crate::study::time_left::Piece;
use crate::study::{TouchedObject, draw_touches, load_objects, objects_content};
use crate::table::{ChartSpec, Table};
use std::collections::BTreeMap;
use std::path::Path;
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

const CELLS: (&str, &str) = ("reconstruction.csv", "Every cell");
const ENSEMBLES: (&str, &str) = ("ensembles.csv", "Isometry of ensembles and dictionaries");
const TIMING: (&str, &str) = ("timing.csv", "Time of every cell");
const PARETO: (&str, &str) = ("pareto.csv", "Error and time of every cell");
const BEST: (&str, &str) = ("best.csv", "Best cells");

/// Stages of a run.
const TOUCHES: u8 = 0;
const STATISTICS: u8 = 1;
const CELL: u8 = 2;

/// Seconds by the clock, about: of a touch's taxel, of a dictionary, of its isometry, and of a cell.
const TOUCH_S: f64 = 1e-7;
const LEARN_S: f64 = 1.0;
const ISOMETRY_S: f64 = 0.1;
const CELL_S: f64 = 0.3;

impl Kind for ReconstructionStudy {
    const ABOUT: About = About {
        table: "reconstruction",
        words: "a study that reconstructs frames",
        may_change: &[
            "question",
            "expected",
            "signal.noise_std_full_scale",
            "signal.noise_std_mm",
            "signal.noise_std_n",
            "sensing.ensemble",
            "sensing.ratio",
            "sensing.measurements",
            "reconstruction.solver",
            "reconstruction.dictionary",
        ],
    };

    fn load(source: &Source) -> Result<Self> {
        let mut spec = ReconstructionStudySpec::parse(&source.place, &source.text)?;
        spec.seed = source.seed(spec.seed);
        source.replace_objects(&mut spec.objects);
        let plan = ReconstructionPlan::new(&source.place, spec)?;
        let objects = load_objects(&plan.spec.objects, source.packings())?;
        let touched = draw_touches(objects, &plan.placement, &Seed::new(plan.spec.seed))?;
        Ok(Self {
            plan,
            touched,
            frames: OnceLock::new(),
        })
    }

    fn facts(&self) -> Result<Facts> {
        let spec = &self.plan.spec;
        Ok(Facts {
            toml: spec.to_toml(),
            question: spec.question.clone(),
            expected: spec.expected.clone(),
            seed: spec.seed,
            content: objects_content(&spec.objects)?,
            ..Facts::default()
        })
    }

    fn scale(&self) -> Scale {
        let n_touches = self.n_touches();
        let n_taxels = self.plan.patch.grid.n_taxels() as f64;
        // Frames clean, read and reconstructed; one dictionary.
        let frames = 3.0 * n_touches as f64 * n_taxels;
        Scale {
            objects: self.touched.len().to_string(),
            touches: format!("{n_touches} on one array"),
            n_configurations: self.plan.cells().len(),
            bytes: 8.0 * (frames + n_taxels * n_taxels),
            ..Scale::default()
        }
    }

    fn read_tables(&self, folder: &Path) -> Result<Vec<Table>> {
        Ok(described([
            Table::read::<(ReconstructionCell, ReconstructionScore)>(CELLS.0, CELLS.1, folder)?,
            Table::read::<EnsembleStatistics>(ENSEMBLES.0, ENSEMBLES.1, folder)?,
            Table::read::<(ReconstructionCell, ReconstructionTime)>(TIMING.0, TIMING.1, folder)?,
            Table::read::<(ReconstructionCell, ReconstructionPareto)>(PARETO.0, PARETO.1, folder)?,
            Table::read::<(ReconstructionCell, ReconstructionBest)>(BEST.0, BEST.1, folder)?,
        ]))
    }

    fn charts(&self, tables: &[Table]) -> Vec<ChartSpec> {
        charts(tables)
    }

    fn pictures(&self, tables: &[Table]) -> Result<Vec<NamedPicture>> {
        self.sample_frames(tables)
    }

    fn answers(&self, tables: &[Table]) -> Vec<String> {
        answers(tables)
    }
}

/// What tables are beside their rows.
fn described([cells, ensembles, timing, pareto, best]: [Table; 5]) -> Vec<Table> {
    vec![
        cells.noted("Errors are relative to the clean frames: 0 is perfect, 1 is as wrong as an empty frame."),
        ensembles.noted("Squared singular values of supports drawn at random, whose columns have a mean square norm of 1."),
        timing.of_times(),
        pareto.of_times().summary().noted("One core, frames in blocks of 64."),
        best.of_times().summary().noted(
            "The best dictionary and ensemble of each solver; full sampling error is that of the noisy frame itself.",
        ),
    ]
}

impl PieceStudy for ReconstructionStudy {
    type Rows = ReconstructionRows;
    type Tables = Vec<Table>;

    /// Of each ensemble and m what every dictionary keeps apart, then its cells.
    fn pieces(&self) -> Vec<NamedPiece> {
        let mut pieces = Vec::new();
        let cells = self.plan.cells();
        for (group, cells) in on_measured(&cells).enumerate() {
            pieces.extend(self.plan.dictionaries.iter().map(|&basis| {
                let work = Piece::one_by_one(STATISTICS, ISOMETRY_S);
                NamedPiece::new(cells[0].isometry_name(basis), group, work)
            }));
            let work = Piece::one_by_one(CELL, CELL_S);
            pieces.extend(
                cells
                    .iter()
                    .map(|cell| NamedPiece::new(cell.name(), group, work)),
            );
        }
        pieces
    }

    fn measure(&self, left: &PiecesLeft<ReconstructionRows>) -> Result<()> {
        let all: Vec<String> = self.pieces().into_iter().map(|piece| piece.name).collect();
        let names = left.of(all, String::clone);
        let Some(touches) = left.prepare(&names, || {
            left.during(&self.touch_work(), || self.frames(left.progress))
        })?
        else {
            return Ok(());
        };
        let bases = self.bases_of(left);
        left.progress.stage("dictionaries", bases.len() as u64);
        let Some(dictionaries) = left.prepare(&names, || {
            left.during(&learn_work(bases.len()), || {
                touches.learn(&self.plan, &bases, left.progress)
            })
        })?
        else {
            return Ok(());
        };
        left.progress.stage("reconstruct", names.len() as u64);
        on_measured(&self.plan.cells()).try_for_each(|cells| {
            let plan = &self.plan;
            let on = OnMeasured {
                plan,
                cells,
                touches,
            };
            on.measure(&dictionaries, left)
        })
    }

    fn shared_work(&self, left: &PiecesLeft<ReconstructionRows>) -> Vec<Piece> {
        vec![self.touch_work(), learn_work(self.bases_of(left).len())]
    }

    fn tables(&self, mut rows: ReconstructionRows) -> Result<Vec<Table>> {
        // Cells that were finished when axes had other values have other numbers.
        let numbers = self.plan.cells().into_iter();
        let numbers: BTreeMap<String, usize> =
            numbers.map(|cell| (cell.name(), cell.cell)).collect();
        let cells = rows.reconstruction.iter_mut().map(|row| &mut row.0);
        for cell in cells.chain(rows.timing.iter_mut().map(|row| &mut row.0)) {
            cell.cell = numbers[&cell.name()];
        }
        Ok(described([
            Table::of(CELLS.0, CELLS.1, &rows.reconstruction)?,
            Table::of(ENSEMBLES.0, ENSEMBLES.1, &rows.ensembles)?,
            Table::of(TIMING.0, TIMING.1, &rows.timing)?,
            Table::of(PARETO.0, PARETO.1, &pareto(&rows))?,
            Table::of(BEST.0, BEST.1, &best(&rows))?,
        ]))
    }
}

/// Cells in groups that reconstruct from the same measurements.
fn on_measured(cells: &[ReconstructionCell]) -> impl Iterator<Item = &[ReconstructionCell]> {
    cells.chunk_by(|a, b| (a.ensemble, a.measurements) == (b.ensemble, b.measurements))
}

fn learn_work(n_bases: usize) -> Piece {
    Piece::one_by_one(TOUCHES, LEARN_S * n_bases as f64)
}

impl ReconstructionStudy {
    fn n_touches(&self) -> usize {
        self.touched.iter().map(|object| object.touches.len()).sum()
    }

    fn touch_work(&self) -> Piece {
        let n_taxels = self.plan.patch.grid.n_taxels();
        Piece::one_by_one(TOUCHES, TOUCH_S * (self.n_touches() * n_taxels) as f64)
    }

    /// The frames of all touches.
    pub(super) fn frames(&self, progress: &dyn Progress) -> Result<&Touches> {
        if let Some(frames) = self.frames.get() {
            return Ok(frames);
        }
        let made = Touches::simulate(&self.plan, &self.touched, progress)?;
        Ok(self.frames.get_or_init(|| made))
    }

    /// Dictionaries of which something that is left is made.
    fn bases_of(&self, left: &PiecesLeft<ReconstructionRows>) -> Vec<Basis> {
        let cells = self.plan.cells();
        let is_left = |cell: &ReconstructionCell| {
            left.has(&cell.name()) || left.has(&cell.isometry_name(cell.dictionary))
        };
        let is_needed = |basis: &Basis| {
            let mut of_basis = cells.iter().filter(|cell| cell.dictionary == *basis);
            of_basis.any(is_left)
        };
        self.plan
            .dictionaries
            .iter()
            .copied()
            .filter(is_needed)
            .collect()
    }
}

impl PieceRows for ReconstructionRows {
    fn append(&mut self, next: Self) {
        self.reconstruction.extend(next.reconstruction);
        self.timing.extend(next.timing);
        self.ensembles.extend(next.ensembles);
    }
}
