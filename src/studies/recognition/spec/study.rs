//! Specification of a recognition study: the keys of its TOML file, in the units of the file.
//!
//! The specification checks only names and types; the plan of the study checks values. A key that is an axis has one value or a
//! list of values.

use crate::engine::axes;
use crate::engine::axes::StudyAxes;
use crate::inputs::keys::{Acts, AxisPlace};
use crate::inputs::memory::GIB;
use crate::inputs::params::{Described, ORDER, is_default, named};
use crate::inputs::range::MAX_COUNTED;
use crate::inputs::range::Range::{AtLeastOne, Fraction};
use crate::inputs::toml_value::{table_of, value_at};
use crate::learning::data::temporal_features::TemporalFeatures;
use crate::learning::evaluation::next_touch::NextTouch;
use crate::studies::prelude::*;
use crate::studies::recognition::plan::Condition;
use crate::studies::recognition::rows::TrialScore;
use crate::studies::recognition::spec::*;
use crate::table::Scale::{Linear, Log, Share, Words};
use crate::table::{Column, Columns};
use crate::world::ArrayLayout;
use bubbletouch_sim::features::Features;
use bubbletouch_svm::class_weight::ClassWeight;
use bubbletouch_svm::scaling::Scaling;
use bubbletouch_svm::{DEFAULT_MEMORY_BYTES, Multiclass, SvmSolver};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Default of the maximum tilt of a tilted copy about each axis, degrees. With a larger value, copies lack those parts of the object that were not touched;
/// with a smaller value, copies add no new tilts.
pub(crate) const DEFAULT_TILT_DEG: f64 = 5.0;
/// Default of the penalty C.
pub(crate) const DEFAULT_C: f64 = 1.0;
/// Default of the fraction of the touches that a random split holds out for testing.
pub(crate) const DEFAULT_TEST_FRACTION: f64 = 0.25;
/// Default of the number of folds of the inner cross-validation.
pub(crate) const DEFAULT_CV_FOLDS: u32 = 5;
pub(super) const OF_TEST_SET: &str = "no such key: recorded.frames_test is the test set";
const OF_RECORDED_SPLITS: &str = "no such key: recorded.splits has the split of each trial";
const OF_SPLIT: &str = "no such key: the split says what is held out";
const DRAWN: &str = "no such key, or { uniform = [low, high] } of such a key of [touches]";

/// Condition of the keys that set the number of measurements.
const OF_COUNTS: &[Acts] = acts![Plan: |plan| plan.counts_measurements()
    => "every ensemble of the study measures all values of a frame", "no such key, or another sensing.ensemble beside it"];
/// Condition of the keys of image features.
const OF_IMAGES: &[Acts] = acts![Plan: |plan| plan.spec.recognition.has_images() => "no features of the study are of images", "features of images, or no such key"];

/// Default random seed of all kinds of studies.
pub const DEFAULT_SEED: u64 = 2018;

params! {
    /// Contents of a recognition study file.
    pub struct StudySpec {
        /// Question that the study answers, in one sentence.
        question: String => Unchecked, Note, Never;
        /// Answer that the author expected before the first run. Default: empty.
        expected: String = String::new() => Unchecked, Note, Never;
        /// Seed of all random numbers. Default: 2018.
        seed: u64 = DEFAULT_SEED => Unchecked, Subject, Never;
        /// Number of trials per configuration, at least 1, each with a new split, projection and noise. Default: `recognition.folds`, or 1 without folds.
        trials: usize = 1 => Count(1, MAX_TRIALS), Subject, Never;
        /// Number P of projections (measurement matrices) per split; the study has `trials` / P splits, each combined with P projections. Default: one projection
        /// per trial. With several projections, `variance.csv` separates the effect of the projection on the accuracy from the effect of the split.
        projections_per_split: Option<usize> => Count(2, MAX_TRIALS), Note, Never;
        /// Table `[objects]`: the touched objects.
        #[serde(skip_serializing_if = "is_default")]
        objects: ObjectsSpec = ObjectsSpec::default();
        /// Table `[skin]`: the arrays of taxels.
        skin: SkinSpec;
        /// Table `[touches]`: poses and depths of the touches.
        #[serde(skip_serializing_if = "is_default")]
        touches: TouchesSpec = TouchesSpec::default();
        /// Table `[human_touch]`: recognition of kinds of human touch, such as a stroke. Replaces `[objects]` and `[touches]`.
        human_touch: Option<HumanTouchSpec>;
        /// Table `[recorded]`: frames that a real skin recorded. Replaces `[objects]` and `[touches]`.
        recorded: Option<RecordedSpec>;
        /// Table `[signal]`: noise, sensor errors and processing of frames before compression.
        signal: SignalSpec = SignalSpec::default();
        /// Table `[sensing]`: compression of frames into measurements. Default: `ensemble = "identity"`, which measures all taxels without compression.
        sensing: SensingSpec = SensingSpec::default();
        /// Table `[recognition]`: features, classifiers, and the split into training and test touches.
        recognition: RecognitionSpec;
        /// Table `[test]`: keys of `[objects]`, `[skin]`, `[touches]` and `[signal]` whose values differ for test touches, such as `test.touches.depth_mm`.
        #[serde(skip_serializing_if = "toml::Table::is_empty")]
        test: toml::Table = toml::Table::default() => Unchecked, Condition, Axes;
        /// Table `[report]`: contents of the page and of some tables.
        report: ReportSpec = ReportSpec::default();
    }
    unread {
        /// Table `[axes]`: further axes, each consisting of a key and a list of its values.
        axes: StudyAxes;
    }
}

params! {
    /// Keys of `[sensing]`: compression of frames into measurements.
    pub struct SensingSpec {
        /// Axis: ensemble from which the measurement matrix is drawn. Default: `gaussian`.
        ensemble: Axis<Ensemble> = Axis::One(Ensemble::Gaussian) => Any, Choice, Table, scale: Words, names: Ensemble::NAMES, of_all_kinds: true;
        /// Axis: compression ratio n / m, at least 1: number n of taxels divided by the number m of measurements.
        ratio: Option<Axis<f64>> => AtLeastOne, Choice, Table, title: "compression", unit: ":1", scale: Log, gives_way: 1, usual: || 1.0.into(), of_all_kinds: true, acts: OF_COUNTS;
        /// Axis: number m of measurements per frame, at least 1. Replaces `ratio`.
        measurements: Option<Axis<usize>> => COUNT, Choice, Table, title: "m", scale: Log, gives_way: 1, replaces: "ratio", of_all_kinds: true, acts: OF_COUNTS;
        /// Axis: method by which the ensemble `selected` selects the m taxels to read, from training touches only. Values: `greedy` (default; highest
        /// validation accuracy of a nearest-neighbour classifier), `pivoted_qr` (pivots of m principal components; m is below the number of training frames)
        /// or `random` (a control). At most 4,096 frames of the training touches are used.
        selection: Option<Axis<Selection>> => Any, Choice, Table, title: "taxels selected by", scale: Words, names: Selection::NAMES, usual: || "greedy".into(),
            acts: acts![Plan: |plan| plan.spec.sensing.selects_taxels()
                => "no ensemble of the study selects taxels", "\"selected\" among sensing.ensemble, or no such key"];
        /// Number of measurements that the skin reads out per second. Adds the column `readout_ms`, the time to read a frame. Default: no such column.
        readings_per_s: Option<f64> => Positive, Choice, Axes;
    }
}

impl Default for SensingSpec {
    /// Returns the compression of a study without the table `[sensing]`: all taxels are measured.
    fn default() -> Self {
        Self {
            ensemble: Axis::One(Ensemble::Identity),
            ratio: None,
            measurements: None,
            selection: None,
            readings_per_s: None,
        }
    }
}

params! {
    /// Keys of `[recognition]`: features, classifiers, and the split into training and test touches.
    pub struct RecognitionSpec {
        /// Axis: features of a touch, before scaling. Default: `raw`. Transformations of the measurements: `raw`, `centred`, `unit_norm`, `centred_unit_norm`.
        /// Features of images: `fourier_magnitude`, `fourier_mellin`, `polar_harmonics`, `descriptors`, `aligned`, or several of these joined by `+`. For features
        /// of force, add `"force"` to `signal.steps`.
        features: Axis<FeatureChoice> = Axis::One(FeatureChoice(Features::Raw)) => Any, Choice, Table, scale: Words, names: Features::NAMES, gives_way: 13;
        /// Axis: depth window of the image features, as a fraction of the full scale. Image features use only deflections within this window below the largest
        /// deflection of a frame. They therefore do not depend on the press depth. Default: the whole image.
        depth_window_full_scale: Option<Axis<f64>> => Positive, Choice, Table, title: "depth window", unit: "%", scale: Share, acts: OF_IMAGES;
        /// Axis: number of additional copies of each training touch, whose images are randomly tilted. The copies make recognition robust to tilts that do not
        /// occur in training. Copies require image features. Default: 0.
        tilt_augmentation: Option<Axis<usize>> => Count(0, MAX_COPIES), Choice, Table, scale: Linear, usual: || 0.into(), acts: OF_IMAGES;
        /// Maximum tilt of a copy about the array's x and y axes, degrees; the tilts are uniformly distributed. Default: 5.
        tilt_augmentation_deg: Option<f64> => TILT, Choice, Axes, usual: || DEFAULT_TILT_DEG.into(),
            acts: acts![Plan: |plan| plan.spec.recognition.has_copies() => "no touch is copied", "a recognition.tilt_augmentation above 0 beside it"];
        /// Axis: method that combines the frames of a touch into features. Values: `deepest` (deepest frame), `stacked_8` (8 or another number of evenly spaced
        /// frames), `moments` (of each measurement), `course` (of the touch) or `summarised` (moments and course). Default: all frames are concatenated.
        temporal_features: Option<Axis<TemporalFeatures>> => Any, Choice, Table, scale: Words, names: OVER_TIME, gives_way: 12,
            acts: acts![Plan: |plan| plan.spec.recognition.combines_frames() || plan.frames.iter().any(|&n| n > 1)
                => "every touch is one frame", "touches.frames of 2 or more beside it, or no such key"];
        /// Axis: kind of classifier, such as `linear_svm`, or a command that trains a classifier, such as `{ command = ["python", "mine.py"] }`.
        classifier: Axis<ClassifierChoice> => Any, Choice, Table, scale: Words, names: ClassifierKind::NAMES;
        /// Strategy that combines binary SVMs into a multi-class classifier: `one_vs_one` (default) or `one_vs_rest`.
        multiclass: Multiclass = Multiclass::default() => Any, Choice, Axes, acts: OF_CLASSIFIER;
        /// Weights of the objects in the training of SVMs, logistic regressions and random forests: `uniform` (default), or `balanced`, as in scikit-learn: the
        /// weight of an object is inverse to its number of training rows.
        #[serde(skip_serializing_if = "is_default")]
        class_weight: ClassWeight = ClassWeight::default() => Any, Choice, Axes, acts: OF_CLASSIFIER;
        /// Solver that trains SVMs: `smo` (default) or `coordinate_descent`.
        solver: SvmSolver = SvmSolver::default() => Any, Choice, Axes, acts: OF_CLASSIFIER;
        /// Scaling of the features, fitted to training rows: `standard` (default), `overall` or `none`.
        scaling: Scaling = Scaling::default() => Any, Choice, Axes;
        /// Axis: penalty C (positive) of classifiers with a penalty. Default: 1.
        c: Option<Axis<f64>> => PENALTY, Choice, Table, title: "C", scale: Log, names: CHOSEN, gives_way: 4, usual: || DEFAULT_C.into(), acts: OF_CLASSIFIER;
        /// Candidate values of the penalty C; replaces `c`. Each fit chooses one candidate by cross-validation within its training rows.
        c_grid: Option<Vec<f64>> => PENALTY, Choice, Axes, replaces: "c", acts: OF_CLASSIFIER;
        /// Candidate values of the kernel parameter γ, as multiples of its default; replaces `gamma`. The default is 1 / (F · m · variance), where F · m is the
        /// number of features of a touch. Each fit chooses one candidate together with C.
        gamma_grid: Option<Vec<f64>> => GAMMA, Choice, Axes, replaces: "gamma", acts: OF_CLASSIFIER;
        /// Number of folds of the inner cross-validation, which selects C and γ and estimates decisions on unseen touches for `most_informative`. Default: 5. Folds
        /// do not divide groups that the split does not divide.
        cv_folds: Option<usize> => Count(2, MAX_COUNTED), Choice, Axes, usual: || DEFAULT_CV_FOLDS.into(),
            acts: acts![Plan: |plan| plan.spec.recognition.is_open() || plan.spec.recognition.is_informed()
                => "nothing is chosen by folds", "c_grid, gamma_grid or next_touch = \"most_informative\" beside it"];
        /// Maximum number of training touches per object that are used to choose C and γ. Default: all. The default γ is computed from all training touches.
        cv_touches: Option<usize> => COUNT, Choice, Axes,
            acts: acts![Plan: |plan| plan.spec.recognition.is_open() => "nothing is chosen by folds", "c_grid or gamma_grid beside it, or no such key"];
        /// Number of readings of each training touch; each reading has its own noise. Default: 1. Without noise, drift or pink noise, all readings of a touch are
        /// equal, and one is used. C and γ are chosen on the first readings.
        readings_per_touch: Option<usize> => Count(1, MAX_READINGS), Choice, Axes, usual: || 1.into(),
            acts: acts![Plan: |plan| plan.conditions().iter().any(Condition::is_random_by_reading)
                => "all readings of a touch are equal", "a signal.noise_std_full_scale above 0, drift or pink noise beside it"];
        /// Keys that [classifiers declare](crate::learning::classifiers::parameters): `degree`, `n_trees` and others.
        #[serde(flatten)]
        of_kinds: ClassifierParameters;
        /// Parameters of your own classifiers and features: for the name of each, a table of values that replace its own, such as `parameters.svc.C = 10.0`.
        /// Default: their own values.
        #[serde(skip_serializing_if = "BTreeMap::is_empty")]
        parameters: BTreeMap<String, toml::Table> = BTreeMap::new() => Unchecked, Choice, Axes;
        /// Maximum size of the kernel values that an SVM solver keeps in memory, GiB. Default: 2. Above the limit, values are recomputed; this takes longer and may
        /// change the last digits.
        solver_memory_gib: Option<f64> => Positive, Choice, Axes, usual: || (DEFAULT_MEMORY_BYTES as f64 / GIB).into(), acts: OF_CLASSIFIER;
        /// Axis: maximum number of training touches per object, at least 1. Default: all touches of the training split.
        train_touches: Option<Axis<usize>> => COUNT, Choice, Table, title: "training touches", scale: Log, gives_way: 5;
        /// Axis: fraction of each object's training touches that are labelled as a randomly drawn other object, 0 to 1. Default: 0.
        mislabelled_fraction: Option<Axis<f64>> => Fraction, Condition, Table, title: "mislabelled", unit: "%", scale: Share, gives_way: 6, usual: || 0.0.into();
        /// Axis: number of training touches of the most frequent object, divided by the number of the least frequent object, at least 1. The numbers of all objects
        /// form a geometric sequence, in an order drawn for each trial. The numbers of test touches are unchanged. Default: 1.
        class_imbalance: Option<Axis<f64>> => AtLeastOne, Condition, Table, unit: ":1", scale: Log, gives_way: 7, usual: || 1.0.into();
        /// Axis: number k of test touches of an object that are combined into one decision, at least 1. The scores of the combined touches are added. An object's
        /// test touches are grouped at random; a remainder of fewer than k touches is omitted. Default: 1.
        touches_per_decision: Axis<usize> = Axis::One(1) => COUNT, Choice, Table, scale: Log, gives_way: 8;
        /// Axis: rule that chooses the touches of a decision after the first touch. Values: `random` (default), `farthest` (the pose farthest from the previous
        /// ones), or `most_informative` (the pose with the lowest expected entropy of the belief over objects). All test touches of the object are candidates, each
        /// at most once per decision.
        next_touch: Option<Axis<NextTouch>> => Any, Choice, Table, scale: Words, usual: || "random".into(),
            acts: acts![Plan: |plan| plan.spec.recognition.touches_per_decision.values().iter().any(|&k| k > 1)
                => "one touch has no next", "a recognition.touches_per_decision of 2 or more beside it, or \"random\""];
        /// Rule that selects the test touches: `random` (default), or a rule by pose.
        #[serde(skip_serializing_if = "is_default")]
        split: PoseSplit = PoseSplit::default() => Any, Condition, Axes, title: "poses held out";
        /// Fraction of the touches that a random split holds out for testing, between 0 and 1. Default: 0.25.
        test_fraction: Option<f64> => Part, Condition, Axes, usual: || DEFAULT_TEST_FRACTION.into(), acts: acts![
            RecordedSpec: |recorded| !recorded.has_test_set() => "", OF_TEST_SET;
            RecordedSpec: |recorded| recorded.splits.is_none() => "", OF_RECORDED_SPLITS;
            Plan: |plan| !plan.spec.splits_by_pose() => "the split says what is held out", "no such key, or split = \"random\"";
        ];
        /// Number k of folds if the split into training and test touches is a k-fold split, at least 2; replaces `test_fraction`.
        folds: Option<usize> => Count(2, MAX_COUNTED), Condition, Axes, replaces: "test_fraction", acts: acts![
            RecordedSpec: |recorded| !recorded.has_test_set() => "", OF_TEST_SET;
            RecordedSpec: |recorded| recorded.splits.is_none() => "", OF_RECORDED_SPLITS;
            StudySpec: |spec| !spec.splits_by_pose() => "", OF_SPLIT;
        ];
        /// Property (`pose`, `offset`, `yaw`, `tilt`, `rest` or `depth`) that defines groups of touches. A group is never divided between training and test. If the
        /// values are drawn (`{ uniform = … }`), touches of an object that are connected by a chain of neighbours form a group. Neighbours differ by less than
        /// `group_by_mm` and `group_by_deg` on each drawn axis. Default: no groups.
        group_by: Option<GroupSpec> => Any, Condition, Axes, title: "group held out", acts: acts![
            RecordedSpec: |_recorded| false => "", "no such key: recorded.groups says what stays together";
            HumanTouchSpec: |_human| false => "", "no such key: human touches have no groups";
            StudySpec: |spec| !spec.splits_by_pose() => "", OF_SPLIT;
        ];
        /// Distance below which two drawn offsets or depths are neighbours, mm, positive; used with `group_by`.
        group_by_mm: Option<f64> => Positive, Condition, Axes,
            acts: acts![Plan: |plan| plan.draws_groups(&[TouchAxis::OffsetX, TouchAxis::OffsetY, TouchAxis::Depth])
                => "no offset or depth that defines the groups is drawn", DRAWN];
        /// Angle below which two drawn yaws or tilts are neighbours, degrees, positive; used with `group_by`.
        group_by_deg: Option<f64> => Positive, Condition, Axes,
            acts: acts![Plan: |plan| plan.draws_groups(&[TouchAxis::Yaw, TouchAxis::TiltX, TouchAxis::TiltY])
                => "no angle that defines the groups is drawn", DRAWN];
    }
}

params! {
    /// Keys of `[report]`: contents of the page and of some tables.
    #[derive(Default)]
    pub struct ReportSpec {
        /// Names of the objects whose touches the sample picture shows. Default: four, spread over the list of objects.
        samples: Option<Vec<String>> => Any, Note, Never;
        /// Whether the report contains charts of accuracy against time with the Pareto front. Default: true if the study has at least three classifiers.
        pareto: Option<bool> => Any, Note, Never;
        /// Configurations whose confusion matrix is written to `confusion.csv`: `all` (default) or `best`.
        #[serde(skip_serializing_if = "is_default")]
        confusion: ConfusionMatrices = ConfusionMatrices::default() => Any, Note, Never;
        /// Whether `predictions.csv` lists every decision of every configuration and trial, with a score for each class. Default: false.
        #[serde(skip_serializing_if = "is_default")]
        predictions: bool = false => Any, Note, Never;
        /// Further measures of recognition: columns `balanced_accuracy` and `log_loss` of `accuracy.csv` and `summary.csv`, and the table `recall.csv`. Default:
        /// none.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        metrics: Vec<Metric> = Vec::new() => Any, Note, Never;
        /// Published accuracies with which the study is compared. Each published accuracy is compared with the most accurate configuration to which its claim
        /// applies.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        published: Vec<PublishedSpec> = Vec::new() => Unchecked, Note, Never;
    }
}

words! {
    /// Measure of recognition beside accuracy and macro-F1.
    pub enum Metric {
        /// Mean over objects of the fraction of the object's decisions that are correct.
        BalancedAccuracy = "balanced_accuracy",
        /// Mean negative natural logarithm of the probability of the touched object; only for classifiers with probabilities.
        LogLoss = "log_loss",
        /// Fraction of the decisions on each object that are correct.
        Recall = "recall",
    }
}

words! {
    /// Selection of the configurations whose confusion matrices are written to `confusion.csv`.
    pub enum ConfusionMatrices = All {
        /// Confusion matrices of all configurations of the study.
        All = "all",
        /// Confusion matrices of the most accurate configuration and of the configurations in `confused.csv`. With many objects, confusion matrices take most of
        /// the space of a result folder.
        Best = "best",
    }
}

/// Published accuracy, such as `{ claim = "98 % at 64:1", accuracy = 0.98, source = "[CL]", ratio = 64.0, ensemble = "sbhe" }`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PublishedSpec {
    /// Published claim as text, such as `98 % at 64:1`.
    pub claim: String,
    /// Published fraction of correctly recognised test touches, 0 to 1.
    pub accuracy: f64,
    /// Publication that contains the claim.
    pub source: String,
    /// Further keys that select the configurations to compare with the claim. Each key is the name of a column of [`Configuration`] with its value (`noise` is
    /// short for `noise_std`).
    #[serde(flatten)]
    pub at: toml::Table,
}

impl Described for PublishedSpec {
    fn schema() -> Value {
        json!({
            "type": "object",
            "description": "Published accuracy, such as `{ claim = \"98 % at 64:1\", accuracy = 0.98, source = \"[CL]\", ratio = 64.0, ensemble = \"sbhe\" }`. \
                            Further keys are columns with their values, which select the configurations to compare with the claim.",
            "properties": {
                "claim": { "type": "string", "description": "Published claim as text, such as `98 % at 64:1`." },
                "accuracy": { "type": "number", "description": "Published fraction of correctly recognised test touches, 0 to 1." },
                "source": { "type": "string", "description": "Publication that contains the claim." },
            },
            "required": ["claim", "accuracy", "source"],
            ORDER: ["claim", "accuracy", "source"],
            "additionalProperties": true,
        })
    }
}

named!(
    Ensemble,
    Selection,
    Multiclass,
    ClassWeight,
    SvmSolver,
    Scaling
);

impl StudySpec {
    /// Parses a study from the text of its file.
    ///
    /// # Errors
    /// If the text is not a valid study. The error names the file, the line and the key.
    pub fn parse(place: &str, text: &str) -> Result<Self> {
        let (spec, mut axes) = axes::read::<Self>(place, text, recognition_keys())?;
        for axis in &mut axes.axes {
            axis.has_column |= Configuration::shows(&axis.key);
        }
        let has_trials = text
            .parse::<toml::Table>()
            .is_ok_and(|table| table.contains_key("trials"));
        let trials = match spec.recognition.folds {
            Some(folds) if !has_trials => folds,
            _ => spec.trials,
        };
        Ok(Self {
            axes,
            trials,
            ..spec
        })
    }

    /// Returns whether the study places objects and presses an array on them.
    pub fn places_objects(&self) -> bool {
        self.human_touch.is_none() && self.recorded.is_none()
    }

    /// Returns whether the keys of `[skin]` set the numbers of rows and columns. Without a layout, these are the numbers of the recorded frames.
    pub(super) fn sets_taxels(&self) -> bool {
        self.recorded.is_none() || self.skin.layout.unwrap_or_default() != ArrayLayout::Grid
    }

    pub(crate) fn is_curved(&self) -> bool {
        self.skin.layout.unwrap_or_default().is_curved()
    }

    /// Returns whether the taxels read forces, without a step of the signal chain.
    pub(crate) fn senses_force(&self) -> bool {
        self.skin.sensed.unwrap_or_default() != SensedSpec::Deflection
    }

    /// Returns whether the taxels or a step of the signal chain read forces.
    pub(super) fn reads_force(&self) -> bool {
        self.senses_force() || self.signal.steps.contains(&StepSpec::Force)
    }

    pub(crate) fn reads_shear(&self) -> bool {
        self.skin.sensed == Some(SensedSpec::Shear)
    }

    pub(crate) fn slides(&self) -> bool {
        self.touches.slide_mm.is_some_and(|slide| slide > 0.0)
    }

    /// Returns whether taxels move along the object. On a flat array that is pressed straight on, no taxel does.
    pub(crate) fn rubs(&self) -> bool {
        self.slides() || self.is_curved()
    }

    /// Returns whether readings depend on the speed of the press: of the damper, or of sensor errors of a moving array.
    pub(super) fn depends_on_speed(&self) -> bool {
        let needs_motion =
            |step: &StepSpec| matches!(step, StepSpec::Error(error) if error.about().needs_motion);
        self.skin.damping_n_s_per_m > 0.0 || self.signal.steps.iter().any(needs_motion)
    }

    /// Returns whether a rule by pose selects the test touches.
    pub(crate) fn splits_by_pose(&self) -> bool {
        self.recognition.split != PoseSplit::Random
    }

    /// Returns the product of the numbers of values of all keys that are axes. Keys of the signal are excluded, because they may be combined differently.
    pub(crate) fn n_combinations(&self) -> f64 {
        let table = table_of(self);
        let is_condition = |path: &str| path.starts_with("signal.") && path != "signal.test_sensor";
        let keys = recognition_keys().iter();
        let keys = keys.filter(|key| key.axis == AxisPlace::Table && !is_condition(key.path));
        let lists = keys.filter_map(|key| value_at(&table, key.path)?.as_array());
        lists.map(|values| values.len() as f64).product()
    }

    /// Returns a result-table column for each axis in `[axes]` that does not have a column yet.
    pub fn axis_columns(&self) -> Vec<Column> {
        let of_cells = Configuration::columns();
        let of_trials = TrialScore::columns();
        // Columns of trials that only some studies have.
        let has = |column: &&Column| match &column.name[..] {
            "split" | "projection" => self.projections_per_split.is_some(),
            _ => true,
        };
        let known = of_cells.iter().chain(of_trials.iter().filter(has));
        let known: Vec<&str> = known.map(|column| &column.name[..]).collect();
        self.axes.columns(|name| known.contains(&name))
    }

    /// Returns the study as TOML text that contains all default values.
    pub fn to_toml(&self) -> String {
        axes::to_toml(self, &self.axes)
    }
}
