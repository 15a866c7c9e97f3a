//! What it takes to train a classifier and to predict.

use crate::recognition::ClassifierKind;
use crate::recognition::svm::{Multiclass, Solver};
use crate::study::plan::{Plan, SplitKind};
use crate::study::sweep::Group;
use crate::study::table::Cell;

/// Seconds of linfa's solver for one entry of a binary problem's kernel matrix: iterations apart from products.
const SOLVE_ENTRY_S: f64 = 7e-8;
/// Seconds for one dot product's element in that solver's kernel matrix, at most as many as the problem has rows.
const KERNEL_ELEMENT_S: f64 = 1e-9;
/// Seconds for one multiply-add of the matrix product that brings wider features down to that many.
const REDUCE_ELEMENT_S: f64 = 5e-11;
/// Seconds of our solvers for one row of a binary problem and for one entry of its kernel matrix, an RBF one, times C to this power where
/// C is above 1; and for one entry of a polynomial one.
const RBF_ROW_S: f64 = 8e-8;
const RBF_ENTRY_S: f64 = 5e-10;
const RBF_HARDER_WITH_C: f64 = 0.25;
const POLYNOMIAL_ENTRY_S: f64 = 5e-9;
/// Seconds of a linear SVM for one row of a binary problem, for one entry of its kernel matrix, and for each entry and measurement up to
/// as many as half its rows (no hyperplane may part more rows than that) and as this; all times C to this power where C is above 1.
const LINEAR_ROW_S: f64 = 1.35e-7;
const LINEAR_ENTRY_S: f64 = 3.2e-10;
const LINEAR_ELEMENT_S: f64 = 1.3e-11;
const LINEAR_MOST_ELEMENTS: f64 = 256.0;
const LINEAR_HARDER_WITH_C: f64 = 0.4;
/// What a solution takes that goes on from that of a smaller C, as a share of one from nothing, on average.
const ON_A_PATH: f64 = 0.7;
/// Seconds for one multiply-add of the kernel matrix that all their problems share.
const GRAM_ELEMENT_S: f64 = 1.6e-11;
/// The same for one measurement of a row of a binary problem, where linear SVMs make those products only that lie near their margins.
const NEAR_MARGIN_S: f64 = 1.3e-9;
/// Seconds to make a value of a kernel that is not linear of a product.
const KERNEL_VALUE_S: f64 = 1.2e-9;
/// Seconds for one multiply-add of a pair's decision, over the training rows of its two classes.
const DECIDE_S: f64 = 5e-11;
/// Seconds to count the vote of one binary problem for one test row.
const VOTE_S: f64 = 1e-8;
/// Seconds of a logistic regression for one measurement of a training row and one object; the rest of its work is that of so many
/// measurements more.
const LOGISTIC_S: f64 = 7.7e-8;
const LOGISTIC_REST: f64 = 40.0;
/// Seconds to scale and to store one measurement of a training row, for nearest neighbours.
const K_NEAREST_S: f64 = 1.2e-8;
/// Seconds for one multiply-add of the distance between a test row and a training row, and to see whether it is among the nearest.
const DISTANCE_ELEMENT_S: f64 = 6e-11;
const NEAREST_S: f64 = 6.5e-9;
/// Seconds of naive Bayes for one measurement of a training row.
const NAIVE_BAYES_S: f64 = 4.5e-8;
/// Seconds of a decision tree for one measurement of a training row.
const TREE_S: f64 = 3.3e-7;
/// Seconds of a random forest for one training row and one of the √m measurements that a split looks at.
const FOREST_S: f64 = 3.4e-5;
/// Seconds for one multiply-add of a prediction by matrix product.
const PREDICT_S: f64 = 2.5e-11;

/// Processor-seconds of what is done for one C of a family in one trial.
#[derive(Clone, Copy, Debug)]
struct Learning {
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
pub(in crate::study) fn family_s(
    plan: &Plan,
    family: &[Cell],
    n_objects: usize,
    n_touches: usize,
) -> f64 {
    let fits = Group::fits(family);
    fits.map(|cells| learning(plan, &cells[0], n_objects, n_touches).total_s())
        .sum()
}

/// The fits of a family with one C in one trial, and the prediction of every test touch.
fn learning(plan: &Plan, cell: &Cell, n_objects: usize, n_touches: usize) -> Learning {
    let train_touches = cell.train_touches as f64;
    let n_objects = n_objects as f64;
    let n_test = match plan.split.kind {
        SplitKind::HoldOut(share) => share * n_touches as f64,
        SplitKind::Folds(n) => n_touches as f64 / n as f64,
    };
    let fit = |share: f64| fit(plan, cell, n_objects, share * train_touches);
    let choice = &plan.choice;
    let n_c = match cell.classifier.has_c() && cell.c.is_none() {
        true => choice.c.len(),
        false => 1,
    };
    let n_gamma = match cell.classifier.has_gamma() {
        true => choice.gamma_multiples.len().max(1),
        false => 1,
    };
    let choosing = choice
        .touches
        .map_or(1.0, |most| (most as f64 / train_touches).min(1.0));
    let n_folds = choice.folds as f64;
    let choose_s = match n_c * n_gamma {
        1 => 0.0,
        n => {
            let once = fit(choosing);
            let in_fold = fit((n_folds - 1.0) / n_folds * choosing);
            let solve_s = ON_A_PATH * n as f64 * n_folds * in_fold.solve_s;
            once.products_s + n_gamma as f64 * once.values_s + solve_s
        }
    };
    Learning {
        choose_s,
        train_s: fit(1.0).total_s(),
        predict_s: n_test * predict_row_s(plan, cell, n_objects),
    }
}

/// To predict one test touch.
fn predict_row_s(plan: &Plan, cell: &Cell, n_objects: f64) -> f64 {
    let m = cell.n_features() as f64;
    let n_train = cell.train_touches as f64 * n_objects;
    let n_problems = n_problems(plan, n_objects);
    match cell.classifier {
        ClassifierKind::KNearest => n_train * (NEAREST_S + DISTANCE_ELEMENT_S * m),
        ClassifierKind::RbfSvm | ClassifierKind::PolynomialSvm => {
            let decide_s = DECIDE_S * (n_objects - 1.0);
            n_train * (PREDICT_S * m + KERNEL_VALUE_S + decide_s) + VOTE_S * n_problems
        }
        ClassifierKind::LinearSvm => n_problems * (PREDICT_S * m + VOTE_S),
        _ => PREDICT_S * n_objects * m,
    }
}

/// Binary problems that tell so many objects apart.
fn n_problems(plan: &Plan, n_objects: f64) -> f64 {
    match plan.spec.recognition.multiclass {
        Multiclass::OneVsOne => n_objects * (n_objects - 1.0) / 2.0,
        Multiclass::OneVsRest | Multiclass::CrammerSinger => n_objects,
    }
}

/// Processor-seconds of one fit, by what a choice of C and γ shares.
struct Fit {
    /// Products of rows: once for all folds, C and γ.
    products_s: f64,
    /// Values of a kernel: once a γ.
    values_s: f64,
    /// All else.
    solve_s: f64,
}

impl Fit {
    /// Of which nothing can be shared.
    fn apart(solve_s: f64) -> Self {
        Self {
            products_s: 0.0,
            values_s: 0.0,
            solve_s,
        }
    }

    fn total_s(&self) -> f64 {
        self.products_s + self.values_s + self.solve_s
    }
}

/// One fit with so many training touches an object.
fn fit(plan: &Plan, cell: &Cell, n_objects: f64, touches: f64) -> Fit {
    let m = cell.n_features() as f64;
    let n_train = touches * n_objects;
    Fit::apart(match cell.classifier {
        ClassifierKind::LogisticRegression => {
            LOGISTIC_S * n_train * n_objects * (m + LOGISTIC_REST)
        }
        ClassifierKind::KNearest => K_NEAREST_S * n_train * m,
        ClassifierKind::NaiveBayes => NAIVE_BAYES_S * n_train * m,
        ClassifierKind::DecisionTree => TREE_S * n_train * m,
        ClassifierKind::RandomForest => FOREST_S * n_train * m.sqrt(),
        ClassifierKind::LinearSvm | ClassifierKind::RbfSvm | ClassifierKind::PolynomialSvm => {
            return svm(plan, cell, n_objects, touches);
        }
    })
}

/// One fit of an SVM with so many training touches of each of so many objects.
fn svm(plan: &Plan, cell: &Cell, n_objects: f64, touches: f64) -> Fit {
    let m = cell.n_features() as f64;
    let n_train = touches * n_objects;
    let recognition = &plan.spec.recognition;
    let n_problems = n_problems(plan, n_objects);
    let rows = match recognition.multiclass {
        Multiclass::OneVsOne => 2.0 * touches,
        Multiclass::OneVsRest | Multiclass::CrammerSinger => n_train,
    };
    if recognition.solver == Solver::Linfa {
        let own_products_s = KERNEL_ELEMENT_S * m.min(rows) + REDUCE_ELEMENT_S * m;
        return Fit::apart(n_problems * rows * rows * (SOLVE_ENTRY_S + own_products_s));
    }
    let (row_s, entry_s, harder_with_c) = match cell.classifier {
        ClassifierKind::LinearSvm => {
            let n_elements = m.min(0.5 * rows).min(LINEAR_MOST_ELEMENTS);
            let entry_s = LINEAR_ENTRY_S + LINEAR_ELEMENT_S * n_elements;
            (LINEAR_ROW_S, entry_s, LINEAR_HARDER_WITH_C)
        }
        ClassifierKind::PolynomialSvm => (0.0, POLYNOMIAL_ENTRY_S, 0.0),
        _ => (RBF_ROW_S, RBF_ENTRY_S, RBF_HARDER_WITH_C),
    };
    let harder = typical_c(plan, cell).max(1.0).powf(harder_with_c);
    let all_products_s = GRAM_ELEMENT_S * n_train * n_train * m;
    let (products_s, values_s) = match cell.classifier {
        ClassifierKind::LinearSvm => {
            let near_margin_s = NEAR_MARGIN_S * n_problems * rows * m;
            (all_products_s.min(near_margin_s), 0.0)
        }
        _ => (all_products_s, KERNEL_VALUE_S * 0.5 * n_train * n_train),
    };
    Fit {
        products_s,
        values_s,
        solve_s: harder * n_problems * rows * (row_s + rows * entry_s),
    }
}

/// C, or the geometric mean of those that it is chosen among.
fn typical_c(plan: &Plan, cell: &Cell) -> f64 {
    let of_choice = || {
        let sum: f64 = plan.choice.c.iter().map(|c| c.ln()).sum();
        (sum / plan.choice.c.len().max(1) as f64).exp()
    };
    cell.c.unwrap_or_else(of_choice)
}
