//! What happens to a frame, as it is written: `[signal]`.

use super::axis::Axis;
use super::imperfection::TestedOn;
use serde::{Deserialize, Serialize};

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
    /// Axis: standard deviation of the taxels' gains, whose mean is 1. Gains, drift and faults belong to a skin: they follow from
    /// the seed and the array and are the same in all touches and trials.
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
    /// Axis: the skin that test touches are made with, `same_skin` (as training touches; when left out) or `another_skin`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tested_on: Option<Axis<TestedOn>>,
    /// How the axes of strengths above are combined with each other. (With other axes they always are.)
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
            tested_on: None,
            combine: CombineSpec::default(),
        }
    }
}
