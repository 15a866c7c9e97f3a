//! How much of a recognition study is held at once: frames, measurements, the rows and matrices of training.

use super::study::RecognitionStudy;
use crate::recognition::ClassifierKind;
use crate::recognition::svm::{Multiclass, Solver};
use crate::sensing::Ensemble;
use crate::study::frames::{FramePlace, made_at_once, most_bytes};
use crate::study::memory::solver_memory;
use crate::study::pieces::Scale;
use crate::study::plan::Plan;
use crate::study::sweep::Group;
use crate::study::table::Cell;
use std::path::Path;

/// Bytes of a cell in a trial: its rows in all tables.
const CELL_BYTES: f64 = 4e3;
/// Copies of training rows, bytes a number: as they are, scaled, sorted by class, and as support vectors.
const TRAINING_BYTES: f64 = 32.0;
/// Copies of test rows, bytes a number: as they are, scaled, and as the kernel reads them.
const TEST_BYTES: f64 = 20.0;
/// Bytes of a score, and of its share in what is fused.
const SCORE_BYTES: f64 = 16.0;

/// How large a study is, and where the frames of an array are so that it stays below `ceiling` bytes (`None`: no ceiling): in memory if
/// they fit there beside the work of all threads, else in a file in `folder`.
pub fn recognition_scale(
    study: &RecognitionStudy,
    ceiling: Option<u64>,
    folder: &Path,
) -> (Scale, FramePlace) {
    let RecognitionStudy {
        plan,
        touched,
        sweep,
        ..
    } = study;
    let n_touches = sweep.labels.len();
    let n_taxels = |group: &Group| plan.arrays[group.array].grid.n_taxels();
    let n_frames = |group: &Group| (n_touches * group.frames) as f64;
    let m = |group: &Group| group.projected().into_iter().max().unwrap_or(0) as f64;
    let measured = |group: &Group| {
        8.0 * n_frames(group) * m(group) + matrix_bytes(group.ensemble, m(group), n_taxels(group))
    };
    let n_test = sweep.splits.iter().map(|split| split.test.len());
    let rows = Rows {
        n_test: n_test.max().unwrap_or(0) as f64,
        n_classes: touched.class_names().len(),
    };
    let groups = || sweep.groups.iter();
    let families = || groups().flat_map(Group::families);
    let in_memory = largest(groups().map(|g| n_frames(g) * (most_bytes(n_taxels(g)) + 16) as f64));
    // Where each frame is, and what is held before it is put there.
    let in_file = largest(groups().map(|g| {
        let n_made = (made_at_once(g.frames) * g.frames) as f64;
        8.0 * n_frames(g) + n_made * most_bytes(n_taxels(g)) as f64
    }));
    let scale = |frames: f64| Scale {
        objects: touched.class_names().len().to_string(),
        touches: match plan.arrays.len() {
            1 => format!("{n_touches} on one array"),
            n => format!("{n_touches} on each of {n} arrays"),
        },
        n_configurations: sweep.n_cells(),
        bytes: frames + CELL_BYTES * (sweep.n_cells() * plan.spec.trials) as f64,
        // A thread that waits for others begins another group.
        item_bytes: 2.0 * largest(groups().map(measured))
            + largest(families().map(|family| rows.family_bytes(plan, &family[0]))),
    };
    let free = scale(in_memory);
    let ceiling = ceiling.map_or(f64::INFINITY, |bytes| bytes as f64);
    match free.n_at_once(ceiling) == Some(rayon::current_num_threads()) {
        true => (free, FramePlace::Memory),
        false => (scale(in_file), FramePlace::File(folder.to_owned())),
    }
}

/// Bytes of an ensemble's matrix of m rows.
fn matrix_bytes(ensemble: Ensemble, m: f64, n_taxels: usize) -> f64 {
    let n = n_taxels as f64;
    match ensemble {
        Ensemble::Gaussian | Ensemble::Bernoulli => 16.0 * n * m,
        // m rows of √n entries each.
        Ensemble::Sparse => 16.0 * n.sqrt() * m,
        Ensemble::Sbhe | Ensemble::BlockAverage | Ensemble::Subsample | Ensemble::Identity => {
            16.0 * n
        }
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
        let is_kernel_svm = matches!(
            cell.classifier,
            ClassifierKind::LinearSvm | ClassifierKind::RbfSvm | ClassifierKind::PolynomialSvm
        );
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

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}
