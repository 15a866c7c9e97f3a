//! Accuracy against a swept setting: lines with interval bands, side by side in panels.

use crate::report::axis::{Axis, AxisValue};
use crate::report::chart_plan::ChartPlan;
use crate::report::colours::{GRID, INK};
use crate::report::drawing::{Align, Area, Drawing, Point, Stroke, TextStyle};
use crate::report::legend::{
    CHANCE, Heading, LegendEntry, MARKER_RADIUS, Mark, line_colour, line_entries, line_stroke,
};
use crate::report::panels::Panels;
use crate::report::varying::{Levels, Settings, unbroken_parts};
use crate::report::x_scale::{TICK_SIZE, XScale};
use crate::study::table::{Cell, CellScore, Tables};

const LABEL: u32 = 13;
/// Lines up to which bands do not hide each other; more lines get a whisker at each point.
const MOST_BANDS: usize = 4;

/// How many different objects the confusion table knows: chance is one in so many.
pub fn n_classes(tables: &Tables) -> usize {
    let mut names: Vec<&str> = tables.confusion.iter().map(|c| c.object.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    names.len()
}

/// Draws one planned chart of the summary table.
pub fn draw_chart(plan: &ChartPlan, tables: &Tables) -> Drawing {
    let rows: Vec<&(Cell, CellScore)> = tables
        .summary
        .iter()
        .filter(|(cell, _)| plan.shows(cell))
        .collect();
    let n_classes = n_classes(tables);
    let chart = Chart {
        plan,
        rows: &rows,
        chance: (n_classes > 0).then(|| 1.0 / n_classes as f64),
    };
    chart.draw()
}

/// What a chart is read as: `accuracy by compression, by pitch and array size (noise 10 % of full scale)`.
pub fn chart_title(plan: &ChartPlan) -> String {
    let along = plan.x.axis.name();
    let mut title = format!("Accuracy by {along}");
    let others: Vec<&str> = [&plan.lines, &plan.panels]
        .into_iter()
        .flatten()
        .map(|levels| match levels.axis {
            Axis::Features => "kind of features",
            Axis::Frames => "number of frames",
            Axis::OverTime => "kind of features over time",
            axis => axis.name(),
        })
        .collect();
    if !others.is_empty() {
        title += &format!(", for each {}", others.join(" and "));
    }
    if !plan.fixed.is_empty() {
        let fixed: Vec<String> = plan.fixed.iter().map(|(a, v)| named(*a, v)).collect();
        title += &format!(" ({})", fixed.join(", "));
    }
    title
}

struct Chart<'a> {
    plan: &'a ChartPlan,
    rows: &'a [&'a (Cell, CellScore)],
    chance: Option<f64>,
}

impl Chart<'_> {
    fn draw(&self) -> Drawing {
        let n_panels = self.plan.panels.as_ref().map_or(1, |p| p.values.len());
        let columns = match n_panels {
            1 | 2 => n_panels,
            4 => 2,
            _ => 3,
        };
        let above = match self.plan.panels {
            Some(_) => 24.0,
            None => 6.0,
        };
        let mut panels = Panels::new(n_panels, columns, above, 26.0);
        let any_panel = Area {
            x: 0.0,
            ..panels.frame(0, 0.0)
        };
        if XScale::of(&self.plan.x, any_panel).has_second_row() {
            panels.below = 40.0;
        }
        let heading = Heading::of(
            &chart_title(self.plan),
            &self.constants(),
            self.legend_entries(),
            panels.width(),
        );
        let top = heading.height();
        let mut drawing = Drawing::new(panels.width(), panels.bottom(top));
        heading.draw(&mut drawing);
        for panel in 0..n_panels {
            let frame = panels.frame(panel, top);
            self.draw_panel(&mut drawing, panel, frame);
            if panels.is_first_in_row(panel) {
                draw_y_labels(&mut drawing, frame);
            }
            if panels.is_last_in_column(panel) {
                let title = self.rows.first().map(|row| self.plan.x.axis.title(&row.0));
                let below = (
                    frame.x + frame.width / 2.0,
                    frame.y + frame.height + panels.below + 14.0,
                );
                let style = TextStyle::new(LABEL).align(Align::Middle);
                drawing.text(below, &title.unwrap_or_default(), style);
            }
        }
        drawing
    }

    fn draw_panel(&self, drawing: &mut Drawing, panel: usize, frame: Area) {
        let panel_value = self
            .plan
            .panels
            .as_ref()
            .map(|p| (p.axis, &p.values[panel]));
        if let Some((axis, value)) = panel_value {
            let above = (frame.x, frame.y - 8.0);
            drawing.bold_text(above, &named(axis, value), TextStyle::new(LABEL));
        }
        let scale = XScale::of(&self.plan.x, frame);
        draw_grid(drawing, &scale, frame);
        if let Some(chance) = self.chance {
            let y = y_at(frame, chance);
            drawing.line((frame.x, y), (frame.x + frame.width, y), CHANCE);
        }
        let lines: Vec<Vec<(f64, &CellScore)>> = (0..self.n_lines())
            .map(|line| self.points(line, panel, &scale))
            .collect();
        for (line, points) in lines.iter().enumerate() {
            match self.has_bands() && points.len() > 1 {
                true => draw_band(drawing, points, frame, line_colour(line)),
                false => draw_whiskers(drawing, points, frame, line_stroke(line)),
            }
        }
        for (line, points) in lines.iter().enumerate() {
            if self.has_numbers_along_x() {
                draw_line(drawing, points, frame, line);
            }
            draw_markers(drawing, points, frame, line);
        }
    }

    /// Between words there is nothing, so nothing is drawn there: neither lines nor bands.
    fn has_numbers_along_x(&self) -> bool {
        self.plan.x.numbers().is_some()
    }

    fn has_bands(&self) -> bool {
        self.has_numbers_along_x() && self.n_lines() <= MOST_BANDS
    }

    fn n_lines(&self) -> usize {
        self.plan.lines.as_ref().map_or(1, |l| l.values.len())
    }

    /// The cells of one line in one panel, along x.
    fn points(&self, line: usize, panel: usize, scale: &XScale) -> Vec<(f64, &CellScore)> {
        let matches = |levels: &Option<Levels>, index: usize, cell: &Cell| match levels {
            Some(levels) => levels.axis.value(cell) == levels.values[index],
            None => true,
        };
        // Whiskers of different lines stand beside each other: on a numeric axis so little that no value seems to change.
        let n_lines = self.n_lines() as f64;
        let step = match (self.has_bands(), self.has_numbers_along_x()) {
            (true, _) => 0.0,
            (false, true) => f64::min(2.0, 14.0 / n_lines),
            (false, false) => f64::min(12.0, 60.0 / n_lines),
        };
        let beside = step * (line as f64 - 0.5 * (n_lines - 1.0));
        let mut points: Vec<(f64, &CellScore)> = self
            .rows
            .iter()
            .filter(|row| matches(&self.plan.lines, line, &row.0))
            .filter(|row| matches(&self.plan.panels, panel, &row.0))
            .filter_map(|row| Some((scale.x(&self.plan.x.axis.value(&row.0))? + beside, &row.1)))
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points
    }

    /// Settings that stay in the chart and stand neither in its title nor along x.
    fn constants(&self) -> String {
        let cells: Vec<&Cell> = self.rows.iter().map(|row| &row.0).collect();
        let mut constants = Settings::of(&cells).fixed;
        constants.retain(|levels| {
            let mut stated = self.plan.fixed.iter();
            !stated.any(|(axis, _)| *axis == levels.axis) && levels.axis != self.plan.x.axis
        });
        let constants: Vec<String> = constants.iter().map(Levels::sentence).collect();
        unbroken_parts(&constants)
    }

    fn legend_entries(&self) -> Vec<LegendEntry> {
        let mut entries = Vec::new();
        if let Some(lines) = &self.plan.lines {
            let name = format!("{}:", lines.heading());
            entries.push(LegendEntry::new(name, Mark::None));
            entries.extend(line_entries(lines.values.iter().map(|v| v.label.as_str())));
        }
        let interval = if self.has_bands() {
            Mark::Band
        } else {
            Mark::Whisker
        };
        entries.push(LegendEntry::new("95 % interval".to_owned(), interval));
        if let Some(chance) = self.chance {
            let text = format!("chance (1 in {:.0})", 1.0 / chance);
            entries.push(LegendEntry::new(text, Mark::Dashes));
        }
        entries
    }
}

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

fn draw_grid(drawing: &mut Drawing, scale: &XScale, frame: Area) {
    let bottom = frame.y + frame.height;
    for ((value, x), row) in scale.ticks.iter().zip(&scale.label_rows) {
        drawing.line((*x, frame.y), (*x, bottom), Stroke::new(GRID, 1.0));
        drawing.line((*x, bottom), (*x, bottom + 5.0), Stroke::new(INK, 1.0));
        if let Some(row) = row {
            let below = (*x, bottom + 19.0 + 14.0 * *row as f64);
            let style = TextStyle::new(TICK_SIZE).align(Align::Middle);
            drawing.text(below, &value.tick, style);
        }
    }
    draw_axes(drawing, frame);
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

/// The interval of each point, as a bar.
fn draw_whiskers(drawing: &mut Drawing, points: &[(f64, &CellScore)], frame: Area, line: Stroke) {
    let stroke = Stroke::new(line.colour, 1.5);
    for (x, score) in points {
        let (low, high) = (
            y_at(frame, score.accuracy_low),
            y_at(frame, score.accuracy_high),
        );
        drawing.line((*x, low), (*x, high), stroke);
    }
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

fn named(axis: Axis, value: &AxisValue) -> String {
    match axis {
        Axis::Ensemble | Axis::Classifier | Axis::OverTime => value.label.clone(),
        Axis::Features => format!("{} features", value.label),
        Axis::Frames if value.label == "1" => "1 frame a touch".to_owned(),
        Axis::FusedTouches if value.label == "1" => "a touch alone".to_owned(),
        Axis::Frames | Axis::FusedTouches => format!("{} {}", value.label, axis.name()),
        Axis::TestedOn => format!("tested on {}", value.label),
        _ => format!("{} {}", axis.name(), value.label),
    }
}
