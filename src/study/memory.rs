//! How much of a study is held at once: frames, measurements, the rows and matrices of training.

use super::frames::{FramePlace, made_at_once, most_bytes};
use super::pieces::Scale;
use super::plan::Plan;
use super::recognition::{RecognitionStudy, StudyPart};
use super::sweep::Group;
use super::table::Cell;
use crate::error::{Error, Result};
use crate::recognition::svm::{DEFAULT_MEMORY_BYTES, Multiclass, Solver};
use std::path::Path;
use std::{fmt, fs};

/// Bytes of a gibibyte.
pub const GIB: f64 = (1u64 << 30) as f64;

/// Bytes of a cell in a trial: its rows in all tables.
const CELL_BYTES: f64 = 4e3;
/// Copies of training rows, bytes a number: as they are, scaled, sorted by class, and as support vectors.
const TRAINING_BYTES: f64 = 32.0;
/// Copies of test rows, bytes a number: as they are, scaled, and as the kernel reads them.
const TEST_BYTES: f64 = 20.0;
/// Bytes of a score, and of its share in what is fused.
const SCORE_BYTES: f64 = 16.0;

/// Bytes of a touch: where it is, its label, how it is read.
const TOUCH_BYTES: f64 = 400.0;
/// Bytes of a touch in the split of a trial.
const SPLIT_BYTES: f64 = 8.0;

/// How large a study is, and where the frames of an array are so that it stays below `ceiling` bytes (`None`: no ceiling): in memory if
/// they fit there beside the work of all threads, else in a file in `folder`.
pub fn recognition_scale(
    study: &RecognitionStudy,
    ceiling: Option<u64>,
    folder: &Path,
) -> (Scale, FramePlace) {
    type Placed<'a> = (&'a StudyPart, &'a Group);
    let n_taxels = |(part, group): Placed| part.plan.arrays[group.array].grid.n_taxels();
    let n_frames = |(part, group): Placed| (part.sweep.labels.len() * group.frames) as f64;
    let m = |group: &Group| group.projected().into_iter().max().unwrap_or(0) as f64;
    let measured = |on: Placed| {
        let matrix = on.1.ensemble.about().bytes;
        8.0 * n_frames(on) * m(on.1) + matrix(m(on.1), n_taxels(on) as f64)
    };
    let groups = || {
        let parts = study.parts().iter();
        parts.flat_map(|part| part.sweep.groups.iter().map(move |group| (part, group)))
    };
    let learned = |(part, group): Placed| {
        let n_test = part.sweep.splits.iter().map(|split| split.test.len());
        let rows = Rows {
            n_test: n_test.max().unwrap_or(0) as f64,
            n_classes: part.touched.class_names().len(),
        };
        let families = group.families();
        largest(families.map(|family| rows.family_bytes(&part.plan, &family[0])))
    };
    let in_memory = largest(groups().map(|g| n_frames(g) * (most_bytes(n_taxels(g)) + 16) as f64));
    // Where each frame is, and what is held before it is put there.
    let in_file = largest(groups().map(|g| {
        let n_made = (made_at_once(g.1.frames) * g.1.frames) as f64;
        8.0 * n_frames(g) + n_made * most_bytes(n_taxels(g)) as f64
    }));
    let first = study.first();
    let n_touches = first.sweep.labels.len();
    let scale = |frames: f64| Scale {
        objects: first.touched.class_names().len().to_string(),
        touches: match study.n_arrays() {
            1 => format!("{n_touches} on one array"),
            n => format!("{n_touches} on each of {n} arrays"),
        },
        n_configurations: study.n_cells(),
        bytes: frames + CELL_BYTES * (study.n_cells() * first.plan.spec.trials) as f64,
        // A thread that waits for others begins another group.
        item_bytes: 2.0 * largest(groups().map(measured)) + largest(groups().map(learned)),
    };
    let free = scale(in_memory);
    let ceiling = ceiling.map_or(f64::INFINITY, |bytes| bytes as f64);
    match free.n_at_once(ceiling) == Some(rayon::current_num_threads()) {
        true => (free, FramePlace::Memory),
        false => (scale(in_file), FramePlace::File(folder.to_owned())),
    }
}

/// Rows that a family learns from and is tested on.
struct Rows {
    n_test: f64,
    n_classes: usize,
}

impl Rows {
    fn family_bytes(&self, plan: &Plan, cell: &Cell) -> f64 {
        let m = cell.n_features() as f64;
        let n_train = (cell.train_touches * self.n_classes) as f64;
        let fuses = plan.fused_touches.iter().any(|&k| k > 1);
        let n_scores = match (cell.classifier.has_c(), plan.spec.recognition.multiclass) {
            // Some rows at a time, unless scores are fused.
            (true, _) if !fuses => 0,
            (true, Multiclass::OneVsOne) => self.n_classes * (self.n_classes - 1) / 2,
            _ => self.n_classes,
        };
        TRAINING_BYTES * n_train * m
            + TEST_BYTES * self.n_test * m
            + SCORE_BYTES * self.n_test * n_scores as f64
            + self.solver_bytes(plan, cell)
    }

    /// Kernel values, at most as many as the solver is allowed.
    fn solver_bytes(&self, plan: &Plan, cell: &Cell) -> f64 {
        let is_kernel_svm = cell.classifier.about().kernel.is_some();
        let recognition = &plan.spec.recognition;
        if !is_kernel_svm || recognition.solver == Solver::CoordinateDescent {
            return 0.0;
        }
        let n_train = (cell.train_touches * self.n_classes) as f64;
        let of_all = 8.0 * n_train * n_train;
        let of_pair = 8.0 * (2.0 * cell.train_touches as f64).powi(2);
        match (recognition.solver, recognition.multiclass) {
            (_, Multiclass::CrammerSinger) => 0.0,
            (Solver::Linfa, Multiclass::OneVsOne) => of_pair,
            (Solver::Linfa, Multiclass::OneVsRest) => of_all,
            _ => of_all.min(solver_memory(recognition.solver_memory_gib) as f64),
        }
    }
}

/// Most bytes of kernel values that a solver holds.
pub fn solver_memory(gib: Option<f64>) -> usize {
    gib.map_or(DEFAULT_MEMORY_BYTES, |gib| (gib * GIB) as usize)
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}

/// Bytes of memory that this process may use: the machine's, or its control group's if that is less; `None` where the system
/// does not tell.
pub fn machine_memory() -> Option<u64> {
    let of_machine = kilobytes("/proc/meminfo", "MemTotal")?;
    let group = fs::read_to_string("/sys/fs/cgroup/memory.max").ok();
    let of_group = group.and_then(|text| text.trim().parse::<u64>().ok());
    Some(of_group.map_or(of_machine, |bytes| bytes.min(of_machine)))
}

/// Most bytes that this process has held so far; `None` where the system does not tell.
pub fn peak_memory() -> Option<u64> {
    kilobytes("/proc/self/status", "VmHWM")
}

/// What is allowed in place of something that takes more bytes than the ceiling (`None`: there is none).
pub(super) fn check_memory(
    bytes: f64,
    ceiling: Option<u64>,
    what: &str,
) -> std::result::Result<(), String> {
    match ceiling.map(|ceiling| ceiling as f64) {
        Some(ceiling) if bytes > ceiling => Err(format!(
            "fewer: {what} would take {}, and there are {}",
            Bytes(bytes),
            Bytes(ceiling)
        )),
        _ => Ok(()),
    }
}

/// An error unless the touches of a study of so many classes, with a split a trial, are within `ceiling` bytes (`None`: no ceiling).
/// To be asked before any is drawn.
///
/// # Errors
/// They take more; the error names the key that says how many they are.
pub fn check_touches(plan: &Plan, n_classes: usize, ceiling: Option<u64>) -> Result<()> {
    let (key, n_each) = match &plan.human_touch {
        Some(human) => ("human_touch.per_kind", human.per_kind as f64),
        None => ("touches.per_object", plan.placement.n_touches()),
    };
    let n_touches = n_each * n_classes as f64;
    let bytes = n_touches * (TOUCH_BYTES + SPLIT_BYTES * plan.spec.trials as f64);
    let what = format!("{n_touches} touches and their splits");
    check_memory(bytes, ceiling, &what)
        .map_err(|allowed| Error::input(format!("key {key}"), n_each, allowed))
}

/// A line `Key:  123 kB` of a file, in bytes.
fn kilobytes(path: &str, key: &str) -> Option<u64> {
    let text = fs::read_to_string(path).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    let number = line.trim_start_matches(':').trim().strip_suffix("kB")?;
    Some(number.trim().parse::<u64>().ok()? * 1024)
}

/// A number of bytes in words: 12 MiB, 1.5 GiB.
pub struct Bytes(pub f64);

impl fmt::Display for Bytes {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let mib = self.0 / f64::from(1 << 20);
        match mib {
            _ if mib < 1.0 => write!(f, "1 MiB"),
            _ if mib < 1024.0 => write!(f, "{mib:.0} MiB"),
            _ => write!(f, "{:.1} GiB", mib / 1024.0),
        }
    }
}
