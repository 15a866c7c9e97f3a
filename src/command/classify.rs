//! `bubbletouch classify`: trains and tests one classifier on a folder of features, and measures the times.

use crate::command::options::classifier_parameters::ParameterOptions;
use crate::command::options::study_args::set_threads;
use crate::command::options::unused::check_used;
use crate::command::terminal::say;
use bubbletouch::engine::program::PROGRAM;
use bubbletouch::files::check_single_output;
use bubbletouch::quantile::quantile;
use bubbletouch::random::Seed;
use bubbletouch::recognition::classifiers::classifier::{Classifier, Cost, TrainedClassifier};
use bubbletouch::recognition::classifiers::parameters;
use bubbletouch::recognition::data::dataset::Dataset;
use bubbletouch::recognition::data::scaling::Scaling;
use bubbletouch::recognition::data::split::{Split, group_k_fold, stratified_k_fold};
use bubbletouch::recognition::statistics::grouped::{
    FEW_GROUPS, GroupedTest, count_groups, interval_of,
};
use bubbletouch::recognition::svm::class_weight::ClassWeight;
use bubbletouch::recognition::svm::cross_validation::choice::{Candidates, Chosen};
use bubbletouch::recognition::svm::{Multiclass, SvmSolver};
use bubbletouch::recognition::{ClassifierKind, ModelFile};
use bubbletouch::study::{
    CONFIDENCE, FeatureSet, KeyValue, NewRows, read_features, read_new_rows, write_npy, write_texts,
};
use bubbletouch::table::short_number;
use bubbletouch::{Error, Result};
use ndarray::{Array1, Axis};
use serde::de::IntoDeserializer;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Train, test and time one classifier, or apply a saved one
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  bubbletouch classify features --classifier rbf_svm --c-grid 0.1,1,10"
)]
pub struct Args {
    /// Folder that bubbletouch features wrote
    ///
    /// The folder contains features, labels, train and test as .npy, .npz or .csv files.
    folder: PathBuf,
    /// Train this classifier: linear_svm, rbf_svm, polynomial_svm, …
    #[arg(long, value_name = "NAME", value_parser = word::<ClassifierKind>, required_unless_present = "model", help_heading = "Classifier")]
    classifier: Option<ClassifierKind>,
    /// Apply the trained classifier that --save wrote
    ///
    /// The test rows are predicted, or all rows if the folder has no test rows. With labels, the accuracy is printed.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["classifier", "groups", "c", "c_grid", "gamma_grid", "cv_folds", "class_weight", "solver", "multiclass", "tolerance", "train_rows", "save"], help_heading = "Input")]
    model: Option<PathBuf>,
    /// Read the group of every row (pose, grasp, day, …)
    ///
    /// The file contains one integer or text for each row of features. A group that both trains and tests is refused. Folds of --c-grid keep groups
    /// whole, and the interval of the accuracy comes from groups, not rows.
    #[arg(long, value_name = "FILE", help_heading = "Input")]
    groups: Option<PathBuf>,
    /// Set the soft-margin penalty C [default: 1]
    #[arg(long, value_name = "C", help_heading = "Classifier")]
    c: Option<f64>,
    /// Choose C from this grid by cross-validation
    #[arg(
        long,
        value_name = "C,C,…",
        value_delimiter = ',',
        conflicts_with = "c",
        help_heading = "Cross-validation"
    )]
    c_grid: Vec<f64>,
    /// Choose γ from this grid of multiples of scale
    #[arg(
        long,
        value_name = "X,X,…",
        value_delimiter = ',',
        conflicts_with = "gamma",
        help_heading = "Cross-validation"
    )]
    gamma_grid: Vec<f64>,
    /// Use K folds [default: 5]
    #[arg(long, value_name = "K", help_heading = "Cross-validation")]
    cv_folds: Option<usize>,
    /// Weigh the classes: uniform, or balanced by their number of rows [default: uniform]
    #[arg(long, value_name = "HOW", value_parser = word::<ClassWeight>, help_heading = "Classifier")]
    class_weight: Option<ClassWeight>,
    /// Train an SVM by smo or coordinate_descent [default: smo]
    #[arg(long, value_name = "NAME", value_parser = word::<SvmSolver>, help_heading = "Classifier")]
    solver: Option<SvmSolver>,
    #[command(flatten)]
    parameters: ParameterOptions,
    /// Combine two-class SVMs by one_vs_one, one_vs_rest, … [default: one_vs_one]
    #[arg(long, value_name = "HOW", value_parser = word::<Multiclass>, help_heading = "Classifier")]
    multiclass: Option<Multiclass>,
    /// Scale features by standard, overall or none
    ///
    /// The scale is computed from the training rows.
    #[arg(long, value_name = "HOW", default_value = "standard", value_parser = word::<Scaling>, help_heading = "Classifier")]
    scaling: Scaling,
    /// Set the stopping tolerance of the solver [default: 0.001]
    #[arg(long, value_name = "EPS", help_heading = "Classifier")]
    tolerance: Option<f64>,
    /// Set the seed of the classifier
    #[arg(
        long,
        value_name = "N",
        default_value_t = 2018,
        help_heading = "Classifier"
    )]
    seed: u64,
    /// Train on the first N training rows [default: all]
    #[arg(long, value_name = "N", help_heading = "Input")]
    train_rows: Option<usize>,
    /// Train and predict N times; print median times
    #[arg(long, value_name = "N", default_value_t = 1, help_heading = "Run")]
    repeat: usize,
    /// Write the predicted labels of the test rows to .npy
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    predictions: Option<PathBuf>,
    /// Write the trained classifier
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    save: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long, help_heading = "Output")]
    json: bool,
    /// Use N threads; results do not depend on N [default: all cores]
    #[arg(long, value_name = "N", help_heading = "Run")]
    threads: Option<usize>,
}

/// Writes the predicted classes with the values of the label file: integers or texts.
fn write_predictions(path: &Path, classes: &[KeyValue], predicted: &Array1<usize>) -> Result<()> {
    let values = predicted.iter().map(|&class| &classes[class]);
    let integers = values.clone().map(KeyValue::integer);
    match integers.collect::<Option<Vec<i64>>>() {
        Some(integers) => write_npy(path, &Array1::from(integers)),
        None => write_texts(path, &values.map(KeyValue::to_string).collect::<Vec<_>>()),
    }
}

/// Values that `bubbletouch classify` prints; in JSON, one key per field.
#[derive(Serialize)]
struct Findings {
    program: &'static str,
    classifier: ClassifierKind,
    /// Multi-class strategy; `None` for classifiers other than kernel SVMs.
    multiclass: Option<Multiclass>,
    scaling: Scaling,
    /// Weights of the classes; `None` for classifiers without.
    class_weight: Option<ClassWeight>,
    /// Solver that trained the SVM; `None` for classifiers other than kernel SVMs.
    solver: Option<SvmSolver>,
    /// Penalty C that was used; `None` for classifiers without C.
    c: Option<f64>,
    /// Result of the cross-validated choice of C and γ; `None` if both were given.
    chosen: Option<Chosen>,
    /// Unit of the split and of the confidence interval: "rows" or "groups".
    split_by: &'static str,
    n_train: usize,
    n_test: usize,
    /// Number of groups of training rows; `None` without groups.
    n_train_groups: Option<usize>,
    /// Number of groups of test rows, over which the interval is computed; `None` without groups.
    n_test_groups: Option<usize>,
    n_measurements: usize,
    n_correct: usize,
    accuracy: f64,
    accuracy_low: f64,
    accuracy_high: f64,
    /// Training time of each repetition, including scaling, s.
    fit_s: Vec<f64>,
    fit_median_s: f64,
    /// Time of each repetition to predict all test rows, including scaling, s.
    predict_s: Vec<f64>,
    predict_median_s: f64,
    /// Results that only kernel SVMs have; `None` for other classifiers.
    svm: Option<SvmFindings>,
}

#[derive(Serialize)]
struct SvmFindings {
    /// Number of training rows that have a multiplier above 0 in at least one binary problem.
    n_support_vectors: usize,
    n_problems: usize,
    /// Number of binary problems that stopped at the maximum number of iterations before reaching the tolerance.
    n_capped: usize,
    /// Objective that training minimises, summed over the binary problems: `½ Σ_ij a_i a_j y_i y_j K(x_i, x_j) − Σ_i a_i`.
    dual_objective: f64,
}

pub fn classify(args: &Args) -> Result<()> {
    set_threads(args.threads)?;
    if args.repeat == 0 {
        return Err(Error::input("--repeat", 0, "at least 1"));
    }
    for path in [&args.predictions, &args.save].into_iter().flatten() {
        check_single_output(path)?;
    }
    let kind = match (&args.model, args.classifier) {
        (None, Some(kind)) => kind,
        (model, _) => return args.apply(model.as_deref().expect("a required option")),
    };
    args.check_parameters(kind)?;
    let set = read_features(&args.folder)?;
    let set = match &args.groups {
        None => set,
        Some(path) => set.with_groups(path)?,
    };
    let (findings, predicted, classifier) = args.train_and_test(kind, &set)?;
    // A kind of classifier that cannot be saved is refused before other files are written.
    if let Some(path) = &args.save {
        let file = ModelFile {
            kind,
            classes: set.classes.clone(),
            columns: set.columns.clone(),
            classifier,
        };
        file.write(path)?;
    }
    if let Some(path) = &args.predictions {
        write_predictions(path, &set.classes, &predicted)?;
    }
    match args.json {
        true => {
            let json = serde_json::to_string(&findings).expect("findings have a JSON form");
            say(json)
        }
        false => tell(&findings),
    }
}

impl Args {
    /// Applies a trained classifier to the rows of the folder.
    fn apply(&self, model: &Path) -> Result<()> {
        for key in parameters::keys() {
            let option = format!("--{}", key.replace('_', "-"));
            let is_given = self.parameters.has(key);
            check_used(&option, is_given, false, "--classifier")?;
        }
        let model = ModelFile::read(model)?;
        let NewRows { features, labels } = read_new_rows(&self.folder, model.columns.as_deref())?;
        let (mut predict_s, mut predicted) = (Vec::new(), Array1::default(0));
        for _ in 0..self.repeat {
            let start = Instant::now();
            predicted = model.classifier.labels(features.view())?;
            predict_s.push(start.elapsed().as_secs_f64());
        }
        if let Some(path) = &self.predictions {
            write_predictions(path, &model.classes, &predicted)?;
        }
        let is_correct = |(label, found): &(&KeyValue, &usize)| model.classes[**found] == **label;
        let n_correct = labels
            .as_ref()
            .map(|labels| labels.iter().zip(&predicted).filter(is_correct).count());
        let (n_rows, n_measurements) = (predicted.len(), features.ncols());
        let accuracy = n_correct.map(|n| n as f64 / n_rows as f64);
        if self.json {
            // Without labels, the accuracy is null.
            return say(serde_json::json!({
                "program": PROGRAM,
                "classifier": model.kind,
                "n_rows": n_rows,
                "n_measurements": n_measurements,
                "n_correct": n_correct,
                "accuracy": accuracy,
                "predict_s": predict_s,
            }));
        }
        let rows = format!("{n_rows}, {n_measurements} measurements each");
        let mut lines = vec![("rows", rows)];
        if let (Some(n_correct), Some(accuracy)) = (n_correct, accuracy) {
            let found = format!("{accuracy:.4}: {n_correct} of {n_rows}");
            lines.push(("accuracy", found));
        }
        let predict_s = quantile(&mut predict_s, 0.5);
        lines.push(("testing", testing_time(predict_s, n_rows)));
        say_lines(&lines)
    }

    fn train_and_test(
        &self,
        kind: ClassifierKind,
        set: &FeatureSet,
    ) -> Result<(Findings, Array1<usize>, TrainedClassifier)> {
        let classifier = self.classifier(kind)?;
        let is_svm = kind.is_kernel_svm();
        let (training, test) = (set.training(self.train_rows)?, set.test()?);
        let groups_of = |rows: &[usize]| Some(set.groups.as_ref()?.select(Axis(0), rows));
        let n_train = training.targets.len();
        let train_groups = groups_of(&set.split.train[..n_train]);
        let folds = || self.folds(&training, train_groups.as_ref());
        let seed = Seed::new(self.seed);
        let (mut fit_s, mut predict_s) = (Vec::new(), Vec::new());
        let mut last = None;
        for _ in 0..self.repeat {
            let start = Instant::now();
            let trained = classifier.train_validated(&training, &folds()?, &seed)?;
            fit_s.push(start.elapsed().as_secs_f64());
            let start = Instant::now();
            let predicted = trained.labels(test.records.view())?;
            predict_s.push(start.elapsed().as_secs_f64());
            last = Some((trained, predicted));
        }
        let (trained, predicted) = last.expect("at least one repeat");
        let n_test = predicted.len();
        let pairs = predicted.iter().zip(&test.targets);
        let is_correct: Vec<bool> = pairs.map(|(predicted, truth)| predicted == truth).collect();
        let n_correct = is_correct.iter().filter(|is_correct| **is_correct).count();
        let groups = groups_of(&set.split.test);
        let groups = groups.map(|groups| count_groups(groups.into_iter().zip(is_correct)));
        let tested = groups.as_ref().map(|groups| GroupedTest {
            n_rows: n_test,
            n_correct,
            groups,
        });
        let (interval, n_test_groups) =
            interval_of([n_correct, n_test], tested.as_slice(), CONFIDENCE)?;
        let findings = Findings {
            program: PROGRAM,
            classifier: kind,
            multiclass: is_svm.then_some(classifier.multiclass),
            scaling: self.scaling,
            class_weight: kind.uses("class_weight").then_some(classifier.class_weight),
            solver: is_svm.then_some(classifier.solver),
            c: trained.c(),
            chosen: trained.chosen().cloned(),
            split_by: match n_test_groups {
                None => "rows",
                Some(_) => "groups",
            },
            n_train,
            n_test,
            n_train_groups: train_groups.map(|groups| groups.iter().collect::<BTreeSet<_>>().len()),
            n_test_groups,
            n_measurements: training.records.ncols(),
            n_correct,
            accuracy: n_correct as f64 / n_test as f64,
            accuracy_low: interval.low,
            accuracy_high: interval.high,
            fit_median_s: quantile(&mut fit_s.clone(), 0.5),
            fit_s,
            predict_median_s: quantile(&mut predict_s.clone(), 0.5),
            predict_s,
            svm: svm_findings(&trained),
        };
        Ok((findings, predicted, trained))
    }

    /// Returns the cross-validation folds for the choice of parameters; a fold never divides a group.
    fn folds(&self, training: &Dataset, groups: Option<&Array1<usize>>) -> Result<Vec<Split>> {
        if self.c_grid.is_empty() {
            return Ok(Vec::new());
        }
        let seed = Seed::new(self.seed).named("validation");
        let (labels, k) = (training.targets.view(), self.cv_folds.unwrap_or(5));
        match groups {
            None => Ok(stratified_k_fold(labels, k, &seed)?),
            Some(groups) => Ok(group_k_fold(labels, groups.view(), k, &seed)?),
        }
    }

    /// Returns an error if options for an unused parameter choice, or hyper-parameters that the classifier does not use, are given.
    fn check_parameters(&self, kind: ClassifierKind) -> Result<()> {
        let chooses = !self.c_grid.is_empty();
        let chooses_gamma = !self.gamma_grid.is_empty();
        check_used("--gamma-grid", chooses_gamma, chooses, "--c-grid")?;
        let folds = self.cv_folds.is_some();
        check_used("--cv-folds", folds, chooses, "--c-grid")?;
        let given = [
            ("c", self.c.is_some()),
            ("c_grid", chooses),
            ("gamma_grid", chooses_gamma),
            ("class_weight", self.class_weight.is_some()),
            ("multiclass", self.multiclass.is_some()),
            ("solver", self.solver.is_some()),
            ("tolerance", self.tolerance.is_some()),
        ];
        for key in parameters::keys() {
            let is_given = given.contains(&(key, true)) || self.parameters.has(key);
            let user = format!("--classifier {}", parameters::users(key));
            let option = format!("--{}", key.replace('_', "-"));
            check_used(&option, is_given, kind.uses(key), &user)?;
        }
        Ok(())
    }

    /// Returns the classifier with the values of the options.
    fn classifier(&self, kind: ClassifierKind) -> Result<Classifier> {
        let usual = self.parameters.applied_to(Classifier::new(kind))?;
        Ok(Classifier {
            scaling: self.scaling,
            multiclass: self.multiclass.unwrap_or(usual.multiclass),
            class_weight: self.class_weight.unwrap_or(usual.class_weight),
            solver: self.solver.unwrap_or(usual.solver),
            c: match &self.c_grid[..] {
                [] => Cost::Fixed(self.c.unwrap_or(1.0)),
                candidates => Cost::Chosen(Candidates {
                    c: candidates.to_vec(),
                    gamma_scales: self.gamma_grid.clone(),
                }),
            },
            tolerance: self.tolerance.unwrap_or(usual.tolerance),
            ..usual
        })
    }
}

fn svm_findings(trained: &TrainedClassifier) -> Option<SvmFindings> {
    let problems = trained.svm()?.problems();
    let support: BTreeSet<usize> = problems
        .iter()
        .flat_map(|problem| problem.rows.iter().zip(&problem.solution.coefficients))
        .filter(|(_, coefficient)| **coefficient != 0.0)
        .map(|(&row, _)| row)
        .collect();
    Some(SvmFindings {
        n_support_vectors: support.len(),
        n_problems: problems.len(),
        n_capped: trained.n_capped(),
        // Training minimises the dual objective with the opposite sign.
        dual_objective: -problems.iter().map(|p| p.solution.objective).sum::<f64>(),
    })
}

/// Prints lines of a title and a text.
fn say_lines(lines: &[(&str, String)]) -> Result<()> {
    let mut lines = lines.iter();
    lines.try_for_each(|(title, text)| say(format_args!("{title:<10}{text}")))
}

/// Returns the time of a prediction of all rows, and the time of each row.
fn testing_time(predict_s: f64, n_rows: usize) -> String {
    let each_us = 1e6 * predict_s / n_rows as f64;
    format!("{predict_s:.4} s, {each_us:.1} µs a row")
}

/// Prints the findings as text.
fn tell(found: &Findings) -> Result<()> {
    let rows = format!(
        "{} to train on, {} to test, {} measurements each",
        found.n_train, found.n_test, found.n_measurements
    );
    let mut lines = vec![("rows", rows)];
    if let (Some(n_train), Some(n_test)) = (found.n_train_groups, found.n_test_groups) {
        let few = match n_test < FEW_GROUPS {
            true => ", too few for a narrow interval",
            false => "",
        };
        let split = format!(
            "by groups: {n_train} to train on, {n_test} to test; the interval comes from {n_test} groups{few}"
        );
        lines.push(("split", split));
    }
    let accuracy = format!(
        "{:.4} ({:.4} to {:.4}): {} of {}",
        found.accuracy, found.accuracy_low, found.accuracy_high, found.n_correct, found.n_test
    );
    lines.push(("accuracy", accuracy));
    if let Some(Chosen { best, tried, .. }) = &found.chosen {
        let gamma = best.gamma.map(short_number);
        let gamma = gamma.map_or(String::new(), |gamma| format!(" and γ = {gamma}"));
        let (c, accuracy, n) = (best.c, best.accuracy, tried.len());
        let choice = format!("C = {c}{gamma}, {accuracy:.4} on validation rows, of {n} candidates");
        lines.push(("choice", choice));
    }
    lines.push(("training", format!("{:.4} s", found.fit_median_s)));
    lines.push((
        "testing",
        testing_time(found.predict_median_s, found.n_test),
    ));
    if let Some(svm) = &found.svm {
        let svm = format!(
            "{} support vectors, {} of {} problems stopped short of the tolerance, dual objective {:.6}",
            svm.n_support_vectors, svm.n_capped, svm.n_problems, svm.dual_objective
        );
        lines.push(("SVM", svm));
    }
    say_lines(&lines)
}

/// Parses a text to a value that is spelled as in study files; the error lists the allowed values.
pub fn word<T: for<'a> Deserialize<'a>>(text: &str) -> std::result::Result<T, String> {
    let deserializer: serde::de::value::StrDeserializer<serde::de::value::Error> =
        text.into_deserializer();
    T::deserialize(deserializer).map_err(|error| error.to_string())
}
