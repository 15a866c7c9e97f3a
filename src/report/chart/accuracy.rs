//! Panels of shares that charts of some kinds draw by themselves.

use crate::report::colours::Rgb;
use crate::report::colours::{GRID, INK};
use crate::report::drawing::{Align, Area, Drawing, Point, Stroke, TextStyle};
use crate::report::legend::{FRONT, MARKER_RADIUS, line_colour, line_stroke};
use crate::report::x_scale::TICK_SIZE;
use crate::study::table::CellScore;

const LABEL: u32 = 13;

/// Where an accuracy stands in a panel, pixels down.
pub(in crate::report) fn y_at(frame: Area, accuracy: f64) -> f64 {
    frame.y + frame.height * (1.0 - accuracy.clamp(0.0, 1.0))
}

/// The axes of a panel, and lines across it at the accuracies of their ticks.
pub(in crate::report) fn draw_axes(drawing: &mut Drawing, frame: Area) {
    let (right, bottom) = (frame.x + frame.width, frame.y + frame.height);
    for step in 0..=5 {
        let y = y_at(frame, f64::from(step) / 5.0);
        drawing.line((frame.x, y), (right, y), Stroke::new(GRID, 1.0));
    }
    drawing.line((frame.x, bottom), (right, bottom), Stroke::new(INK, 1.0));
    drawing.line((frame.x, frame.y), (frame.x, bottom), Stroke::new(INK, 1.0));
}

/// Ticks, numbers and title of the accuracy axis, left of a panel.
pub(in crate::report) fn draw_y_labels(drawing: &mut Drawing, frame: Area) {
    for step in 0..=5 {
        let accuracy = f64::from(step) / 5.0;
        let at = (frame.x - 9.0, y_at(frame, accuracy) + 4.5);
        let style = TextStyle::new(TICK_SIZE).align(Align::End);
        drawing.line(
            (frame.x - 5.0, at.1 - 4.5),
            (frame.x, at.1 - 4.5),
            Stroke::new(INK, 1.0),
        );
        drawing.text(at, &format!("{accuracy:.1}"), style);
    }
    let middle = (frame.x - 44.0, frame.y + frame.height / 2.0);
    let style = TextStyle::new(LABEL).align(Align::Middle).angle(-90.0);
    drawing.text(middle, "accuracy (share recognised)", style);
}

/// The interval between neighbouring points, shaded.
pub(in crate::report) fn draw_band(
    drawing: &mut Drawing,
    points: &[(f64, &CellScore)],
    frame: Area,
    fill: [u8; 3],
) {
    let lower = points
        .iter()
        .map(|(x, s)| (*x, y_at(frame, s.accuracy_low)));
    let upper = points
        .iter()
        .rev()
        .map(|(x, s)| (*x, y_at(frame, s.accuracy_high)));
    let corners: Vec<Point> = lower.chain(upper).collect();
    drawing.polygon(&corners, fill, 0.18);
}

/// The line through the points.
pub(in crate::report) fn draw_line(
    drawing: &mut Drawing,
    points: &[(f64, &CellScore)],
    frame: Area,
    line: usize,
) {
    let places: Vec<Point> = points
        .iter()
        .map(|(x, score)| (*x, y_at(frame, score.accuracy)))
        .collect();
    if places.len() > 1 {
        drawing.polyline(&places, line_stroke(line));
    }
}

/// A marker at each point.
pub(in crate::report) fn draw_markers(
    drawing: &mut Drawing,
    points: &[(f64, &CellScore)],
    frame: Area,
    line: usize,
) {
    for (x, score) in points {
        let place = (*x, y_at(frame, score.accuracy));
        drawing.marker(line, place, MARKER_RADIUS, line_colour(line));
    }
}

/// What accuracy a budget of time buys: level until the next cell of the front.
pub(in crate::report) fn draw_steps(drawing: &mut Drawing, front: &[Point], frame: Area) {
    let Some(&last) = front.last() else {
        return;
    };
    let mut steps = Vec::new();
    for pair in front.windows(2) {
        steps.extend([pair[0], (pair[1].0, pair[0].1)]);
    }
    steps.extend([last, (frame.x + frame.width, last.1)]);
    drawing.polyline(&steps, FRONT);
}

pub(in crate::report) fn paler(colour: Rgb) -> Rgb {
    colour.map(|channel| channel + ((255 - channel) as f64 * 0.45) as u8)
}
