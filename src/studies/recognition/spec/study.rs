//! Specification of a recognition study: the keys of its TOML file, in the units of the file.
//!
//! The specification checks only names and types; the plan of the study checks values. A key that is an axis has one value or a
//! list of values.

use crate::engine::axes;
use crate::engine::axes::StudyAxes;
use crate::engine::axis::{Axis, one_value};
use crate::error::Result;
use crate::inputs::defaults::{count, is_default};
use crate::inputs::keys::AxisPlace;
use crate::inputs::objects_spec::ObjectsSpec;
use crate::inputs::schema_types::Names;
use crate::inputs::toml_value::value_at;
use crate::learning::data::temporal_features::TemporalFeatures;
use crate::learning::evaluation::next_touch::NextTouch;
use crate::sensing::{Ensemble, Selection};
use crate::studies::recognition::rows::configuration::Configuration;
use crate::studies::recognition::rows::table_rows::TrialScore;
use crate::studies::recognition::spec::classifier_parameters::{
    ClassifierParameters, OtherKeys, with_parameters,
};
pub use crate::studies::recognition::spec::foreign::*;
pub use crate::studies::recognition::spec::human::*;
use crate::studies::recognition::spec::keys::recognition_keys;
use crate::studies::recognition::spec::pose_split::GroupSpec;
pub use crate::studies::recognition::spec::pose_split::PoseSplit;
pub use crate::studies::recognition::spec::recorded::*;
pub use crate::studies::recognition::spec::recorded_sensor::RecordedSensorSpec;
pub use crate::studies::recognition::spec::scene::*;
pub use crate::studies::recognition::spec::signal::*;
pub use crate::studies::recognition::spec::zero::ZeroSpec;
use crate::table::{Column, Columns};
use bubbletouch_sim::features::Features;
use bubbletouch_svm::class_weight::ClassWeight;
use bubbletouch_svm::scaling::Scaling;
use bubbletouch_svm::{Multiclass, Solver};
use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;

/// Contents of a recognition study file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StudySpec {
    /// Question that the study answers, in one sentence.
    pub question: String,
    /// Answer that the author expected before the first run. Default: empty.
    #[serde(default)]
    pub expected: String,
    /// Seed of all random numbers. Default: 2018.
    #[serde(default = "default_seed")]
    pub seed: u64,
    /// Number of trials per configuration, at least 1, each with a new split, projection and noise. Default: `recognition.folds`, or 1 without folds.
    #[serde(default = "count::<1>")]
    pub trials: usize,
    /// Number P of projections (measurement matrices) per split; the study has `trials` / P splits, each combined with P projections. Default: one projection
    /// per trial. With several projections, `variance.csv` separates the effect of the projection on the accuracy from the effect of the split.
    pub projections_per_split: Option<usize>,
    /// Table `[objects]`: the touched objects.
    #[serde(default, skip_serializing_if = "is_default")]
    pub objects: ObjectsSpec,
    /// Table `[skin]`: the arrays of taxels.
    pub skin: SkinSpec,
    /// Table `[touches]`: poses and depths of the touches.
    #[serde(default, skip_serializing_if = "is_default")]
    pub touches: TouchesSpec,
    /// Table `[human_touch]`: recognition of kinds of human touch, such as a stroke. Replaces `[objects]` and `[touches]`.
    pub human_touch: Option<HumanTouchSpec>,
    /// Table `[recorded]`: frames that a real skin recorded. Replaces `[objects]` and `[touches]`.
    pub recorded: Option<RecordedSpec>,
    /// Table `[signal]`: noise, sensor errors and processing of frames before compression.
    #[serde(default)]
    pub signal: SignalSpec,
    /// Table `[sensing]`: compression of frames into measurements. Default: `ensemble = "identity"`, which measures all taxels without compression.
    #[serde(default)]
    pub sensing: SensingSpec,
    /// Table `[recognition]`: features, classifiers, and the split into training and test touches.
    pub recognition: RecognitionSpec,
    /// Table `[test]`: keys of `[objects]`, `[skin]`, `[touches]` and `[signal]` whose values differ for test touches, such as `test.touches.depth_mm`.
    #[serde(default, skip_serializing_if = "toml::Table::is_empty")]
    #[schemars(with = "serde_json::Map<String, serde_json::Value>")]
    pub test: toml::Table,
    /// Table `[report]`: contents of the page and of some tables.
    #[serde(default)]
    pub report: ReportSpec,
    /// Table `[axes]`: further axes, each consisting of a key and a list of its values.
    #[serde(skip)]
    pub axes: StudyAxes,
}

/// Keys of `[sensing]`: compression of frames into measurements.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SensingSpec {
    /// Axis: ensemble from which the measurement matrix is drawn. Default: `gaussian`.
    #[serde(default = "default_ensemble")]
    #[schemars(with = "Axis<Names<Ensemble>>")]
    pub ensemble: Axis<Ensemble>,
    /// Axis: compression ratio n / m, at least 1: number n of taxels divided by the number m of measurements.
    pub ratio: Option<Axis<f64>>,
    /// Axis: number m of measurements per frame, at least 1. Replaces `ratio`.
    pub measurements: Option<Axis<usize>>,
    /// Axis: method by which the ensemble `selected` selects the m taxels to read, from training touches only. Values: `greedy` (default; highest
    /// validation accuracy of a nearest-neighbour classifier), `pivoted_qr` (pivots of m principal components; m is below the number of training frames)
    /// or `random` (a control). At most 4,096 frames of the training touches are used.
    #[schemars(with = "Option<Axis<Names<Selection>>>")]
    pub selection: Option<Axis<Selection>>,
    /// Number of measurements that the skin reads out per second. Adds the column `readout_ms`, the time to read a frame. Default: no such column.
    pub readings_per_s: Option<f64>,
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

/// Keys of `[recognition]`: features, classifiers, and the split into training and test touches.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, remote = "Self")]
#[schemars(transform = with_parameters)]
pub struct RecognitionSpec {
    /// Axis: features of a touch, before scaling. Default: `raw`. Transformations of the measurements: `raw`, `centred`, `unit_norm`, `centred_unit_norm`.
    /// Features of images: `fourier_magnitude`, `fourier_mellin`, `polar_harmonics`, `descriptors`, `aligned`, or several of these joined by `+`. For features
    /// of force, add `"force"` to `signal.steps`.
    #[serde(default = "default_features")]
    pub features: Axis<FeatureChoice>,
    /// Axis: depth window of the image features, as a fraction of the full scale. Image features use only deflections within this window below the largest
    /// deflection of a frame. They therefore do not depend on the press depth. Default: the whole image.
    pub depth_window_full_scale: Option<Axis<f64>>,
    /// Axis: number of additional copies of each training touch, whose images are randomly tilted. The copies make recognition robust to tilts that do not
    /// occur in training. Copies require image features. Default: 0.
    pub tilt_augmentation: Option<Axis<usize>>,
    /// Maximum tilt of a copy about the array's x and y axes, degrees; the tilts are uniformly distributed. Default: 5.
    pub tilt_augmentation_deg: Option<f64>,
    /// Axis: method that combines the frames of a touch into features. Values: `deepest` (deepest frame), `stacked_8` (8 or another number of evenly spaced
    /// frames), `moments` (of each measurement), `course` (of the touch) or `summarised` (moments and course). Default: all frames are concatenated.
    pub temporal_features: Option<Axis<TemporalFeatures>>,
    /// Axis: kind of classifier, such as `linear_svm`, or a command that trains a classifier, such as `{ command = ["python", "mine.py"] }`.
    pub classifier: Axis<ClassifierChoice>,
    /// Strategy that combines binary SVMs into a multi-class classifier: `one_vs_one` (default) or `one_vs_rest`.
    #[serde(default)]
    #[schemars(with = "Names<Multiclass>")]
    pub multiclass: Multiclass,
    /// Weights of the objects in the training of SVMs, logistic regressions and random forests: `uniform` (default), or `balanced`, as in scikit-learn: the
    /// weight of an object is inverse to its number of training rows.
    #[serde(default, skip_serializing_if = "is_default")]
    #[schemars(with = "Names<ClassWeight>")]
    pub class_weight: ClassWeight,
    /// Solver that trains SVMs: `smo` (default) or `coordinate_descent`.
    #[serde(default)]
    #[schemars(with = "Names<Solver>")]
    pub solver: Solver,
    /// Scaling of the features, fitted to training rows: `standard` (default), `overall` or `none`.
    #[serde(default)]
    #[schemars(with = "Names<Scaling>")]
    pub scaling: Scaling,
    /// Axis: penalty C (positive) of classifiers with a penalty. Default: 1.
    pub c: Option<Axis<f64>>,
    /// Candidate values of the penalty C; replaces `c`. Each fit chooses one candidate by cross-validation within its training rows.
    pub c_grid: Option<Vec<f64>>,
    /// Candidate values of the kernel parameter γ, as multiples of its default; replaces `gamma`. The default is 1 / (F · m · variance), where F · m is the
    /// number of features of a touch. For the Laplacian kernel, the standard deviation replaces the variance. Each fit chooses one candidate together with C.
    pub gamma_grid: Option<Vec<f64>>,
    /// Number of folds of the inner cross-validation, which selects C and γ and estimates decisions on unseen touches for `most_informative`. Default: 5. Folds
    /// do not divide groups that the split does not divide.
    pub cv_folds: Option<usize>,
    /// Maximum number of training touches per object that are used to choose C and γ. Default: all. The default γ is computed from all training touches.
    pub cv_touches: Option<usize>,
    /// Number of readings of each training touch; each reading has its own noise. Default: 1. Without noise, drift or pink noise, all readings of a touch are
    /// equal, and one is used. C and γ are chosen on the first readings.
    pub readings_per_touch: Option<usize>,
    /// Keys that [classifiers declare](crate::learning::classifiers::parameters): `degree`, `n_trees` and others.
    #[serde(flatten, skip_deserializing)]
    #[schemars(skip)]
    pub parameters: ClassifierParameters,
    /// Maximum size of the kernel values that an SVM solver keeps in memory, GiB. Default: 2. Above the limit, values are recomputed; this takes longer and may
    /// change the last digits.
    pub solver_memory_gib: Option<f64>,
    /// Axis: maximum number of training touches per object, at least 1. Default: all touches of the training split.
    pub train_touches: Option<Axis<usize>>,
    /// Axis: fraction of each object's training touches that are labelled as a randomly drawn other object, 0 to 1. Default: 0.
    pub mislabelled_fraction: Option<Axis<f64>>,
    /// Axis: number of training touches of the most frequent object, divided by the number of the least frequent object, at least 1. The numbers of all objects
    /// form a geometric sequence, in an order drawn for each trial. The numbers of test touches are unchanged. Default: 1.
    pub class_imbalance: Option<Axis<f64>>,
    /// Axis: number k of test touches of an object that are combined into one decision, at least 1. The scores of the combined touches are added. An object's
    /// test touches are grouped at random; a remainder of fewer than k touches is omitted. Default: 1.
    #[serde(default = "one_value")]
    pub touches_per_decision: Axis<usize>,
    /// Axis: rule that chooses the touches of a decision after the first touch. Values: `random` (default), `farthest` (the pose farthest from the previous
    /// ones), or `most_informative` (the pose with the lowest expected entropy of the belief over objects). All test touches of the object are candidates, each
    /// at most once per decision.
    pub next_touch: Option<Axis<NextTouch>>,
    /// Rule that selects the test touches: `random` (default), or a rule by pose.
    #[serde(default, skip_serializing_if = "is_default")]
    pub split: PoseSplit,
    /// Fraction of the touches that a random split holds out for testing, between 0 and 1. Default: 0.25.
    pub test_fraction: Option<f64>,
    /// Number k of folds if the split into training and test touches is a k-fold split, at least 2; replaces `test_fraction`.
    pub folds: Option<usize>,
    /// Property (`pose`, `offset`, `yaw`, `tilt`, `rest` or `depth`) that defines groups of touches. A group is never divided between training and test. If the
    /// values are drawn (`{ uniform = … }`), touches of an object that are connected by a chain of neighbours form a group. Neighbours differ by less than
    /// `group_by_mm` and `group_by_deg` on each drawn axis. Default: no groups.
    pub group_by: Option<GroupSpec>,
    /// Distance below which two drawn offsets or depths are neighbours, mm, positive; used with `group_by`.
    pub group_by_mm: Option<f64>,
    /// Angle below which two drawn yaws or tilts are neighbours, degrees, positive; used with `group_by`.
    pub group_by_deg: Option<f64>,
}

/// Keys of `[report]`: contents of the page and of some tables.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReportSpec {
    /// Names of the objects whose touches the sample picture shows. Default: four, spread over the list of objects.
    pub samples: Option<Vec<String>>,
    /// Whether the report contains charts of accuracy against time with the Pareto front. Default: true if the study has at least three classifiers.
    pub pareto: Option<bool>,
    /// Configurations whose confusion matrix is written to `confusion.csv`: `all` (default) or `best`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub confusion: ConfusionMatrices,
    /// Whether `predictions.csv` lists every decision of every configuration and trial, with a score for each class. Default: false.
    #[serde(default, skip_serializing_if = "is_default")]
    pub predictions: bool,
    /// Further measures of recognition: columns `balanced_accuracy` and `log_loss` of `accuracy.csv` and `summary.csv`, and the table `recall.csv`. Default:
    /// none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub metrics: Vec<Metric>,
    /// Published accuracies with which the study is compared. Each published accuracy is compared with the most accurate configuration to which its claim
    /// applies.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub published: Vec<PublishedSpec>,
}

/// Measure of recognition beside accuracy and macro-F1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Metric {
    /// Mean over objects of the fraction of the object's decisions that are correct.
    BalancedAccuracy,
    /// Mean negative natural logarithm of the probability of the touched object; only for classifiers with probabilities.
    LogLoss,
    /// Fraction of the decisions on each object that are correct.
    Recall,
}

/// Selection of the configurations whose confusion matrices are written to `confusion.csv`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ConfusionMatrices {
    /// Confusion matrices of all configurations of the study.
    #[default]
    All,
    /// Confusion matrices of the most accurate configuration and of the configurations in `confused.csv`. With many objects, confusion matrices take most of
    /// the space of a result folder.
    Best,
}

/// Published accuracy, such as `{ claim = "98 % at 64:1", accuracy = 0.98, source = "[CL]", ratio = 64.0, ensemble = "sbhe" }`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
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
    #[schemars(with = "serde_json::Map<String, serde_json::Value>")]
    pub at: toml::Table,
}

impl Serialize for RecognitionSpec {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        // The derived function of the same name, which `remote = "Self"` makes.
        Self::serialize(self, serializer)
    }
}

/// Deserialises the fields by the derived function, and the parameters of classifiers by their declarations.
impl<'de> Deserialize<'de> for RecognitionSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        deserializer.deserialize_map(RecognitionVisitor)
    }
}

struct RecognitionVisitor;

impl<'de> Visitor<'de> for RecognitionVisitor {
    type Value = RecognitionSpec;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("struct RecognitionSpec")
    }

    fn visit_map<M: MapAccess<'de>>(
        self,
        map: M,
    ) -> std::result::Result<RecognitionSpec, M::Error> {
        let mut parameters = ClassifierParameters::default();
        let others = OtherKeys {
            map,
            parameters: &mut parameters,
        };
        let spec = RecognitionSpec::deserialize(MapAccessDeserializer::new(others))?;
        Ok(RecognitionSpec { parameters, ..spec })
    }
}

impl StudySpec {
    /// Parses a study from the text of its file.
    ///
    /// # Errors
    /// If the text is not a valid study. The error names the file, the line and the key.
    pub fn parse(place: &str, text: &str) -> Result<Self> {
        let (spec, axes) = axes::read::<Self>(place, text, recognition_keys())?;
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

    /// Returns the number of values of each key that is an axis. Keys of the signal are excluded, because they may be combined differently.
    pub(crate) fn axis_lengths(&self) -> impl Iterator<Item = (&'static str, usize)> {
        let table = toml::Table::try_from(self).expect("every field of a study has a TOML form");
        let keys = recognition_keys().iter();
        let keys = keys.filter(|key| key.axis == AxisPlace::Table);
        let is_condition = |path: &str| path.starts_with("signal.") && path != "signal.test_sensor";
        let keys = keys.filter(move |key| !is_condition(key.path));
        keys.map(move |key| {
            let values = value_at(&table, key.path).and_then(toml::Value::as_array);
            (key.path, values.map_or(1, Vec::len))
        })
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

/// Returns the default random seed of all kinds of studies.
pub(crate) fn default_seed() -> u64 {
    2018
}

fn default_features() -> Axis<FeatureChoice> {
    Axis::One(FeatureChoice(Features::Raw))
}

fn default_ensemble() -> Axis<Ensemble> {
    Axis::One(Ensemble::Gaussian)
}
