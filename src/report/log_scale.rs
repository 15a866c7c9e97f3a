//! Logarithmic axes: places, round ticks, and how they are drawn.

use crate::report::axis::short_number;
use crate::report::colours::{GRID, INK};
use crate::report::drawing::{Align, Area, Drawing, Stroke, TextStyle};
use crate::report::text_width::text_width;

/// Values from `low` to `high` (positive) along pixels `from` to `to`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LogScale {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl LogScale {
    /// The scale that covers the positive values, with a margin; 0.1 to 10 when there are none.
    pub(super) fn over(values: impl IntoIterator<Item = f64>, from: f64, to: f64) -> Self {
        let range = values
            .into_iter()
            .filter(|v| v.is_finite() && *v > 0.0)
            .fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), v| {
                (low.min(v), high.max(v))
            });
        let (low, high) = match range.0 <= range.1 {
            true => range,
            false => (0.1, 10.0),
        };
        // At least a third of a decade, so that equal values do not stand at the edges.
        let margin = (0.06 * (high / low).log10()).max(0.08);
        Self {
            low: low / 10f64.powf(margin),
            high: high * 10f64.powf(margin),
            from,
            to,
        }
    }

    /// Where a value stands, pixels; values beyond the scale at its ends.
    pub(super) fn place(&self, value: f64) -> f64 {
        let part = (value.max(f64::MIN_POSITIVE) / self.low).ln() / (self.high / self.low).ln();
        self.from + part.clamp(0.0, 1.0) * (self.to - self.from)
    }

    /// Powers of ten and, the fewer decades there are, the more of their multiples: at least about three ticks.
    pub(super) fn ticks(&self) -> Vec<f64> {
        const STEPS: [&[f64]; 4] = [
            &[1.0],
            &[1.0, 2.0, 5.0],
            &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0],
            &[
                1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.2, 2.4, 2.6, 2.8, 3.0, 3.5, 4.0, 4.5, 5.0, 6.0,
                7.0, 8.0, 9.0,
            ],
        ];
        let finer = STEPS.map(|factors| self.multiples(factors));
        let enough = finer.iter().position(|ticks| ticks.len() >= 3);
        finer[enough.unwrap_or(STEPS.len() - 1)].clone()
    }

    fn multiples(&self, factors: &[f64]) -> Vec<f64> {
        let first = self.low.log10().floor() as i32;
        let last = self.high.log10().ceil() as i32;
        (first..=last)
            .flat_map(|power| factors.iter().map(move |f| f * 10f64.powi(power)))
            .filter(|tick| (self.low..=self.high).contains(tick))
            .collect()
    }
}

/// Ticks, labels and grid lines of an axis along x; of labels that would touch, the later are left out.
pub(super) fn draw_x_ticks(drawing: &mut Drawing, area: Area, x: LogScale, ticks: &[f64]) {
    let bottom = area.y + area.height;
    let mut free_from = f64::NEG_INFINITY;
    let mut ticks = ticks.to_vec();
    ticks.sort_by(f64::total_cmp);
    for tick in ticks {
        let at = x.place(tick);
        drawing.line((at, area.y), (at, bottom), Stroke::new(GRID, 1.0));
        drawing.line((at, bottom), (at, bottom + 5.0), Stroke::new(INK, 1.0));
        let text = short_number(tick);
        let half = text_width(&text, 12.0) / 2.0;
        if at - half > free_from {
            drawing.text(
                (at, bottom + 19.0),
                &text,
                TextStyle::new(12).align(Align::Middle),
            );
            free_from = at + half + 5.0;
        }
    }
}

/// Ticks, labels and grid lines of an axis along y.
pub(super) fn draw_y_ticks(drawing: &mut Drawing, area: Area, y: LogScale, ticks: &[f64]) {
    for &tick in ticks {
        let at = y.place(tick);
        let right = area.x + area.width;
        drawing.line((area.x, at), (right, at), Stroke::new(GRID, 1.0));
        drawing.line((area.x - 5.0, at), (area.x, at), Stroke::new(INK, 1.0));
        let beside = (area.x - 9.0, at + 4.5);
        let style = TextStyle::new(12).align(Align::End);
        drawing.text(beside, &short_number(tick), style);
    }
}

/// Both axes of a panel with their ticks and grid.
pub(super) fn draw_axes(
    drawing: &mut Drawing,
    area: Area,
    (x, x_ticks): (LogScale, &[f64]),
    (y, y_ticks): (LogScale, &[f64]),
) {
    let (right, bottom) = (area.x + area.width, area.y + area.height);
    let ink = Stroke::new(INK, 1.0);
    draw_x_ticks(drawing, area, x, x_ticks);
    draw_y_ticks(drawing, area, y, y_ticks);
    drawing.line((area.x, bottom), (right, bottom), ink);
    drawing.line((area.x, area.y), (area.x, bottom), ink);
}

/// What runs along x, and along y.
pub(super) fn axis_titles(drawing: &mut Drawing, area: Area, along_x: &str, along_y: Option<&str>) {
    let style = TextStyle::new(13).align(Align::Middle);
    let below = (area.x + area.width / 2.0, area.y + area.height + 38.0);
    drawing.text(below, along_x, style);
    if let Some(text) = along_y {
        let beside = (area.x - 46.0, area.y + area.height / 2.0);
        drawing.text(beside, text, style.angle(-90.0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_every_factor_takes_the_same_room() {
        let scale = LogScale::over([1.0, 100.0], 0.0, 300.0);
        assert_eq!(scale.ticks(), [1.0, 10.0, 100.0]);
        assert_eq!(LogScale::over([0.3, 0.6], 0.0, 1.0).ticks().len(), 4);
        let step = scale.place(10.0) - scale.place(1.0);
        assert!((scale.place(100.0) - scale.place(10.0) - step).abs() < 1e-9);
        assert!(scale.place(1.0) > 0.0 && scale.place(100.0) < 300.0);
        assert_eq!(scale.place(0.0), 0.0);
        assert!(!LogScale::over([], 0.0, 1.0).ticks().is_empty());
    }
}
