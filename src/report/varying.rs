//! Which settings vary over the cells of a study, and which stay.
//!
//! Charts and terminal tables show the axes that vary and state the others once. An axis whose value is known from the
//! other varying axes (the ratio, when only m and the array are chosen) follows them and gets no place of its own.

use crate::recognition::ClassifierKind;
use crate::sensing::Ensemble;
use crate::signal::NoiseUnit;
use crate::study::table::Cell;
use std::collections::HashMap;

/// A setting that a study can sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Compression ratio n / m.
    Ratio,
    /// Measurements a touch, m.
    Measurements,
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
}

/// Every axis, in the order in which tables show them.
pub const AXES: [Axis; 10] = [
    Axis::Pitch,
    Axis::Size,
    Axis::Noise,
    Axis::Smoothing,
    Axis::Ensemble,
    Axis::Classifier,
    Axis::C,
    Axis::TrainTouches,
    Axis::Ratio,
    Axis::Measurements,
];

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

/// An axis and the values it takes, ascending (numbers) or in order of appearance (words).
#[derive(Clone, Debug, PartialEq)]
pub struct Levels {
    /// Which axis.
    pub axis: Axis,
    /// Its values, each once.
    pub values: Vec<AxisValue>,
}

/// The settings of a set of cells, sorted by whether they vary.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Axes that vary by themselves, in the order of [`AXES`].
    pub varying: Vec<Levels>,
    /// Axes that vary only because others do.
    pub following: Vec<Levels>,
    /// Axes with one value.
    pub fixed: Vec<Levels>,
}

impl Axis {
    /// One word, as in file names and column headers.
    pub fn word(self) -> &'static str {
        match self {
            Self::Ratio => "ratio",
            Self::Measurements => "measurements",
            Self::Pitch => "pitch",
            Self::Size => "size",
            Self::Noise => "noise",
            Self::Smoothing => "smoothing",
            Self::Ensemble => "ensemble",
            Self::Classifier => "classifier",
            Self::C => "c",
            Self::TrainTouches => "train_touches",
        }
    }

    /// The name in a sentence or before a value.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ratio => "compression",
            Self::Measurements => "m",
            Self::Pitch => "pitch",
            Self::Size => "array size",
            Self::Noise => "noise",
            Self::Smoothing => "smoothing",
            Self::Ensemble => "ensemble",
            Self::Classifier => "classifier",
            Self::C => "C",
            Self::TrainTouches => "training touches",
        }
    }

    /// The title of a chart's axis, with unit; the noise's unit is taken from a cell.
    pub fn title(self, cell: &Cell) -> String {
        let title = match self {
            Self::Ratio => "compression ratio n : m",
            Self::Measurements => "measurements a touch, m",
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
        };
        title.to_owned()
    }

    /// The value of this axis in a cell.
    pub fn value(self, cell: &Cell) -> AxisValue {
        match self {
            Self::Ratio => with_suffix(cell.ratio, ":1", ":1"),
            Self::Measurements => with_suffix(cell.measurements as f64, "", ""),
            Self::Pitch => with_suffix(cell.pitch_mm, "", " mm"),
            Self::Size => size(cell),
            Self::Noise => noise(cell),
            Self::Smoothing => with_suffix(cell.smoothing_mm, "", " mm"),
            Self::Ensemble => word(ensemble_name(cell.ensemble)),
            Self::Classifier => word(classifier_name(cell.classifier)),
            Self::C => match cell.c {
                Some(c) => with_suffix(c, "", ""),
                None => word("chosen"),
            },
            Self::TrainTouches => with_suffix(cell.train_touches as f64, "", ""),
        }
    }
}

impl Levels {
    /// The values of an axis over cells.
    pub fn of(axis: Axis, cells: &[&Cell]) -> Self {
        let mut values: Vec<AxisValue> = Vec::new();
        for cell in cells {
            let value = axis.value(cell);
            if !values.contains(&value) {
                values.push(value);
            }
        }
        if let Some(numbers) = numbers(&values) {
            let mut order: Vec<usize> = (0..values.len()).collect();
            order.sort_by(|&a, &b| numbers[a].total_cmp(&numbers[b]));
            values = order.into_iter().map(|i| values[i].clone()).collect();
        }
        Self { axis, values }
    }

    /// The values as numbers; none if one of them is a word.
    pub fn numbers(&self) -> Option<Vec<f64>> {
        numbers(&self.values)
    }

    /// The name and the values: `pitch 2 mm, 4 mm`.
    pub fn sentence(&self) -> String {
        let labels: Vec<&str> = self.values.iter().map(|v| v.label.as_str()).collect();
        let note = if self.is_of_full_scale() {
            " of full scale"
        } else {
            ""
        };
        format!("{} {}{note}", self.axis.name(), labels.join(", "))
    }

    /// The name with what its percentages are of, for the head of a column or a legend.
    pub fn heading(&self) -> String {
        let note = if self.is_of_full_scale() {
            " (of full scale)"
        } else {
            ""
        };
        format!("{}{note}", self.axis.name())
    }

    fn is_of_full_scale(&self) -> bool {
        self.axis == Axis::Noise && self.values.iter().all(|value| value.label.ends_with('%'))
    }
}

impl Settings {
    /// Sorts the axes of some cells.
    pub fn of(cells: &[&Cell]) -> Self {
        let all = AXES.map(|axis| Levels::of(axis, cells));
        let columns = Columns::of(&all, cells);
        let (mut varying, fixed): (Vec<Levels>, Vec<Levels>) =
            all.into_iter().partition(|levels| levels.values.len() > 1);
        let mut following = Vec::new();
        // m and the ratio say the same twice at one array; the array's sides follow its pitch when nx stays. An axis that a
        // study can only choose directly is dropped last.
        for axis in [
            Axis::Measurements,
            Axis::Ratio,
            Axis::Size,
            Axis::Pitch,
            Axis::C,
            Axis::TrainTouches,
            Axis::Smoothing,
            Axis::Noise,
            Axis::Ensemble,
            Axis::Classifier,
        ] {
            let others: Vec<Axis> = varying
                .iter()
                .map(|l| l.axis)
                .filter(|&a| a != axis)
                .collect();
            if others.len() < varying.len() && is_function_of(axis, &others, &columns) {
                following.extend(varying.extract_if(.., |levels| levels.axis == axis));
            }
        }
        Self {
            varying,
            following,
            fixed,
        }
    }

    /// The axes that vary, by themselves or with others, in the order of [`AXES`].
    pub fn shown(&self) -> Vec<&Levels> {
        let mut shown: Vec<&Levels> = self.varying.iter().chain(&self.following).collect();
        shown.sort_by_key(|levels| place(levels.axis));
        shown
    }
}

/// Parts in one line, `a · b`, that breaks between parts only: spaces within a part are U+00A0.
pub fn unbroken_parts(parts: &[String]) -> String {
    let parts: Vec<String> = parts.iter().map(|p| p.replace(' ', "\u{a0}")).collect();
    parts.join("\u{a0}· ")
}

/// A number as people write it: four significant digits, no trailing zeros.
pub fn short_number(number: f64) -> String {
    if number == 0.0 || !number.is_finite() {
        return if number == 0.0 {
            "0".to_owned()
        } else {
            number.to_string()
        };
    }
    let digits_before = number.abs().log10().floor() as i32 + 1;
    if !(-3..=6).contains(&digits_before) {
        return format!("{number:.2e}").replace(".00e", "e");
    }
    let decimals = (4 - digits_before).max(0) as usize;
    let text = format!("{number:.decimals$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// An ensemble in words.
pub fn ensemble_name(ensemble: Ensemble) -> &'static str {
    match ensemble {
        Ensemble::Gaussian => "Gaussian",
        Ensemble::Sbhe => "SBHE",
        Ensemble::BlockAverage => "block average",
        Ensemble::Subsample => "subsample",
        Ensemble::Identity => "identity",
    }
}

/// A classifier in words.
pub fn classifier_name(classifier: ClassifierKind) -> &'static str {
    match classifier {
        ClassifierKind::LinearSvm => "linear SVM",
        ClassifierKind::RbfSvm => "RBF SVM",
        ClassifierKind::PolynomialSvm => "polynomial SVM",
    }
}

/// Whether equal values on the other axes always come with equal values on this one.
fn is_function_of(axis: Axis, others: &[Axis], columns: &Columns) -> bool {
    let mut known: HashMap<Vec<usize>, usize> = HashMap::new();
    let column = &columns.0[place(axis)];
    (0..column.len()).all(|cell| {
        let key = others.iter().map(|&other| columns.0[place(other)][cell]);
        *known.entry(key.collect()).or_insert(column[cell]) == column[cell]
    })
}

/// For each axis in the order of [`AXES`], the number of each cell's value among the axis's levels.
struct Columns(Vec<Vec<usize>>);

impl Columns {
    fn of(levels: &[Levels], cells: &[&Cell]) -> Self {
        let column = |levels: &Levels| {
            let numbers = cells.iter().map(|cell| {
                let value = levels.axis.value(cell);
                levels.values.iter().position(|v| *v == value).unwrap_or(0)
            });
            numbers.collect()
        };
        Self(levels.iter().map(column).collect())
    }
}

fn place(axis: Axis) -> usize {
    AXES.iter().position(|&a| a == axis).unwrap_or(0)
}

fn numbers(values: &[AxisValue]) -> Option<Vec<f64>> {
    values.iter().map(|value| value.number).collect()
}

fn with_suffix(number: f64, tick: &str, label: &str) -> AxisValue {
    let text = short_number(number);
    AxisValue {
        number: Some(number),
        tick: format!("{text}{tick}"),
        label: format!("{text}{label}"),
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

fn noise(cell: &Cell) -> AxisValue {
    match cell.noise_unit {
        // 100 × 0.07 is not 7 in floating point; the label is rounded, and so is the place on the axis.
        NoiseUnit::FullScale => {
            let percent = (cell.noise_std * 1e8).round() / 1e6;
            with_suffix(percent, "", " %")
        }
        NoiseUnit::Mm => with_suffix(cell.noise_std, "", " mm"),
        NoiseUnit::N => with_suffix(cell.noise_std, "", " N"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(pitch_mm: f64, nx: usize, measurements: usize) -> Cell {
        Cell {
            cell: 0,
            pitch_mm,
            nx,
            ny: nx,
            size_mm: pitch_mm * nx as f64,
            noise_std: 0.07,
            noise_unit: NoiseUnit::FullScale,
            smoothing_mm: 0.0,
            ensemble: Ensemble::Gaussian,
            measurements,
            ratio: (nx * nx) as f64 / measurements as f64,
            classifier: ClassifierKind::LinearSvm,
            c: None,
            train_touches: 75,
        }
    }

    fn varying(cells: &[Cell]) -> Vec<Axis> {
        let settings = Settings::of(&cells.iter().collect::<Vec<_>>());
        settings.varying.iter().map(|levels| levels.axis).collect()
    }

    #[test]
    fn an_axis_that_others_determine_follows_them() {
        let fixed_m = [cell(2.0, 16, 64), cell(2.0, 32, 64), cell(2.0, 64, 64)];
        assert_eq!(varying(&fixed_m), [Axis::Size]);
        let fixed_nx = [
            cell(2.0, 32, 64),
            cell(4.0, 32, 64),
            cell(2.0, 32, 16),
            cell(4.0, 32, 16),
        ];
        assert_eq!(varying(&fixed_nx), [Axis::Pitch, Axis::Ratio]);
        let one_array = [cell(2.0, 32, 64), cell(2.0, 32, 16)];
        assert_eq!(varying(&one_array), [Axis::Ratio]);
        assert_eq!(varying(&[cell(2.0, 32, 64)]), []);
    }

    #[test]
    fn axes_that_a_full_grid_sweeps_all_vary() {
        let mut cells = Vec::new();
        for (pitch, nx) in [(2.0, 32), (2.0, 64), (4.0, 16), (4.0, 32)] {
            for ratio in [4, 16, 64] {
                cells.push(cell(pitch, nx, nx * nx / ratio));
            }
        }
        assert_eq!(varying(&cells), [Axis::Pitch, Axis::Size, Axis::Ratio]);
    }

    #[test]
    fn numbers_are_written_short_and_true() {
        let written = [
            0.0,
            7.0,
            0.1,
            1.0 / 3.0,
            1024.0,
            102.4,
            12345.6,
            1e-5,
            2.5e7,
        ];
        let expected = [
            "0", "7", "0.1", "0.3333", "1024", "102.4", "12346", "1.00e-5", "2.50e7",
        ];
        for (number, text) in written.into_iter().zip(expected) {
            assert_eq!(short_number(number), text.replace(".00e", "e"));
        }
        assert_eq!(Axis::Noise.value(&cell(2.0, 8, 4)).label, "7 %");
    }
}
