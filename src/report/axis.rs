//! The axes of a study: each setting's name, its value in a cell, and how both are written for people.

use super::signal_axis;
use crate::recognition::ClassifierKind;
use crate::recognition::features::Features;
use crate::recognition::over_time::OverTime;
use crate::sensing::{Basis, Ensemble, Solver};
use crate::signal::NoiseUnit;
use crate::study::table::Cell;
use crate::study::{Role, TestedOn, role_of, strength_columns};
pub use crate::table::short_number;
use crate::table::{Column, Value};

/// A setting that a study can sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Axis {
    /// Compression ratio n / m.
    Ratio,
    /// Measurements a frame, m.
    Measurements,
    /// Frames a touch.
    Frames,
    /// What is made of the frames of a touch.
    OverTime,
    /// What is made of measurements.
    Features,
    /// Millimetres between taxels.
    Pitch,
    /// Side lengths of the array.
    Size,
    /// Noise standard deviation.
    Noise,
    /// Standard deviation of the smoothing.
    Smoothing,
    /// How measurements are made.
    Ensemble,
    /// Which classifier.
    Classifier,
    /// Soft-margin penalty.
    C,
    /// Training touches an object.
    TrainTouches,
    /// Fraction of them with a wrong label.
    Mislabelled,
    /// Most frequent object's training touches over the rarest's.
    ClassImbalance,
    /// Test touches decided on together.
    FusedTouches,
    /// A sensor error, or an axis that the study names itself: what its column says.
    Column(&'static Column),
    /// The skin that test touches are made with.
    TestedOn,
    /// All that happens to the signal, in words: where only one thing at a time does.
    Signal,
}

/// Every axis of some cells but [`Signal`](Axis::Signal), which stands for several, in the order in which tables show them.
pub fn axes_of(cells: &[&Cell]) -> Vec<Axis> {
    let errors = strength_columns().iter();
    let own = cells.first().map_or(&[][..], |cell| &cell.variant.values);
    let own = own.iter().map(|axis| Axis::Column(axis.column));
    let first = [Axis::Pitch, Axis::Size, Axis::Noise, Axis::Smoothing];
    let last = [
        Axis::TestedOn,
        Axis::Frames,
        Axis::OverTime,
        Axis::Ensemble,
        Axis::Features,
        Axis::Classifier,
        Axis::C,
        Axis::TrainTouches,
        Axis::Mislabelled,
        Axis::ClassImbalance,
        Axis::FusedTouches,
        Axis::Ratio,
        Axis::Measurements,
    ];
    let all = own.chain(first).chain(errors.map(Axis::Column)).chain(last);
    all.collect()
}

/// One value of an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisValue {
    /// Where it stands on a numeric axis, in the unit of the axis title; none for a word.
    pub number: Option<f64>,
    /// The value for a tick, without unit: `10`, `4:1`, `sbhe`.
    pub tick: String,
    /// The value for a sentence, with unit: `10 %`.
    pub label: String,
}

impl Axis {
    /// One word, as in file names and column headers.
    pub fn word(self) -> &'static str {
        match self {
            Self::Ratio => "ratio",
            Self::Measurements => "measurements",
            Self::Frames => "frames",
            Self::OverTime => "over_time",
            Self::Features => "features",
            Self::Pitch => "pitch",
            Self::Size => "size",
            Self::Noise => "noise",
            Self::Smoothing => "smoothing",
            Self::Ensemble => "ensemble",
            Self::Classifier => "classifier",
            Self::C => "c",
            Self::TrainTouches => "train_touches",
            Self::Mislabelled => "mislabelled_fraction",
            Self::ClassImbalance => "class_imbalance",
            Self::FusedTouches => "fused_touches",
            Self::Column(column) => &column.name,
            Self::TestedOn => "tested_on",
            Self::Signal => "signal",
        }
    }

    /// The column of [`Cell`] that it is; none for [`Signal`](Self::Signal), which stands for several.
    pub fn column(self) -> Option<&'static str> {
        match self {
            Self::Signal => None,
            Self::Pitch => Some("pitch_mm"),
            Self::Size => Some("size_mm"),
            Self::Noise => Some("noise_std"),
            Self::Smoothing => Some("smoothing_mm"),
            other => Some(other.word()),
        }
    }

    /// Whether it is a condition of the world, not a designer's choice.
    pub fn is_condition(self) -> bool {
        if let Self::Column(column) = self {
            return column.role == Role::Condition;
        }
        self.column().and_then(role_of) == Some(Role::Condition)
    }

    /// The name in a sentence or before a value.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ratio => "compression",
            Self::Measurements => "m",
            Self::Frames => "frames a touch",
            Self::OverTime => "over time",
            Self::Features => "features",
            Self::Pitch => "pitch",
            Self::Size => "array size",
            Self::Noise => "noise",
            Self::Smoothing => "smoothing",
            Self::Ensemble => "ensemble",
            Self::Classifier => "classifier",
            Self::C => "C",
            Self::TrainTouches => "training touches",
            Self::Mislabelled => "mislabelled",
            Self::ClassImbalance => "class imbalance",
            Self::FusedTouches => "touches fused",
            Self::Column(column) => &column.words,
            Self::TestedOn => "test skin",
            Self::Signal => "signal",
        }
    }

    /// The title of a chart's axis, with unit; the noise's unit is taken from a cell.
    pub fn title(self, cell: &Cell) -> String {
        let title = match self {
            Self::Ratio => "compression ratio n : m",
            Self::Measurements => match cell.frames {
                1 => "measurements a touch, m",
                _ => "measurements a frame, m",
            },
            Self::Frames => "frames a touch",
            Self::OverTime => "what is learned of the frames",
            Self::Features => "features",
            Self::Pitch => "taxel pitch (mm)",
            Self::Size => "side length of the array (mm)",
            Self::Noise => match cell.noise_unit {
                NoiseUnit::FullScale => "noise standard deviation (% of full scale)",
                NoiseUnit::Mm => "noise standard deviation (mm)",
                NoiseUnit::N => "noise standard deviation (N)",
            },
            Self::Smoothing => "smoothing standard deviation (mm)",
            Self::Ensemble => "ensemble of measurements",
            Self::Classifier => "classifier",
            Self::C => "soft-margin penalty C",
            Self::TrainTouches => "training touches an object",
            Self::Mislabelled => "training touches with another object's label (%)",
            Self::ClassImbalance => "class imbalance (most : fewest training touches)",
            Self::FusedTouches => "touches decided on together",
            Self::Column(column) => return column.title(),
            Self::TestedOn => "test skin",
            Self::Signal => "signal",
        };
        title.to_owned()
    }

    /// The value of this axis in a cell.
    pub fn value(self, cell: &Cell) -> AxisValue {
        match self {
            Self::Ratio => with_suffix(cell.ratio, ":1", ":1"),
            Self::Measurements => with_suffix(cell.measurements as f64, "", ""),
            Self::Frames => with_suffix(cell.frames as f64, "", ""),
            Self::OverTime => word(&over_time_name(cell.over_time)),
            Self::Features => word(features_name(cell.features)),
            Self::Pitch => with_suffix(cell.pitch_mm, "", " mm"),
            Self::Size => size(cell),
            Self::Noise => noise(cell),
            Self::Smoothing => with_suffix(cell.smoothing_mm, "", " mm"),
            Self::Ensemble => word(ensemble_name(cell.ensemble)),
            Self::Classifier => word(classifier_name(cell.classifier)),
            Self::C => match cell.c {
                Some(c) => with_suffix(c, "", ""),
                None if cell.classifier.has_c() => word("chosen"),
                None => word("none"),
            },
            Self::TrainTouches => with_suffix(cell.train_touches as f64, "", ""),
            Self::Mislabelled => percent(cell.mislabelled_fraction.unwrap_or(0.0)),
            Self::ClassImbalance => with_suffix(cell.class_imbalance.unwrap_or(1.0), ":1", ":1"),
            Self::FusedTouches => with_suffix(cell.fused_touches as f64, "", ""),
            Self::Column(column) => column_value(column, cell),
            Self::TestedOn => word(match cell.tested_on.unwrap_or_default() {
                TestedOn::SameSkin => "the same skin",
                TestedOn::AnotherSkin => "another skin",
            }),
            Self::Signal => word(&signal_axis::words(cell)),
        }
    }
}

impl Axis {
    /// The name and the value in a cell: `m = 64`, `compression 64:1`.
    pub fn phrase(self, cell: &Cell) -> String {
        self.phrase_of(&self.value(cell))
    }

    /// The name and a value.
    pub fn phrase_of(self, value: &AxisValue) -> String {
        let label = value.label.clone();
        match self {
            Self::Measurements | Self::C | Self::Frames | Self::FusedTouches => {
                format!("{} = {label}", self.name())
            }
            Self::OverTime => label,
            Self::TestedOn => format!("tested on {label}"),
            Self::Signal => match &label[..] {
                signal_axis::IDEAL => signal_axis::IDEAL_SIGNAL.to_owned(),
                _ => label,
            },
            _ => format!("{} {label}", self.name()),
        }
    }
}

/// An ensemble in words.
pub fn ensemble_name(ensemble: Ensemble) -> &'static str {
    ensemble.about().words
}

/// What is made of measurements, in words.
pub fn features_name(features: Features) -> &'static str {
    match features {
        Features::Raw => "raw",
        Features::Centred => "centred",
        Features::UnitNorm => "unit norm",
        Features::CentredUnitNorm => "centred, unit norm",
    }
}

/// What is made of the frames of a touch, in words.
pub fn over_time_name(over_time: Option<OverTime>) -> String {
    match over_time {
        None => "all frames".to_owned(),
        Some(OverTime::Deepest) => "deepest frame".to_owned(),
        Some(OverTime::Stacked(k)) => format!("{k} frames"),
        Some(OverTime::Moments) => "moments".to_owned(),
        Some(OverTime::Course) => "course".to_owned(),
        Some(OverTime::Summarised) => "moments and course".to_owned(),
    }
}

/// A basis in words.
pub fn basis_name(basis: Basis) -> &'static str {
    match basis {
        Basis::Dct => "DCT",
        Basis::Haar => "Haar",
        Basis::Daubechies4 => "Daubechies 4",
        Basis::Pca => "PCA",
    }
}

/// A solver in words.
pub fn solver_name(solver: Solver) -> &'static str {
    match solver {
        Solver::Omp => "OMP",
        Solver::L1 => "ℓ1",
        Solver::Lmmse => "LMMSE",
    }
}

/// A classifier in words.
pub fn classifier_name(classifier: ClassifierKind) -> &'static str {
    classifier.about().words
}

fn with_suffix(number: f64, tick: &str, label: &str) -> AxisValue {
    let text = short_number(number);
    AxisValue {
        number: Some(number),
        tick: format!("{text}{tick}"),
        label: format!("{text}{label}"),
    }
}

fn column_value(column: &'static Column, cell: &Cell) -> AxisValue {
    let own = cell.variant.values.iter();
    let value = match own.into_iter().find(|axis| axis.column == column) {
        Some(axis) => match &axis.value {
            toml::Value::Integer(number) => Value::Number(*number as f64),
            toml::Value::Float(number) => Value::Number(*number),
            toml::Value::String(text) => Value::Word(text.clone()),
            other => Value::Word(other.to_string()),
        },
        None => Value::Number(cell.strengths.of(&column.name).unwrap_or(0.0)),
    };
    let label = column.value_words(&value);
    match value {
        Value::Number(number) => {
            let shown = if column.unit == "%" {
                100.0 * number
            } else {
                number
            };
            AxisValue {
                number: Some(shown),
                tick: column.tick(number),
                label,
            }
        }
        Value::Word(_) => word(&label),
    }
}

fn word(text: &str) -> AxisValue {
    AxisValue {
        number: None,
        tick: text.to_owned(),
        label: text.to_owned(),
    }
}

fn size(cell: &Cell) -> AxisValue {
    let along_y = cell.ny as f64 * cell.pitch_mm;
    if cell.nx == cell.ny {
        return with_suffix(cell.size_mm, "", " mm");
    }
    let sides = format!("{} × {}", short_number(cell.size_mm), short_number(along_y));
    AxisValue {
        number: None,
        label: format!("{sides} mm"),
        tick: sides,
    }
}

/// 100 × 0.07 is not 7 in floating point; the label is rounded, and so is the place on the axis.
fn percent(fraction: f64) -> AxisValue {
    with_suffix((fraction * 1e8).round() / 1e6, "", " %")
}

fn noise(cell: &Cell) -> AxisValue {
    match cell.noise_unit {
        NoiseUnit::FullScale => percent(cell.noise_std),
        NoiseUnit::Mm => with_suffix(cell.noise_std, "", " mm"),
        NoiseUnit::N => with_suffix(cell.noise_std, "", " N"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_axis_is_a_choice_or_a_condition() {
        for axis in axes_of(&[]) {
            let role = axis.column().and_then(role_of);
            let is_either = matches!(role, Some(Role::Choice | Role::Condition));
            assert!(is_either, "{axis:?}: {role:?}");
        }
    }
}
