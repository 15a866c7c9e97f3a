//! A study that recognises objects: its work items, and the tables of what they found.

use super::cost::{family_s, measure_s, touch_s};
use super::rows::{ArrayOutcome, Outcome, RecognitionRows};
use crate::error::Result;
use crate::report::recognition::tables_of;
use crate::study::Samples;
use crate::study::cell_content::family_name;
use crate::study::frames::FramePlace;
use crate::study::pieces::{NamedPiece, PieceStudy, PiecesLeft, Scale, run_whole};
use crate::study::plan::{Plan, millimetres};
use crate::study::progress::Progress;
use crate::study::published::compare_with_published;
use crate::study::sweep::{Group, Sweep};
use crate::study::table::{Cell, StageTime};
use crate::study::tabulate::tabulate;
use crate::study::time_left::Piece;
use crate::study::touch_set::TouchSet;
use crate::table::Table;
use std::ops::Range;
use std::sync::OnceLock;

/// Stages, for the time left; each classifier has its own.
const TOUCH: u8 = 0;
const MEASURE: u8 = 1;
const LEARN: u8 = 2;

/// A recognition study that is laid out.
pub struct RecognitionStudy {
    /// What to run.
    pub plan: Plan,
    /// What is touched.
    pub touched: Box<dyn TouchSet + Send>,
    /// Splits and cells.
    pub sweep: Sweep,
    /// Where the frames of an array are while its cells read them.
    pub place: FramePlace,
    /// How large it is.
    pub(super) scale: Scale,
    /// A few touches for the eye, once something showed them.
    samples: OnceLock<Samples>,
    /// All families, group by group.
    families: Vec<Family>,
    /// Of each group the number of its first family, and behind the last that of all families.
    first_family: Vec<usize>,
}

/// A [family](Group::families) of cells.
struct Family {
    group: usize,
    cells: Range<usize>,
}

impl RecognitionStudy {
    /// Lays out a plan and its touches, whose frames are held in memory.
    ///
    /// # Errors
    /// Objects or touches that are too few, or are shown without being there.
    pub fn new(plan: Plan, touched: Box<dyn TouchSet + Send>) -> Result<Self> {
        let sweep = Sweep::new(&plan, touched.as_ref())?;
        let (mut families, mut first_family) = (Vec::new(), Vec::new());
        for (group, laid_out) in sweep.groups.iter().enumerate() {
            first_family.push(families.len());
            let mut first = 0;
            families.extend(laid_out.families().map(|family| {
                let cells = first..first + family.len();
                first = cells.end;
                Family { group, cells }
            }));
        }
        first_family.push(families.len());
        Ok(Self {
            plan,
            touched,
            sweep,
            place: FramePlace::Memory,
            scale: Scale::default(),
            samples: OnceLock::new(),
            families,
            first_family,
        })
    }

    /// Runs all of it at once, keeps nothing, and ends at the first work item that fails.
    ///
    /// # Errors
    /// What an item fails of.
    pub fn run(&self, progress: &dyn Progress) -> Result<Outcome> {
        self.outcome(run_whole(self, progress)?)
    }

    /// A few touches for the eye.
    pub(super) fn samples(&self) -> Result<&Samples> {
        if let Some(samples) = self.samples.get() {
            return Ok(samples);
        }
        let made = self.touched.samples(&self.plan, &self.sweep)?;
        Ok(self.samples.get_or_init(|| made))
    }

    /// The families of a group.
    pub(super) fn families_of(&self, group: usize) -> Range<usize> {
        self.first_family[group]..self.first_family[group + 1]
    }

    /// The cells of a family.
    pub(super) fn cells(&self, family: usize) -> &[Cell] {
        let Family { group, cells } = &self.families[family];
        &self.sweep.groups[*group].cells[cells.clone()]
    }

    /// The number of a family in a trial as a work item.
    pub(super) fn family_item(&self, trial: usize, family: usize) -> usize {
        trial * self.families.len() + family
    }

    /// The number of an array's touches as a work item, by the places of the array and of how many frames.
    pub(super) fn touches_item(&self, (array, frames): (usize, usize)) -> usize {
        self.family_item(self.plan.spec.trials, 0) + array * self.plan.frames.len() + frames
    }

    /// The places of every array and number of frames.
    fn arrays(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let n_frames = self.plan.frames.len();
        let arrays = 0..self.plan.arrays.len();
        arrays.flat_map(move |array| (0..n_frames).map(move |frames| (array, frames)))
    }

    /// Where touches of a group are, by the places of its array and of its number of frames.
    pub(super) fn on(&self, group: &Group) -> (usize, usize) {
        let mut known = self.plan.frames.iter();
        let frames = known.position(|&n_frames| n_frames == group.frames);
        (group.array, frames.unwrap_or_default())
    }

    pub(super) fn touch_work(&self, (array, frames): (usize, usize)) -> Piece {
        let (patch, n_touches) = (&self.plan.arrays[array], self.sweep.labels.len());
        let n_frames = self.plan.frames[frames];
        let on = (n_touches, n_frames);
        let planned_s = touch_s(patch, self.touched.as_ref(), on);
        Piece::one_by_one(TOUCH, planned_s / rayon::current_num_threads() as f64)
    }

    pub(super) fn measure_work(&self, group: &Group, n_measurements: usize) -> Piece {
        let measured = (self.sweep.labels.len(), n_measurements);
        Piece::of_stage(MEASURE, measure_s(&self.plan, group, measured))
    }

    fn learn_work(&self, family: &[Cell]) -> Piece {
        let n_objects = self.touched.class_names().len();
        let of = (n_objects, self.sweep.labels.len());
        let stage = LEARN + family[0].classifier as u8;
        Piece::of_stage(stage, family_s(&self.plan, family, of))
    }

    /// The tables, typed.
    pub fn outcome(&self, rows: RecognitionRows) -> Result<Outcome> {
        let mut outcome = Outcome {
            tables: Default::default(),
            arrays: Vec::new(),
            limits: Vec::new(),
        };
        self.add_arrays(&mut outcome, &rows);
        let scored = rows.cells.into_iter().map(|row| {
            let cell = &self.sweep.groups[row.at.0].cells[row.at.1];
            (cell.clone(), row.evaluation)
        });
        let names = self.touched.class_names();
        tabulate(&mut outcome.tables, scored.collect(), &names)?;
        let published = &self.plan.spec.report.published;
        outcome.tables.published = compare_with_published(published, &outcome.tables.summary);
        outcome.limits = self.limits(&outcome.tables, &outcome.arrays);
        Ok(outcome)
    }

    /// Of each array what was made, measured, missed and saturated.
    fn add_arrays(&self, outcome: &mut Outcome, rows: &RecognitionRows) {
        for on in self.arrays() {
            let of_array = || rows.touches.iter().filter(|row| row.on == on);
            if of_array().next().is_none() {
                continue;
            }
            let (patch, n_touches) = (&self.plan.arrays[on.0], self.sweep.labels.len());
            let seconds = |is_made: bool| -> f64 {
                let rows = of_array().filter(|row| row.is_made == is_made);
                rows.map(|row| row.cpu_s).sum()
            };
            let n_measured = of_array().map(|row| row.n_measured).sum();
            for (stage, n_touches, cpu_s) in [
                ("simulate", n_touches, seconds(true)),
                ("measure", n_measured, seconds(false)),
            ] {
                let stage = in_frames(stage, self.plan.frames[on.1]);
                let time = stage_time(stage, self, on.0, (n_touches, cpu_s));
                outcome.tables.stages.push(time);
            }
            // The deepest frame is the same however many come before it.
            if on.1 == 0 {
                outcome.arrays.push(ArrayOutcome {
                    patch: *patch,
                    n_touches,
                    n_missed: of_array().map(|row| row.n_missed).sum(),
                    n_saturated: of_array().map(|row| row.n_saturated).sum(),
                });
            }
        }
    }
}

impl PieceStudy for RecognitionStudy {
    type Rows = RecognitionRows;
    type Tables = Vec<Table>;

    /// Trial by trial all families, group by group; then the touches of each array.
    fn pieces(&self) -> Vec<NamedPiece> {
        let trials = self.plan.spec.trials;
        let families = 0..self.families.len();
        let of_family = |family| {
            let cells = self.cells(family);
            (family_name(&self.plan, cells), self.learn_work(cells))
        };
        let families: Vec<(String, Piece)> = families.map(of_family).collect();
        let mut pieces = Vec::with_capacity(trials * families.len());
        for trial in 0..trials {
            for (family, (name, work)) in self.families.iter().zip(&families) {
                let group = trial * self.sweep.groups.len() + family.group;
                let name = format!("{name}, trial {trial}");
                pieces.push(NamedPiece::new(name, group, *work));
            }
        }
        for on in self.arrays() {
            let patch = &self.plan.arrays[on.0];
            let (grid, n_frames) = (&patch.grid, self.plan.frames[on.1]);
            let (nx, ny, pitch) = (grid.nx, grid.ny, grid.pitch);
            let name = format!("touches of {n_frames} frames on {nx}x{ny} taxels at {pitch} m");
            let mut groups = self.sweep.groups.iter();
            let group = groups.position(|group| self.on(group) == on);
            // What it takes is told while all that needs the touches waits for them.
            let work = Piece::one_by_one(TOUCH, 0.0);
            pieces.push(NamedPiece::new(name, group.unwrap_or_default(), work));
        }
        pieces
    }

    fn measure(&self, left: &PiecesLeft<RecognitionRows>) -> Result<()> {
        self.measure_all(left)
    }

    fn shared_work(&self, left: &PiecesLeft<RecognitionRows>) -> Vec<Piece> {
        let mut work = Vec::new();
        for on in self.arrays() {
            let jobs = self.jobs(left, on);
            if jobs.is_empty() && !left.has_number(self.touches_item(on)) {
                continue;
            }
            work.push(self.touch_work(on));
            for job in jobs {
                let batches = job.batches().into_iter();
                work.extend(batches.map(|(m, _)| self.measure_work(job.group, m)));
            }
        }
        work
    }

    fn place(&self, number: usize, rows: &mut RecognitionRows) {
        let n_families = self.families.len();
        let n_touches = self.touches_item((0, 0));
        let on = match number.checked_sub(n_touches) {
            Some(touches) => {
                let n_frames = self.plan.frames.len();
                (touches / n_frames, touches % n_frames)
            }
            None => {
                let Family { group, cells } = &self.families[number % n_families];
                for (row, cell) in rows.cells.iter_mut().zip(cells.clone()) {
                    row.at = (*group, cell);
                }
                self.on(&self.sweep.groups[*group])
            }
        };
        for row in &mut rows.touches {
            row.on = on;
        }
    }

    /// A family by the settings of its first cell.
    fn words(&self, number: usize, piece: &NamedPiece) -> String {
        if number >= self.touches_item((0, 0)) {
            return piece.name.clone();
        }
        let (trial, family) = (number / self.families.len(), number % self.families.len());
        let settings = serde_json::to_value(&self.cells(family)[0]).unwrap_or_default();
        let settings = settings.as_object().into_iter().flatten();
        let settings = settings.filter(|(_, value)| !value.is_null());
        let mut words: Vec<String> = settings
            .map(|(key, value)| match value.as_str() {
                Some(word) => format!("{key} = {word}"),
                None => format!("{key} = {value}"),
            })
            .collect();
        words.push(format!("trial = {trial}"));
        words.join(", ")
    }

    fn tables(&self, rows: RecognitionRows) -> Result<Vec<Table>> {
        let outcome = self.outcome(rows)?;
        tables_of(&outcome.tables, &outcome.limits)
    }
}

/// A stage's name, with the number of frames a touch where it is not one.
pub(super) fn in_frames(stage: &str, n_frames: usize) -> String {
    match n_frames {
        1 => stage.to_owned(),
        n => format!("{stage}, {n} frames a touch"),
    }
}

fn stage_time(
    stage: String,
    study: &RecognitionStudy,
    array: usize,
    (n_touches, cpu_s): (usize, f64),
) -> StageTime {
    let grid = &study.plan.arrays[array].grid;
    StageTime {
        stage,
        pitch_mm: millimetres(grid.pitch),
        nx: grid.nx,
        ny: grid.ny,
        n_touches,
        cpu_s,
        us_per_touch: 1e6 * cpu_s / n_touches.max(1) as f64,
    }
}
