//! Which settings vary over the cells of a study, and which stay.
//!
//! Charts and terminal tables show the axes that vary and state the others once. An axis whose value is known from the
//! other varying axes (the ratio, when only m and the array are chosen) follows them and gets no place of its own. Axes of the
//! signal that leave their first values one at a time share one place: their cells are told by what happens to the signal.

use crate::report::axis::{Axis, AxisValue, axes_of};
use crate::report::signal_axis::IDEAL_SIGNAL;
use crate::study::strength_columns;
use crate::study::table::Cell;
use std::collections::HashMap;

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
    /// Axes that vary by themselves, in the order of [`axes_of`].
    pub varying: Vec<Levels>,
    /// Axes that vary only because others do.
    pub following: Vec<Levels>,
    /// Axes of the signal of which at most one leaves its first value in any cell; [`Axis::Signal`] is in `varying` for them.
    pub one_at_a_time: Vec<Levels>,
    /// Axes with one value, but for those that [go without saying](Levels::go_without_saying).
    pub fixed: Vec<Levels>,
    /// All axes in the order in which tables show them.
    order: Vec<Axis>,
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

    /// Whether all cells do what nobody expects otherwise: read a touch once, raw, with an ideal skin, and decide on it alone.
    pub fn go_without_saying(&self) -> bool {
        let usual = match self.axis {
            Axis::Frames | Axis::FusedTouches => "1",
            Axis::OverTime => "all frames",
            Axis::Features => "raw",
            // A reader expects an ideal skin.
            Axis::Column(column) if strength_columns().contains(column) => {
                return self.numbers() == Some(vec![0.0]);
            }
            Axis::TestedOn => "the same skin",
            Axis::Mislabelled => "0 %",
            Axis::ClassImbalance => "1:1",
            _ => return false,
        };
        self.values.iter().all(|value| value.label == usual)
    }

    fn is_of_full_scale(&self) -> bool {
        self.axis == Axis::Noise && self.values.iter().all(|value| value.label.ends_with('%'))
    }
}

impl Settings {
    /// Sorts the axes of some cells.
    pub fn of(cells: &[&Cell]) -> Self {
        let axes = axes_of(cells);
        let all: Vec<Levels> = axes.iter().map(|&axis| Levels::of(axis, cells)).collect();
        let columns = Columns::of(&all, cells);
        let (mut varying, mut fixed): (Vec<Levels>, Vec<Levels>) =
            all.into_iter().partition(|levels| levels.values.len() > 1);
        fixed.retain(|levels| !levels.go_without_saying());
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
            Axis::Mislabelled,
            Axis::ClassImbalance,
            Axis::FusedTouches,
            Axis::Smoothing,
            Axis::Noise,
            Axis::Frames,
            Axis::OverTime,
            Axis::Features,
            Axis::Ensemble,
            Axis::Classifier,
        ]
        .into_iter()
        .chain(strength_columns().iter().map(Axis::Column))
        .chain([Axis::TestedOn])
        {
            let others: Vec<Axis> = varying
                .iter()
                .map(|l| l.axis)
                .filter(|&a| a != axis)
                .collect();
            if others.len() < varying.len() && is_function_of(axis, &others, &columns) {
                following.extend(varying.extract_if(.., |levels| levels.axis == axis));
            }
        }
        let one_at_a_time = one_at_a_time(&varying, cells);
        if let [first, ..] = &one_at_a_time[..] {
            let place = varying.iter().position(|levels| levels == first);
            varying.insert(place.unwrap_or(0), Levels::of(Axis::Signal, cells));
            varying.retain(|levels| !one_at_a_time.contains(levels));
        }
        Self {
            varying,
            following,
            one_at_a_time,
            fixed,
            order: axes,
        }
    }

    fn place(&self, axis: Axis) -> usize {
        self.order.iter().position(|&a| a == axis).unwrap_or(0)
    }

    /// The axes whose numbers a chart can run along, or a sentence: those that vary by themselves, each by its own.
    pub fn single(&self) -> impl Iterator<Item = &Levels> {
        let varying = self.varying.iter();
        varying
            .filter(|levels| levels.axis != Axis::Signal)
            .chain(&self.one_at_a_time)
    }

    /// The axes that vary and are conditions of the world, each by its own.
    pub fn conditions(&self) -> impl Iterator<Item = &Levels> {
        let axes = self.single().chain(&self.following);
        axes.filter(|levels| levels.axis.is_condition())
    }

    /// The condition of a cell in words; empty if the study has one. Where one thing at a time happens to the signal, that one.
    pub fn condition_words(&self, cell: &Cell) -> String {
        let is_ideal = |levels: &&Levels| match levels.axis {
            Axis::Noise => cell.noise_std == 0.0,
            Axis::Column(column) => cell.strengths.of(&column.name).unwrap_or(0.0) == 0.0,
            _ => false,
        };
        let is_ideal = |levels: &&Levels| self.one_at_a_time.contains(*levels) && is_ideal(levels);
        let said = self.conditions().filter(|levels| !is_ideal(levels));
        let mut words: Vec<String> = said.map(|levels| levels.axis.phrase(cell)).collect();
        if words.is_empty() && self.conditions().next().is_some() {
            words.push(IDEAL_SIGNAL.to_owned());
        }
        words.join(", ")
    }

    /// The choices of a cell that vary in the study, in words: `classifier RBF SVM, m = 64`; empty if none varies.
    pub fn choice_words(&self, cell: &Cell) -> String {
        let mut axes: Vec<&Levels> = self.single().chain(&self.following).collect();
        axes.retain(|levels| !levels.axis.is_condition());
        axes.sort_by_key(|levels| self.place(levels.axis));
        let words: Vec<String> = axes.iter().map(|levels| levels.axis.phrase(cell)).collect();
        words.join(", ")
    }

    /// The axes that vary, by themselves or with others, in the order of [`axes_of`].
    pub fn shown(&self) -> Vec<&Levels> {
        let mut shown: Vec<&Levels> = self.varying.iter().chain(&self.following).collect();
        shown.sort_by_key(|levels| self.place(levels.axis));
        shown
    }
}

/// Parts in one line, `a · b`, that breaks between parts only: spaces within a part are U+00A0.
pub fn unbroken_parts(parts: &[String]) -> String {
    let parts: Vec<String> = parts.iter().map(|p| p.replace(' ', "\u{a0}")).collect();
    parts.join("\u{a0}· ")
}

/// The axes of the signal, if several vary but in no cell more than one of them differs from the first cell.
fn one_at_a_time(varying: &[Levels], cells: &[&Cell]) -> Vec<Levels> {
    let of_signal = varying.iter().filter(|levels| {
        let axis = levels.axis;
        match axis {
            Axis::Noise | Axis::Smoothing => true,
            Axis::Column(column) => strength_columns().contains(column),
            _ => false,
        }
    });
    let of_signal: Vec<Levels> = of_signal.cloned().collect();
    let differs = |cell: &Cell, axis: Axis| axis.value(cell) != axis.value(cells[0]);
    let is_alone = |cell: &&Cell| {
        let axes = of_signal.iter().map(|levels| levels.axis);
        axes.filter(|&axis| differs(cell, axis)).count() < 2
    };
    match of_signal.len() > 1 && cells.iter().all(is_alone) {
        true => of_signal,
        false => Vec::new(),
    }
}

/// Whether equal values on the other axes always come with equal values on this one.
fn is_function_of(axis: Axis, others: &[Axis], columns: &Columns) -> bool {
    let mut known: HashMap<Vec<usize>, usize> = HashMap::new();
    let column = columns.of_axis(axis);
    let others: Vec<&[usize]> = others.iter().map(|&other| columns.of_axis(other)).collect();
    (0..column.len()).all(|cell| {
        let key = others.iter().map(|other| other[cell]);
        *known.entry(key.collect()).or_insert(column[cell]) == column[cell]
    })
}

/// For each axis in the order of [`axes_of`], the number of each cell's value among the axis's levels.
struct Columns(Vec<(Axis, Vec<usize>)>);

impl Columns {
    fn of(levels: &[Levels], cells: &[&Cell]) -> Self {
        let column = |levels: &Levels| {
            let numbers = cells.iter().map(|cell| {
                let value = levels.axis.value(cell);
                levels.values.iter().position(|v| *v == value).unwrap_or(0)
            });
            (levels.axis, numbers.collect())
        };
        Self(levels.iter().map(column).collect())
    }

    fn of_axis(&self, axis: Axis) -> &[usize] {
        let found = self.0.iter().find(|(known, _)| *known == axis);
        found.map_or(&[], |(_, column)| column)
    }
}

fn numbers(values: &[AxisValue]) -> Option<Vec<f64>> {
    values.iter().map(|value| value.number).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Strengths;

    fn cell(pitch_mm: f64, nx: usize, measurements: usize) -> Cell {
        Cell {
            pitch_mm,
            nx,
            ny: nx,
            size_mm: pitch_mm * nx as f64,
            measurements,
            ratio: (nx * nx) as f64 / measurements as f64,
            ..crate::study::table::tests::cell()
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
    /// Without and with 10 % noise, and with gain mismatch of 20 and 50 %.
    fn one_imperfection_at_a_time() -> Vec<Cell> {
        let at = |noise_std, gain| Cell {
            noise_std,
            strengths: Strengths::default().with("gain_std", Some(gain)),
            ..cell(2.0, 32, 64)
        };
        vec![at(0.0, 0.0), at(0.1, 0.0), at(0.0, 0.2), at(0.0, 0.5)]
    }

    #[test]
    fn a_signal_of_which_one_thing_changes_at_a_time_is_told_in_words() {
        let mut cells = one_imperfection_at_a_time();
        assert_eq!(varying(&cells), [Axis::Signal]);
        let all: Vec<&Cell> = cells.iter().collect();
        let settings = Settings::of(&all);
        let single: Vec<Axis> = settings.single().map(|levels| levels.axis).collect();
        let gain = Axis::Column(&strength_columns()[2]);
        assert_eq!(single, [Axis::Noise, gain]);
        let words: Vec<String> = settings.varying[0]
            .values
            .iter()
            .map(|v| v.label.clone())
            .collect();
        let expected = [
            "ideal",
            "noise 10 %",
            "gain mismatch 20 %",
            "gain mismatch 50 %",
        ];
        assert_eq!(words, expected);
        // Both at once, and each has a place of its own again.
        cells.push(Cell {
            noise_std: 0.1,
            ..cells[3].clone()
        });
        assert_eq!(varying(&cells), [Axis::Noise, gain]);
    }

    #[test]
    fn an_ideal_skin_goes_without_saying_and_any_other_does_not() {
        let told = |gain_std| {
            let cell = Cell {
                strengths: Strengths::default().with("gain_std", gain_std),
                ..cell(2.0, 32, 64)
            };
            let settings = Settings::of(&[&cell]);
            let sentences = settings.fixed.iter().map(Levels::sentence);
            sentences.filter(|s| s.contains("gain")).collect::<Vec<_>>()
        };
        assert!(told(None).is_empty() && told(Some(0.0)).is_empty());
        assert_eq!(told(Some(0.25)), ["gain mismatch 25 %"]);
    }
}
