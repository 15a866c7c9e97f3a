//! Axes, colour bars and scale bars of pictures.

use crate::report::pictures::{
    Align, Area, ColourScale, Drawing, INK, Point, Rgb, Stroke, TextStyle, heat,
};
use crate::table::short_number;

/// Side of an area (below, left or right) at which an axis is drawn.
#[derive(Clone, Copy)]
pub(crate) enum Side {
    Below,
    Left,
    Right,
}

/// Draws an axis with round ticks and a title. The value at the left or lower end is `low`, the value at the right or upper end `high`.
pub(crate) fn draw_axis(
    drawing: &mut Drawing,
    area: Area,
    side: Side,
    (low, high): (f64, f64),
    title: &str,
) {
    let style = TextStyle::new(12);
    let moved = |(x, y): Point, right: f64, down: f64| (x + right, y + down);
    for value in even_ticks(low, high) {
        let part = (value - low) / (high - low);
        let (at, end, text_at, align) = match side {
            Side::Below => (area.at(part, 0.0), (0.0, 5.0), (0.0, 18.0), Align::Middle),
            Side::Left => (area.at(0.0, part), (-5.0, 0.0), (-8.0, 4.5), Align::End),
            Side::Right => (area.at(1.0, part), (4.0, 0.0), (8.0, 4.5), Align::Start),
        };
        drawing.line(at, moved(at, end.0, end.1), Stroke::new(INK, 1.0));
        let text_at = moved(at, text_at.0, text_at.1);
        drawing.text(text_at, &short_number(value), style.align(align));
    }
    let (at, angle) = match side {
        Side::Below => (moved(area.at(0.5, 0.0), 0.0, 36.0), 0.0),
        Side::Left => (moved(area.at(0.0, 0.5), -44.0, 0.0), -90.0),
        Side::Right => (moved(area.at(1.0, 0.5), 52.0, 0.0), -90.0),
    };
    drawing.text(at, title, style.align(Align::Middle).angle(angle));
}

/// Draws an axis in millimetres along the lower or left edge of a map; the origin is the centre of the map. The length of the map is `length`, mm.
pub(crate) fn draw_map_axis(drawing: &mut Drawing, area: Area, side: Side, length: f64) {
    let title = match side {
        Side::Below => "x (mm)",
        Side::Left | Side::Right => "y (mm)",
    };
    draw_axis(drawing, area, side, (-0.5 * length, 0.5 * length), title);
}

/// Draws a colour bar with the given scale in an area, with its axis on the right.
pub(crate) fn draw_colour_bar(drawing: &mut Drawing, scale: ColourScale, area: Area) {
    draw_colours(drawing, area, heat);
    drawing.frame(area, Stroke::new(INK, 1.0));
    let title = format!("{} ({})", scale.quantity.name(), scale.quantity.unit());
    draw_axis(drawing, area, Side::Right, (scale.low, scale.high), &title);
}

/// Draws the colours of all values from 0 to 1 along the longer side of an area, to the right or upwards.
pub(crate) fn draw_colours(drawing: &mut Drawing, area: Area, colour: impl Fn(f64) -> Rgb) {
    const STEPS: usize = 64;
    for step in 0..STEPS {
        let [from, to] = [step, step + 1].map(|step| step as f64 / STEPS as f64);
        // Each colour extends to the end of the area, so that there are no gaps between steps.
        let (across, up) = match area.width > area.height {
            true => (from, 0.0),
            false => (0.0, from),
        };
        let size = (area.width * (1.0 - across), area.height * (1.0 - up));
        let piece = Area::new(area.at(across, 1.0), size);
        drawing.area(piece, colour(0.5 * (from + to)));
    }
}

/// Draws a scale bar: a line of a round length, at most `longest` pixels, with the length written above it.
pub(crate) fn draw_scale_bar(
    drawing: &mut Drawing,
    (x, y): Point,
    pixels_per_metre: f64,
    longest: f64,
) {
    let millimetres = bar_length(longest / pixels_per_metre * 1e3);
    let half = 0.5e-3 * millimetres * pixels_per_metre;
    drawing.line((x - half, y), (x + half, y), Stroke::new(INK, 2.0));
    let text = format!("{} mm", short_number(millimetres));
    drawing.text((x, y - 5.0), &text, TextStyle::new(12).align(Align::Middle));
}

/// Returns the largest round number (1, 2 or 5 times a power of ten) that is at most `largest`.
fn bar_length(largest: f64) -> f64 {
    let power = 10f64.powf(largest.log10().floor());
    let steps = [5.0, 2.0, 1.0].map(|step| step * power);
    steps.into_iter().find(|&s| s <= largest).unwrap_or(power)
}

/// Returns the multiples of a round step size that lie between `low` and `high`.
pub(crate) fn even_ticks(low: f64, high: f64) -> Vec<f64> {
    let step = tick_step(high - low);
    let (first, last) = (
        (low / step - 1e-9).ceil() as i64,
        (high / step + 1e-9).floor() as i64,
    );
    // Division by the inverse step gives the nearest floating-point number; multiplication does not, for example 3 × 0.1.
    let value = |tick: i64| match step < 1.0 {
        true => tick as f64 / (1.0 / step).round(),
        false => tick as f64 * step,
    };
    (first..=last).map(value).collect()
}

/// Returns a step size of 1, 2 or 5 times a power of ten that divides a length into about five steps.
pub(crate) fn tick_step(length: f64) -> f64 {
    round_up(length / 5.0)
}

/// Returns the smallest of 1, 2 or 5 times a power of ten that is at least `least`, up to a rounding of 0.1 %.
pub(crate) fn round_up(least: f64) -> f64 {
    let power = 10f64.powf(least.log10().floor());
    let mut factors = [1.0, 2.0, 5.0].into_iter();
    factors
        .find(|factor| factor * power >= least * 0.999)
        .unwrap_or(10.0)
        * power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_are_the_longest_round_number_that_fits() {
        let lengths = [1.0, 1.99, 2.5, 7.0, 12.0, 49.0, 0.03].map(bar_length);
        let expected = [1.0, 1.0, 2.0, 5.0, 10.0, 20.0, 0.02];
        for (length, expected) in lengths.into_iter().zip(expected) {
            assert!((length - expected).abs() < 1e-12, "{length}");
        }
    }
}
