//! A study as it is written: the keys of its TOML file, in the units of its keys.
//!
//! Nothing is checked here beyond names and types; [`Plan`](crate::studies::recognition::plan::study_plan::Plan) does that. An axis takes one value or a list.

use crate::engine::axes;
use crate::engine::axes::{AxisRules, StudyAxes};
use crate::engine::axis::{Axis, one_value};
use crate::error::Result;
use crate::inputs::defaults::{count, is_default, number};
use crate::inputs::objects_spec::ObjectsSpec;
use crate::inputs::toml_value::value_at;
use crate::learning::classifiers::ClassifierKind;
use crate::learning::data::over_time::OverTime;
use crate::learning::evaluation::next_touch::NextTouch;
use crate::sensing::Ensemble;
use crate::studies::recognition::rows::cell::Cell;
use crate::studies::recognition::rows::table_rows::TrialScore;
pub use crate::studies::recognition::spec::human::*;
use crate::studies::recognition::spec::pose_split::GroupSpec;
pub use crate::studies::recognition::spec::pose_split::PoseSplit;
pub use crate::studies::recognition::spec::recorded::*;
pub use crate::studies::recognition::spec::scene::*;
pub use crate::studies::recognition::spec::signal::*;
use crate::table::{Column, Columns};
use bubbletouch_sim::features::Features;
use bubbletouch_svm::scaling::Scaling;
use bubbletouch_svm::{Multiclass, Solver};
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
    #[serde(default = "count::<1>")]
    pub trials: usize,
    /// Instead of a projection of its own for each trial: so many projections, each with each of `trials` / so many splits. It
    /// tells what the projection does to the accuracy from what the split does (`variance.csv`).
    pub projections_per_split: Option<usize>,
    /// What is touched.
    #[serde(default, skip_serializing_if = "is_default")]
    pub objects: ObjectsSpec,
    /// What touches.
    pub skin: SkinSpec,
    /// How it touches.
    #[serde(default, skip_serializing_if = "is_default")]
    pub touches: TouchesSpec,
    /// Instead of objects and how they are touched: which kind of touch is it?
    pub human_touch: Option<HumanTouchSpec>,
    /// Instead of objects and how they are touched: what a skin has read.
    pub recorded: Option<RecordedSpec>,
    /// What happens to a frame before it is sensed.
    #[serde(default)]
    pub signal: SignalSpec,
    /// How a frame is compressed.
    pub sensing: SensingSpec,
    /// How objects are recognised.
    pub recognition: RecognitionSpec,
    /// Keys of `[objects]`, `[skin]`, `[touches]` and `[signal]` that test touches have instead of the study's: `test.touches.depth_mm`.
    #[serde(default, skip_serializing_if = "toml::Table::is_empty")]
    pub test: toml::Table,
    /// What the report shows.
    #[serde(default)]
    pub report: ReportSpec,
    /// Other keys with their values, in all combinations: [`axes`].
    #[serde(skip)]
    pub axes: StudyAxes,
}

/// Keys that are axes where they stand: they take a list there, and are put there from `[axes]`. Of `[signal]` all keys but the steps are axes.
const AXES_IN_PLACE: &[&str] = &[
    "skin.pitch_mm",
    "skin.size_mm",
    "skin.taxels",
    "touches.frames",
    "sensing.ensemble",
    "sensing.ratio",
    "sensing.measurements",
    "recognition.features",
    "recognition.foremost_full_scale",
    "recognition.tilted_copies",
    "recognition.over_time",
    "recognition.classifier",
    "recognition.c",
    "recognition.train_touches",
    "recognition.mislabelled_fraction",
    "recognition.class_imbalance",
    "recognition.fused_touches",
    "recognition.next_touch",
];

/// Trials split the same touches again, and words and reports are of the whole study.
const AXIS_RULES: AxisRules = AxisRules {
    in_place: |key| match key.strip_prefix("signal.") {
        Some(key) => !matches!(key, "steps" | "combine"),
        None => AXES_IN_PLACE.contains(&key),
    },
    refused: &[
        "question",
        "expected",
        "trials",
        "projections_per_split",
        "report",
        "axes",
    ],
};

/// `[sensing]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensingSpec {
    /// Axis: how measurements are made.
    #[serde(default = "default_ensemble")]
    pub ensemble: Axis<Ensemble>,
    /// Axis: compression ratio, taxels per measurement.
    pub ratio: Option<Axis<f64>>,
    /// Axis, instead of `ratio`: measurements a touch.
    pub measurements: Option<Axis<usize>>,
}

/// `[recognition]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecognitionSpec {
    /// Axis: what is made of a touch's measurements before they are scaled: `raw`, `centred`, `unit_norm`, `centred_unit_norm`; or features of
    /// images, `fourier_magnitude`, `fourier_mellin`, `polar_harmonics`, `descriptors`, `aligned`, or several of these joined by `+`. (Features of
    /// force: `"force"` among `signal.steps`.)
    #[serde(default = "default_features")]
    pub features: Axis<Features>,
    /// Axis: features of images see only what is so far behind the foremost point, as a fraction of the full scale, as if each touch were pressed so
    /// deep; all that is there when left out. A depth that was never learned then looks like one that was.
    pub foremost_full_scale: Option<Axis<f64>>,
    /// Axis: so many copies of each training touch are learned, too, tilted at random as far as images say what that looks like: a tilt that was
    /// never learned then looks like one that was. Of features of images alone; none when left out.
    pub tilted_copies: Option<Axis<usize>>,
    /// Most that a copy is tilted about the array's x and y, evenly distributed; 5 when left out.
    pub tilted_copies_deg: Option<f64>,
    /// Axis: what is made of the frames of a touch; all of them one after the other when left out. `deepest` frame, `stacked_8` evenly
    /// in time (or another number), `moments` of each measurement, `course` of the touch, or `summarised`: moments and course.
    pub over_time: Option<Axis<OverTime>>,
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
    pub c: Option<Axis<f64>>,
    /// Instead of `c`: candidates of which each fit chooses one by cross-validation within its training rows.
    pub choose_c: Option<Vec<f64>>,
    /// γ of the RBF, Laplacian and polynomial kernels; 1 / (F · m · variance), 'scale', when left out (Laplacian: the standard deviation).
    pub gamma: Option<f64>,
    /// Instead of `gamma`: candidates as multiples of 'scale', of which each fit chooses one together with C.
    pub choose_gamma: Option<Vec<f64>>,
    /// Folds of the cross-validation that chooses C and γ, or that says how touches which are not learned are answered (`most_informative`); 5 when left
    /// out. What the split keeps together, they do.
    pub choose_folds: Option<usize>,
    /// Training touches an object that take part in that choice, at most; all when left out. γ is that of all training touches.
    pub choose_touches: Option<usize>,
    /// How many times each training touch is read and learned, each time with its own noise; 1 when left out. Without noise,
    /// drift or pink noise all readings of a touch are the same, and it is learned once. C and γ are chosen on first readings.
    pub training_readings: Option<usize>,
    /// d of the polynomial kernel.
    #[serde(default = "default_degree")]
    pub degree: u32,
    /// c₀ of the polynomial kernel.
    #[serde(default = "number::<1>")]
    pub coef0: f64,
    /// k of the k nearest neighbours; 5 when left out.
    pub n_neighbours: Option<usize>,
    /// Trees of a random forest; 100 when left out.
    pub n_trees: Option<usize>,
    /// Splits below each other in a tree or in a forest's trees; until leaves are pure when left out.
    pub max_depth: Option<usize>,
    /// Most gibibytes of kernel values that an SVM's solver holds at once; 2 when left out. Above it values are computed again,
    /// which takes longer and may change last digits.
    pub solver_memory_gib: Option<f64>,
    /// Axis: training touches an object, at most; all of the training split when left out.
    pub train_touches: Option<Axis<usize>>,
    /// Axis: fraction of each object's training touches that are labelled as another object, drawn at random, 0 to 1.
    pub mislabelled_fraction: Option<Axis<f64>>,
    /// Axis: how many times as many training touches the most frequent object has as the rarest, at least 1; the others lie
    /// between by equal ratios, in an order of each trial's own. Test touches stay as many of each.
    pub class_imbalance: Option<Axis<f64>>,
    /// Axis: k, test touches of an object that are decided on together by the sum of their scores. An object's test touches
    /// are grouped at random; fewer than k that remain are left out.
    #[serde(default = "one_value")]
    pub fused_touches: Axis<usize>,
    /// Axis: how the touches after the first are chosen: at `random`; the `farthest` pose from those touched; or the `most_informative` one, of which
    /// the least entropy of the belief in objects is expected. Chosen ones are of all test touches of the object, each once at most among those that are
    /// decided on together.
    pub next_touch: Option<Axis<NextTouch>>,
    /// Which poses are held out: `random` ones, or those that [`PoseSplit`] says.
    #[serde(default, skip_serializing_if = "is_default")]
    pub split: PoseSplit,
    /// Fraction of the touches that a random split holds out for testing (without `folds`; 0.25 when both are left out).
    pub test_fraction: Option<f64>,
    /// Instead of `test_fraction`: k of a k-fold split; `trials` is then a multiple of k.
    pub folds: Option<usize>,
    /// Touches that share this (`pose`, `offset`, `yaw`, `tilt`, `rest` or `depth`) are never on both sides of the split. Where its
    /// values are drawn (`{ uniform = … }`), touches of an object that neighbours connect stay together: those nearer than the next
    /// two keys say, on each drawn axis.
    pub keep_together: Option<GroupSpec>,
    /// Drawn offsets and depths nearer than this are neighbours.
    pub keep_together_mm: Option<f64>,
    /// Drawn yaws and tilts nearer than this are neighbours.
    pub keep_together_deg: Option<f64>,
}

/// `[report]`
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReportSpec {
    /// Objects whose touches are drawn side by side; four spread over the list when left out.
    pub samples: Option<Vec<String>>,
    /// Whether to chart accuracy against time with its Pareto front; when left out, if at least three classifiers are swept.
    pub pareto: Option<bool>,
    /// Configurations whose confusion matrix is in `confusion.csv`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub confusion: ConfusionMatrices,
    /// Accuracies that others published, shown beside the best of the cells that each is about.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub published: Vec<PublishedSpec>,
}

/// `report.confusion`: configurations whose confusion matrix is in `confusion.csv`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ConfusionMatrices {
    /// All configurations.
    #[default]
    All,
    /// The most accurate configuration and those of `confused.csv`. With many objects, the other matrices are most of the bytes of a folder.
    Best,
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
    /// Every other key narrows the cells that it is compared with: the name of a column of [`Cell`]
    /// (`noise` is short for `noise_std`) and its value there.
    #[serde(flatten)]
    pub at: toml::Table,
}

impl StudySpec {
    /// Reads a study.
    ///
    /// # Errors
    /// The error names the file, the line and the key.
    pub fn parse(place: &str, text: &str) -> Result<Self> {
        let (spec, axes) = axes::read::<Self>(place, text, AXIS_RULES)?;
        Ok(Self { axes, ..spec })
    }

    /// Whether it touches objects that it places.
    pub fn places_objects(&self) -> bool {
        self.human_touch.is_none() && self.recorded.is_none()
    }

    /// How many values each key has that is an axis where it stands, but for those of the signal, which may be combined in another way.
    pub(crate) fn axis_lengths(&self) -> impl Iterator<Item = (&'static str, usize)> {
        // A seed of the command line may be larger than TOML's numbers.
        let without_seed = Self {
            seed: 0,
            ..self.clone()
        };
        let table = toml::Table::try_from(without_seed);
        let table = table.expect("every other field of a study has a TOML form");
        let keys = AXES_IN_PLACE.iter();
        keys.chain(&["signal.tested_on"]).map(move |key| {
            let values = value_at(&table, key).and_then(toml::Value::as_array);
            (*key, values.map_or(1, Vec::len))
        })
    }

    /// The columns of its own axes in tables of results.
    pub fn axis_columns(&self) -> Vec<Column> {
        let of_cells = Cell::columns();
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

    /// Writes the study with every default spelt out.
    pub fn to_toml(&self) -> String {
        axes::to_toml(self, &self.axes)
    }
}

/// The seed of every kind of study that names none.
pub(crate) fn default_seed() -> u64 {
    2018
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
