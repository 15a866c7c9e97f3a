//! The logarithmic axis of a chart of times.

use crate::report::colours::{GRID, INK};
use crate::report::drawing::{Align, Area, Drawing, Stroke, TextStyle};
use crate::report::legend::RIGHT;
use crate::report::text_width::text_width;
use crate::report::x_scale::TICK_SIZE;

/// A logarithmic axis of time.
pub(super) struct TimeScale {
    low: f64,
    high: f64,
}

impl TimeScale {
    /// From the shortest to the longest time (seconds), and a little further.
    pub(super) fn of(seconds: impl Iterator<Item = f64> + Clone) -> Self {
        let low = seconds.clone().fold(f64::INFINITY, f64::min);
        let high = seconds.fold(0.0, f64::max);
        Self {
            low: 0.7 * low,
            high: 1.4 * high,
        }
    }

    /// Where a time stands, pixels.
    pub(super) fn x(&self, seconds: f64, frame: Area) -> f64 {
        let share = (seconds / self.low).ln() / (self.high / self.low).ln();
        frame.x + share * frame.width
    }

    /// Ticks, labels and grid lines.
    pub(super) fn draw_ticks(&self, drawing: &mut Drawing, frame: Area) {
        let bottom = frame.y + frame.height;
        for (seconds, is_labelled) in self.ticks(frame) {
            let x = self.x(seconds, frame);
            drawing.line((x, frame.y), (x, bottom), Stroke::new(GRID, 1.0));
            drawing.line((x, bottom), (x, bottom + 5.0), Stroke::new(INK, 1.0));
            if is_labelled {
                let label = time_label(seconds);
                // At the very end of the axis, half a label would leave the paper.
                let half = text_width(&label, f64::from(TICK_SIZE)) / 2.0;
                let middle = x.min(frame.x + frame.width + RIGHT - 2.0 - half);
                let style = TextStyle::new(TICK_SIZE).align(Align::Middle);
                drawing.text((middle, bottom + 19.0), &label, style);
            }
        }
    }

    /// 1, 2 and 5 of every decade within the axis (all digits of a decade that fills it), and whether there is room for each
    /// one's label.
    pub(super) fn ticks(&self, frame: Area) -> Vec<(f64, bool)> {
        let first = self.low.log10().floor() as i32;
        let last = self.high.log10().ceil() as i32;
        let decade = (self.x(10.0, frame) - self.x(1.0, frame)).abs();
        let is_labelled = |digit: i32| match digit {
            1 => true,
            _ => decade > 190.0,
        };
        let digits: &[i32] = match decade > 0.8 * frame.width {
            true => &[1, 2, 3, 4, 5, 6, 7, 8, 9],
            false => &[1, 2, 5],
        };
        (first..=last)
            .flat_map(|power| digits.iter().map(move |&digit| (digit, power)))
            .map(|(digit, power)| (power_of_ten(digit, power), is_labelled(digit)))
            .filter(|(seconds, _)| (self.low..=self.high).contains(seconds))
            .collect()
    }
}

/// `digit · 10^power` as the nearest number, which a product with a rounded power is not.
fn power_of_ten(digit: i32, power: i32) -> f64 {
    match power {
        0.. => f64::from(digit) * 10_f64.powi(power),
        _ => f64::from(digit) / 10_f64.powi(-power),
    }
}

/// `20 µs`, `5 ms`, `100 s`.
pub(super) fn time_label(seconds: f64) -> String {
    let (number, unit) = in_unit(seconds);
    format!("{number:.0} {unit}")
}

/// A time to three digits that count: `20.3 µs`.
pub(super) fn time_words(seconds: f64) -> String {
    let (number, unit) = in_unit(seconds);
    let rounded: f64 = format!("{number:.2e}").parse().unwrap_or(number);
    format!("{rounded} {unit}")
}

fn in_unit(seconds: f64) -> (f64, &'static str) {
    match seconds {
        s if s < 0.999e-6 => (s * 1e9, "ns"),
        s if s < 0.999e-3 => (s * 1e6, "µs"),
        s if s < 0.999 => (s * 1e3, "ms"),
        s => (s, "s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_labelled_in_the_unit_that_suits_them() {
        for (seconds, label) in [
            (1e-9, "1 ns"),
            (5e-7, "500 ns"),
            (1e-6, "1 µs"),
            (2e-4, "200 µs"),
            (1e-3, "1 ms"),
            (0.5, "500 ms"),
            (1.0, "1 s"),
            (200.0, "200 s"),
        ] {
            assert_eq!(time_label(seconds), label);
        }
    }

    #[test]
    fn times_in_words_have_three_digits() {
        for (seconds, words) in [
            (4.2e-8, "42 ns"),
            (2.0349e-5, "20.3 µs"),
            (0.12, "120 ms"),
            (1234.0, "1230 s"),
        ] {
            assert_eq!(time_words(seconds), words);
        }
    }

    #[test]
    fn every_time_stands_within_the_frame_and_ticks_ascend() {
        let frame = Area {
            x: 10.0,
            y: 0.0,
            width: 400.0,
            height: 1.0,
        };
        for times in [vec![3e-6], vec![2e-9, 7e3], vec![1.0, 1.1, 1.2]] {
            let scale = TimeScale::of(times.iter().copied());
            for &seconds in &times {
                let x = scale.x(seconds, frame);
                assert!(x > frame.x && x < frame.x + frame.width, "{times:?}");
            }
            let ticks: Vec<f64> = scale.ticks(frame).iter().map(|(s, _)| *s).collect();
            assert!(ticks.is_sorted() && !ticks.is_empty(), "{ticks:?}");
        }
    }
}
