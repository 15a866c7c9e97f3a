//! What a study will take: cells, touches, memory and time, told before it runs.

use super::memory::{Bytes, MemoryPlan};
use super::plan::Plan;
use super::sweep::{Group, Sweep};
use super::table::Cell;
use super::touch_set::TouchSet;
use crate::recognition::ClassifierKind;
use crate::recognition::svm::{Multiclass, Solver};
use crate::world::Patch;
use std::fmt;

/// Counts, and an estimate of memory and time.
///
/// Times come from rates measured on one core of a 2-core x86-64 server (see the constants); another machine, or touches
/// that are hard to tell apart, can be a few times faster or slower.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Objects to tell apart.
    pub n_objects: usize,
    /// Touches, all objects.
    pub n_touches: usize,
    /// Arrays, each of which makes all touches.
    pub n_arrays: usize,
    /// Cells of the sweep.
    pub n_cells: usize,
    /// Repetitions of each cell.
    pub n_trials: usize,
    /// Fits of one trial, those of a choice of C and γ not counted; cells that differ in how many touches are fused share
    /// one.
    pub n_fits: usize,
    /// Most bytes held at once.
    pub memory_bytes: f64,
    /// Seconds to make all touches, one core.
    pub simulate_s: f64,
    /// Seconds to read and project all frames, one core.
    pub measure_s: f64,
    /// Seconds to fit and predict all cells, one core.
    pub recognise_s: f64,
    /// Threads that will share the work.
    pub n_threads: usize,
}

/// Seconds to bring one sphere to the patch and decide whether it reaches the skin.
pub(super) const PLACE_SPHERE_S: f64 = 6e-9;
/// The same for one triangle of a mesh: most are never looked at.
pub(super) const PLACE_TRIANGLE_S: f64 = 1.5e-8;
/// What each frame after the first of a touch takes to be made, as a share of the first (measured).
const LATER_FRAME: f64 = 0.25;
/// Seconds to clear, count and store one taxel.
const CLEAR_TAXEL_S: f64 = 2e-9;
/// Seconds to read one taxel where neither noise nor smoothing touches it.
const READ_TAXEL_S: f64 = 4.5e-9;
/// Share of the taxels that a touch reaches, about: where there is no noise, no others are projected.
const TOUCHED_SHARE: f64 = 0.1;
/// Seconds to draw noise for one taxel and to smooth it.
const SIGNAL_TAXEL_S: f64 = 2.5e-8;
/// Seconds for one multiply-add of a projection.
const PROJECT_S: f64 = 7e-11;
/// Seconds of linfa's solver for one entry of a binary problem's kernel matrix: iterations apart from products.
const SOLVE_ENTRY_S: f64 = 7e-8;
/// Seconds for one dot product's element in that solver's kernel matrix, at most as many as the problem has rows.
const KERNEL_ELEMENT_S: f64 = 1e-9;
/// Seconds for one multiply-add of the matrix product that brings wider features down to that many.
const REDUCE_ELEMENT_S: f64 = 5e-11;
/// Seconds of our solvers for one entry of a binary problem's kernel matrix.
const OWN_ENTRY_S: f64 = 1.3e-9;
/// The same of a linear SVM, and for each of its measurements up to so many: no hyperplane may part the classes.
const OWN_LINEAR_ENTRY_S: f64 = 2e-9;
const OWN_LINEAR_ELEMENT_S: f64 = 8e-12;
const OWN_LINEAR_ELEMENTS: f64 = 256.0;
/// Seconds for one multiply-add of the kernel matrix that all their problems share.
const GRAM_ELEMENT_S: f64 = 1.6e-11;
/// Seconds of a logistic regression for one measurement of a training row and one object.
const LOGISTIC_S: f64 = 1.5e-7;
/// Seconds to scale and to store one measurement of a training row, for nearest neighbours.
const K_NEAREST_S: f64 = 1.2e-8;
/// Seconds of naive Bayes for one measurement of a training row.
const NAIVE_BAYES_S: f64 = 2e-8;
/// Seconds of a decision tree for one measurement of a training row.
const TREE_S: f64 = 3.3e-7;
/// Seconds of a random forest for one training row and one of the √m measurements that a split looks at.
const FOREST_S: f64 = 3.4e-5;
/// Seconds for one multiply-add of a prediction by matrix product.
const PREDICT_S: f64 = 2.5e-11;

impl Estimate {
    /// Estimates a study that is laid out.
    pub fn new(plan: &Plan, touched: &dyn TouchSet, sweep: &Sweep, memory: &MemoryPlan) -> Self {
        let n_touches = sweep.labels.len();
        let n_threads = rayon::current_num_threads();
        let n_trials = plan.spec.trials;
        let frames = || plan.frames.iter();
        let arrays = plan.arrays.iter();
        let simulate_s =
            arrays.flat_map(|patch| frames().map(|&n| touch_s(patch, touched, n_touches, n)));
        let read_s = |g: &Group| -> f64 {
            let projected = g.projected().into_iter();
            projected.map(|m| measure_s(plan, g, n_touches, m)).sum()
        };
        // Of the cells that share a fit, the first.
        let fits = || {
            let families = sweep.groups.iter().flat_map(Group::families);
            families.flat_map(|family| family.chunk_by(|a, b| a.c == b.c).map(|cells| &cells[0]))
        };
        let n_objects = touched.class_names().len();
        Self {
            n_objects,
            n_touches,
            n_arrays: plan.arrays.len(),
            n_cells: sweep.n_cells(),
            n_trials,
            n_fits: fits().count(),
            memory_bytes: memory.most_bytes,
            simulate_s: simulate_s.sum(),
            measure_s: n_trials as f64 * sweep.groups.iter().map(read_s).sum::<f64>(),
            recognise_s: n_trials as f64
                * fits()
                    .map(|cell| learning(plan, cell, n_objects, n_touches).total_s())
                    .sum::<f64>(),
            n_threads,
        }
    }

    /// Seconds until the study is done, with all its threads.
    pub fn wall_s(&self) -> f64 {
        (self.simulate_s + self.measure_s + self.recognise_s) / self.n_threads as f64
    }
}

/// Processor-seconds to make all touches on an array, so many frames each.
pub(super) fn touch_s(
    patch: &Patch,
    touched: &dyn TouchSet,
    n_touches: usize,
    n_frames: usize,
) -> f64 {
    let clear_s = CLEAR_TAXEL_S * (n_touches * patch.grid.n_taxels()) as f64;
    let n_placed = 1.0 + LATER_FRAME * (n_frames as f64 - 1.0);
    n_placed * touched.place_s() + n_frames as f64 * clear_s
}

/// Processor-seconds to read and project all frames of a group once.
pub(super) fn measure_s(
    plan: &Plan,
    group: &Group,
    n_touches: usize,
    n_measurements: usize,
) -> f64 {
    let n_taxels = plan.arrays[group.array].grid.n_taxels();
    let n_read = (n_touches * group.frames * n_taxels) as f64;
    let is_quiet = group.condition.noise == 0.0 && group.condition.smoothing == 0.0;
    let (signal_s, share) = match is_quiet {
        true => (READ_TAXEL_S, TOUCHED_SHARE),
        false => (SIGNAL_TAXEL_S, 1.0),
    };
    n_read * (signal_s + share * PROJECT_S * n_measurements as f64)
}

/// Processor-seconds of what is done for one C of a family in one trial.
#[derive(Clone, Copy, Debug)]
pub(super) struct Learning {
    /// To choose C and γ by cross-validation.
    pub choose_s: f64,
    /// To train on all training rows.
    pub train_s: f64,
    /// To predict every test touch.
    pub predict_s: f64,
}

impl Learning {
    /// All of it.
    pub fn total_s(&self) -> f64 {
        self.choose_s + self.train_s + self.predict_s
    }
}

/// Processor-seconds to fit and test a family in one trial.
pub(super) fn family_s(plan: &Plan, family: &[Cell], n_objects: usize, n_touches: usize) -> f64 {
    let fits = family.chunk_by(|a, b| a.c == b.c);
    fits.map(|cells| learning(plan, &cells[0], n_objects, n_touches).total_s())
        .sum()
}

/// The fits of a family with one C in one trial, and the prediction of every test touch.
pub(super) fn learning(plan: &Plan, cell: &Cell, n_objects: usize, n_touches: usize) -> Learning {
    let m = cell.n_features() as f64;
    let n_train = (cell.train_touches * n_objects) as f64;
    let n_test = (n_touches as f64 - n_train).max(0.0);
    let n_pairs = (n_objects * (n_objects - 1) / 2) as f64;
    let fit = |share: f64| fit_s(plan, cell, n_objects, share * cell.train_touches as f64);
    let choice = &plan.choice;
    let n_c = match cell.classifier.has_c() && cell.c.is_none() {
        true => choice.c.len(),
        false => 1,
    };
    let n_gamma = match cell.classifier.has_gamma() {
        true => choice.gamma_multiples.len().max(1),
        false => 1,
    };
    let choosing = choice.touches.map_or(1.0, |most| {
        (most as f64 / cell.train_touches as f64).min(1.0)
    });
    let n_folds = choice.folds as f64;
    let choose_s = match n_c * n_gamma {
        1 => 0.0,
        n => n as f64 * n_folds * fit((n_folds - 1.0) / n_folds * choosing),
    };
    let predicted_per_row = match cell.classifier {
        ClassifierKind::LinearSvm => match plan.spec.recognition.multiclass {
            Multiclass::OneVsOne => n_pairs,
            Multiclass::OneVsRest | Multiclass::CrammerSinger => n_objects as f64,
        },
        ClassifierKind::RbfSvm | ClassifierKind::PolynomialSvm | ClassifierKind::KNearest => {
            n_train
        }
        _ => n_objects as f64,
    };
    Learning {
        choose_s,
        train_s: fit(1.0),
        predict_s: PREDICT_S * n_test * predicted_per_row * m,
    }
}

/// One fit with so many training touches an object.
fn fit_s(plan: &Plan, cell: &Cell, n_objects: usize, touches: f64) -> f64 {
    let m = cell.n_features() as f64;
    let n_objects = n_objects as f64;
    let n_train = touches * n_objects;
    match cell.classifier {
        ClassifierKind::LogisticRegression => LOGISTIC_S * n_train * n_objects * m,
        ClassifierKind::KNearest => K_NEAREST_S * n_train * m,
        ClassifierKind::NaiveBayes => NAIVE_BAYES_S * n_train * m,
        ClassifierKind::DecisionTree => TREE_S * n_train * m,
        ClassifierKind::RandomForest => FOREST_S * n_train * m.sqrt(),
        ClassifierKind::LinearSvm | ClassifierKind::RbfSvm | ClassifierKind::PolynomialSvm => {
            svm_s(plan, cell, n_objects, touches)
        }
    }
}

/// One fit of an SVM with so many training touches of each of so many objects.
fn svm_s(plan: &Plan, cell: &Cell, n_objects: f64, touches: f64) -> f64 {
    let m = cell.n_features() as f64;
    let n_train = touches * n_objects;
    let recognition = &plan.spec.recognition;
    let (n_problems, rows) = match recognition.multiclass {
        Multiclass::OneVsOne => (n_objects * (n_objects - 1.0) / 2.0, 2.0 * touches),
        Multiclass::OneVsRest | Multiclass::CrammerSinger => (n_objects, n_train),
    };
    let entries = n_problems * rows * rows;
    let products_s = GRAM_ELEMENT_S * n_train * n_train * m;
    match (recognition.solver, cell.classifier) {
        (Solver::Linfa, _) => {
            let own_products_s = KERNEL_ELEMENT_S * m.min(rows) + REDUCE_ELEMENT_S * m;
            entries * (SOLVE_ENTRY_S + own_products_s)
        }
        (_, ClassifierKind::LinearSvm) => {
            let element_s = OWN_LINEAR_ELEMENT_S * m.min(OWN_LINEAR_ELEMENTS);
            entries * (OWN_LINEAR_ENTRY_S + element_s) + products_s
        }
        _ => entries * OWN_ENTRY_S + products_s,
    }
}

impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(f, "  objects  {}", self.n_objects)?;
        writeln!(
            f,
            "  touches  {} on {}",
            self.n_touches,
            match self.n_arrays {
                1 => "one array".to_owned(),
                n => format!("each of {n} arrays"),
            }
        )?;
        writeln!(
            f,
            "  cells    {} × {} trials = {}",
            self.n_cells,
            self.n_trials,
            match (self.n_cells * self.n_trials, self.n_fits * self.n_trials) {
                (results, fits) if results == fits => format!("{fits} fits"),
                (results, fits) => format!("{results} results of {fits} fits"),
            }
        )?;
        writeln!(f, "  memory   at most {}", Bytes(self.memory_bytes))?;
        write!(
            f,
            "  time     about {} on {} threads (one core: touch {}, measure {}, recognise {})",
            Seconds(self.wall_s()),
            self.n_threads,
            Seconds(self.simulate_s),
            Seconds(self.measure_s),
            Seconds(self.recognise_s)
        )
    }
}

struct Seconds(f64);

impl fmt::Display for Seconds {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.0 {
            s if s < 1.0 => write!(f, "1 s"),
            s if s < 100.0 => write!(f, "{s:.0} s"),
            s if s < 6000.0 => write!(f, "{:.0} min", s / 60.0),
            s => write!(f, "{:.1} h", s / 3600.0),
        }
    }
}
