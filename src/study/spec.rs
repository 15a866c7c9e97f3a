//! A study as it is written: the keys of its TOML file, in the units of its keys.
//!
//! Nothing is checked here beyond names and types; [`Plan`](super::Plan) does that. An axis takes one value or a list.

use super::axis::Axis;
pub use super::spec_scene::*;
use crate::error::{Error, Result};
use crate::recognition::ClassifierKind;
use crate::recognition::features::Features;
use crate::recognition::scaling::Scaling;
use crate::recognition::svm::{Multiclass, Solver};
use crate::sensing::Ensemble;
use serde::{Deserialize, Serialize};

/// The file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudySpec {
    /// What the study asks, in a sentence.
    pub question: String,
    /// What the author expected before it ran.
    #[serde(default)]
    pub expected: String,
    /// Root of all randomness.
    #[serde(default = "default_seed")]
    pub seed: u64,
    /// How often each cell is repeated with a new split, projection and noise.
    #[serde(default = "one")]
    pub trials: usize,
    /// What is touched.
    pub objects: ObjectsSpec,
    /// What touches.
    pub skin: SkinSpec,
    /// How it touches.
    pub touches: TouchesSpec,
    /// What happens to a frame before it is sensed.
    #[serde(default)]
    pub signal: SignalSpec,
    /// How a frame is compressed.
    pub sensing: SensingSpec,
    /// How objects are recognised.
    pub recognition: RecognitionSpec,
    /// What the report shows.
    #[serde(default)]
    pub report: ReportSpec,
}

/// `[signal]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SignalSpec {
    /// What is done to a frame of deflections, in this order; each step at most once.
    pub steps: Vec<StepSpec>,
    /// Axis: noise standard deviation as a fraction of the full scale.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise_std_full_scale: Option<Axis<f64>>,
    /// Axis, instead: the same in millimetres (of deflection).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise_std_mm: Option<Axis<f64>>,
    /// Axis, instead: the same in newtons (of force).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise_std_n: Option<Axis<f64>>,
    /// Axis: standard deviation of the Gaussian that smooths, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smoothing_mm: Option<Axis<f64>>,
    /// Axis: width of the loop between loading and unloading, as a fraction of the full scale, 0 to 0.25. Each touch comes
    /// after another of the study, drawn at random and let go: what a taxel remembers of it depends on how deep it was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hysteresis_full_scale: Option<Axis<f64>>,
    /// Axis: fraction of a taxel's value that leaks to its four neighbours, 0 to 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crosstalk: Option<Axis<f64>>,
    /// Axis: standard deviation of the taxels' gains, whose mean is 1. Training and test touches share a skin, whose gains,
    /// drift and faults follow from the seed and the array.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gain_std: Option<Axis<f64>>,
    /// Axis: standard deviation of the taxels' zeros at the end of the session, as a fraction of the full scale. A session is
    /// the study's touches in random order, trial by trial; it begins with every zero at zero.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drift_std_full_scale: Option<Axis<f64>>,
    /// Axis: fraction of the taxels that read 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dead_fraction: Option<Axis<f64>>,
    /// Axis: fraction of the taxels that read one level whatever they feel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stuck_fraction: Option<Axis<f64>>,
    /// Axis: time to read the array, taxel after taxel, while the press goes on at `touches.speed_mm_per_s`, ms. The last frame
    /// of a touch is read at rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scan_time_ms: Option<Axis<f64>>,
    /// Axis: bits of the converter, which clips to the full scale and rounds; 0 for none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub adc_bits: Option<Axis<f64>>,
    /// How the axes of this table are combined with each other. (With those of other tables they always are.)
    #[serde(skip_serializing_if = "CombineSpec::is_default")]
    pub combine: CombineSpec,
}

/// How axes are combined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CombineSpec {
    /// All combinations of their values.
    #[default]
    All,
    /// The first values of all axes, and from there each axis alone through its other values.
    OneAtATime,
}

/// A step of the signal stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StepSpec {
    /// Deflection → force, newtons.
    Force,
    /// Additive zero-mean Gaussian noise.
    Noise,
    /// Gaussian smoothing over the array.
    Smoothing,
    /// Loading and unloading read differently.
    Hysteresis,
    /// Values leak to the neighbours.
    Crosstalk,
    /// Each taxel has its own gain.
    Gain,
    /// Each taxel's zero wanders.
    Drift,
    /// Some taxels are dead or stuck.
    Faults,
    /// Taxels are read one after another.
    Scan,
    /// A converter clips and rounds.
    Quantisation,
}

/// `[sensing]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensingSpec {
    /// Axis: how measurements are made.
    #[serde(default = "default_ensemble")]
    pub ensemble: Axis<Ensemble>,
    /// Axis: compression ratio, taxels per measurement.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ratio: Option<Axis<f64>>,
    /// Axis, instead of `ratio`: measurements a touch.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measurements: Option<Axis<usize>>,
}

/// `[recognition]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecognitionSpec {
    /// Axis: what is made of a touch's measurements before they are scaled. (Features of force: `"force"` among
    /// `signal.steps`.)
    #[serde(default = "default_features")]
    pub features: Axis<Features>,
    /// Axis: which classifier.
    pub classifier: Axis<ClassifierKind>,
    /// How two-class SVMs make a many-class one.
    #[serde(default)]
    pub multiclass: Multiclass,
    /// What trains an SVM.
    #[serde(default)]
    pub solver: Solver,
    /// How features are scaled, fitted on training rows.
    #[serde(default)]
    pub scaling: Scaling,
    /// Axis: soft-margin penalty of the classifiers that have one; 1 when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub c: Option<Axis<f64>>,
    /// Instead of `c`: candidates of which each fit chooses one by cross-validation within its training rows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub choose_c: Option<Vec<f64>>,
    /// γ of the RBF and polynomial kernels; 1 / (F · m · variance), 'scale', when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gamma: Option<f64>,
    /// Instead of `gamma`: candidates as multiples of 'scale', of which each fit chooses one together with C.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub choose_gamma: Option<Vec<f64>>,
    /// Folds of the cross-validation that chooses C and γ; 5 when left out. What the split keeps together, they do.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub choose_folds: Option<usize>,
    /// Training touches an object that take part in that choice, at most; all when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub choose_touches: Option<usize>,
    /// d of the polynomial kernel.
    #[serde(default = "default_degree")]
    pub degree: u32,
    /// c₀ of the polynomial kernel.
    #[serde(default = "default_coef0")]
    pub coef0: f64,
    /// k of the k nearest neighbours; 5 when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub n_neighbours: Option<usize>,
    /// Trees of a random forest; 100 when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub n_trees: Option<usize>,
    /// Splits below each other in a tree or in a forest's trees; until leaves are pure when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_depth: Option<usize>,
    /// Axis: training touches an object, at most; all of the training split when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub train_touches: Option<Axis<usize>>,
    /// Axis: k, test touches of an object that are decided on together by the sum of their scores. An object's test touches
    /// are grouped at random; fewer than k that remain are left out.
    #[serde(default = "one_value")]
    pub fused_touches: Axis<usize>,
    /// Fraction of the touches held out for testing (without `folds`; 0.25 when both are left out).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub test_fraction: Option<f64>,
    /// Instead of `test_fraction`: k of a k-fold split; `trials` is then a multiple of k.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub folds: Option<usize>,
    /// Touches that share this are never on both sides of the split.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub keep_together: Option<GroupSpec>,
}

/// `[report]`
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReportSpec {
    /// Objects whose touches are drawn side by side; four spread over the list when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub samples: Option<Vec<String>>,
    /// Whether to chart accuracy against time with its Pareto front; when left out, if at least three classifiers are swept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pareto: Option<bool>,
    /// Accuracies that others published, shown beside the best of the cells that each is about.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub published: Vec<PublishedSpec>,
}

/// `{ claim = "98 % at 64:1", accuracy = 0.98, source = "[CL]", ratio = 64.0, ensemble = "sbhe" }`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PublishedSpec {
    /// What was claimed, in words.
    pub claim: String,
    /// The published share of test touches recognised, 0 to 1.
    pub accuracy: f64,
    /// Where it was published.
    pub source: String,
    /// Every other key narrows the cells that it is compared with: the name of a column of [`Cell`](super::table::Cell)
    /// (`noise` is short for `noise_std`) and its value there.
    #[serde(flatten)]
    pub at: toml::Table,
}

/// What groups touches for a split that keeps groups together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GroupSpec {
    /// Rest pose, offset, yaw and tilt: everything but the depth.
    Pose,
    /// Both offsets.
    Offset,
    /// The yaw.
    Yaw,
    /// Both tilts.
    Tilt,
    /// The stable pose.
    Rest,
    /// The depth.
    Depth,
}

impl StudySpec {
    /// Reads a study; the error names the file, the line and the key.
    pub fn parse(place: &str, text: &str) -> Result<Self> {
        toml::from_str(text).map_err(|error| Error::toml(place, text, &error))
    }

    /// Writes the study with every default spelt out.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).expect("every field of a study has a TOML form")
    }
}

impl CombineSpec {
    fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

impl StepSpec {
    /// The step's name in a study.
    pub fn word(self) -> &'static str {
        match self {
            Self::Force => "force",
            Self::Noise => "noise",
            Self::Smoothing => "smoothing",
            Self::Hysteresis => "hysteresis",
            Self::Crosstalk => "crosstalk",
            Self::Gain => "gain",
            Self::Drift => "drift",
            Self::Faults => "faults",
            Self::Scan => "scan",
            Self::Quantisation => "quantisation",
        }
    }

    /// Whether it is something that real skins do to a signal, with a strength of its own key.
    pub fn is_imperfection(self) -> bool {
        !matches!(self, Self::Force | Self::Noise | Self::Smoothing)
    }
}

impl Default for SignalSpec {
    fn default() -> Self {
        Self {
            steps: vec![StepSpec::Noise, StepSpec::Smoothing],
            noise_std_full_scale: None,
            noise_std_mm: None,
            noise_std_n: None,
            smoothing_mm: None,
            hysteresis_full_scale: None,
            crosstalk: None,
            gain_std: None,
            drift_std_full_scale: None,
            dead_fraction: None,
            stuck_fraction: None,
            scan_time_ms: None,
            adc_bits: None,
            combine: CombineSpec::default(),
        }
    }
}

/// The seed of every kind of study that names none.
pub(crate) fn default_seed() -> u64 {
    2018
}

fn one() -> usize {
    1
}

/// An axis of the number one.
pub(super) fn one_value() -> Axis<usize> {
    Axis::One(1)
}

fn default_features() -> Axis<Features> {
    Axis::One(Features::Raw)
}

fn default_ensemble() -> Axis<Ensemble> {
    Axis::One(Ensemble::Gaussian)
}

fn default_degree() -> u32 {
    3
}

fn default_coef0() -> f64 {
    1.0
}
