//! Where the values of a chart's x axis stand.

use crate::report::axis::{Axis, AxisValue};
use crate::report::drawing::Area;
use crate::report::text_width::text_width;
use crate::report::varying::Levels;
use crate::table::Role;

/// Font size of tick labels.
pub(super) const TICK_SIZE: u32 = 12;

/// Values, places and label rows of one panel's x axis.
pub(super) struct XScale {
    /// Each value with its x, pixels.
    pub(super) ticks: Vec<(AxisValue, f64)>,
    /// For each tick the row of labels in which it finds room: 0, 1 below it, or none.
    pub(super) label_rows: Vec<Option<usize>>,
}

impl XScale {
    /// Places of values in a panel.
    pub(super) fn of(levels: &Levels, frame: Area) -> Self {
        let numbers = levels.numbers().unwrap_or_default();
        let places: Vec<f64> = match spacing(levels) {
            Spacing::Logarithmic => numbers.iter().map(|number| number.ln()).collect(),
            Spacing::OfRoots => numbers.iter().map(|number| number.sqrt()).collect(),
            Spacing::Even => numbers,
            Spacing::Words => (0..levels.values.len()).map(|i| i as f64).collect(),
        };
        let low = places.iter().copied().fold(f64::INFINITY, f64::min);
        let high = places.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let margin = 0.06 * frame.width;
        let x = |place: f64| match high > low {
            true => frame.x + margin + (place - low) / (high - low) * (frame.width - 2.0 * margin),
            false => frame.x + frame.width / 2.0,
        };
        let ticks = levels.values.iter().cloned().zip(places);
        let ticks: Vec<(AxisValue, f64)> = ticks.map(|(value, place)| (value, x(place))).collect();
        let label_rows = label_rows(&ticks);
        Self { ticks, label_rows }
    }

    /// Whether the labels need two rows.
    pub(super) fn has_second_row(&self) -> bool {
        self.label_rows.contains(&Some(1))
    }

    /// Where a value stands, pixels; none for a value that is not on the axis.
    pub(super) fn x(&self, value: &AxisValue) -> Option<f64> {
        let tick = self.ticks.iter().find(|(tick, _)| tick == value);
        tick.map(|(_, x)| *x)
    }
}

fn label_rows(ticks: &[(AxisValue, f64)]) -> Vec<Option<usize>> {
    let mut free_from = [f64::NEG_INFINITY; 2];
    let mut rows = Vec::new();
    for (value, x) in ticks {
        let half = text_width(&value.tick, f64::from(TICK_SIZE)) / 2.0;
        let row = (0..2).find(|&row| x - half > free_from[row]);
        if let Some(row) = row {
            free_from[row] = x + half + 6.0;
        }
        rows.push(row);
    }
    rows
}

/// How the values of an axis are spaced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Spacing {
    /// Where ratios are what matters.
    Logarithmic,
    /// By square roots: strengths that start at zero and grow manifold.
    OfRoots,
    /// By themselves.
    Even,
    /// At equal distances: words.
    Words,
}

/// The spacing that suits an axis.
pub(super) fn spacing(levels: &Levels) -> Spacing {
    match levels.numbers() {
        Some(numbers) if is_logarithmic(levels.axis, &numbers) => Spacing::Logarithmic,
        Some(numbers) if is_of_roots(levels.axis, &numbers) => Spacing::OfRoots,
        Some(_) => Spacing::Even,
        None => Spacing::Words,
    }
}

fn is_logarithmic(axis: Axis, numbers: &[f64]) -> bool {
    let by_nature = matches!(
        axis,
        Axis::Ratio
            | Axis::Measurements
            | Axis::C
            | Axis::TrainTouches
            | Axis::ClassImbalance
            | Axis::FusedTouches
            | Axis::Frames
    );
    by_nature && numbers.iter().all(|&number| number > 0.0)
}

fn is_of_roots(axis: Axis, numbers: &[f64]) -> bool {
    let is_strength = matches!(axis, Axis::Column(column) if column.role == Role::Condition);
    is_strength && numbers.iter().all(|&number| number >= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::table::Cell;
    use crate::study::{Strengths, strength_columns};

    #[test]
    fn strengths_from_nothing_to_absurd_all_find_room_for_their_labels() {
        let strengths = [0.0, 0.001, 0.005, 0.02, 0.1, 0.3];
        let cells = strengths.map(|strength| Cell {
            strengths: Strengths::default().with("stuck_fraction", Some(strength)),
            ..crate::study::table::tests::cell()
        });
        let cells: Vec<&Cell> = cells.iter().collect();
        let frame = Area {
            x: 0.0,
            y: 0.0,
            width: 400.0,
            height: 300.0,
        };
        let scale = XScale::of(
            &Levels::of(Axis::Column(&strength_columns()[5]), &cells),
            frame,
        );
        assert!(scale.label_rows.iter().all(Option::is_some));
        let places: Vec<f64> = scale.ticks.iter().map(|(_, x)| *x).collect();
        // 0.3 is three times as far from zero as 0.1 is in the square.
        let (zero, near, far) = (places[0], places[4], places[5]);
        assert!(((far - zero).powi(2) / (near - zero).powi(2) - 3.0).abs() < 1e-9);
    }
}
