//! Accuracy against a swept setting: lines with interval bands, side by side in panels.

use crate::report::chart_plan::ChartPlan;
use crate::report::colours::{GRID, INK, LINES, MUTED};
use crate::report::drawing::{Align, Area, Drawing, Point, Stroke, TextStyle};
use crate::report::text_width::{text_width, wrap};
use crate::report::varying::{Axis, AxisValue, Levels, Settings, unbroken_parts};
use crate::study::table::{Cell, CellScore, Tables};

const LEFT: f64 = 66.0;
const RIGHT: f64 = 18.0;
const GAP: f64 = 26.0;
const TITLE: u32 = 16;
const LABEL: u32 = 13;
const SMALL: u32 = 12;
const LINE_WIDTH: f64 = 2.0;
const MARKER_RADIUS: f64 = 4.2;

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
    let mut title = format!("Accuracy by {}", plan.x.axis.name());
    let others: Vec<&str> = [&plan.lines, &plan.panels]
        .into_iter()
        .flatten()
        .map(|levels| levels.axis.name())
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
        let (panel_width, panel_height) = match columns {
            1 => (660.0, 340.0),
            2 => (385.0, 300.0),
            _ => (272.0, 240.0),
        };
        let panel_rows = n_panels.div_ceil(columns);
        let width = LEFT + columns as f64 * panel_width + (columns - 1) as f64 * GAP + RIGHT;
        let heading = Heading::of(self, width);
        let panel_title = if self.plan.panels.is_some() {
            24.0
        } else {
            6.0
        };
        let any_panel = Area {
            x: 0.0,
            y: 0.0,
            width: panel_width,
            height: panel_height,
        };
        let has_second_row = XScale::of(&self.plan.x, any_panel).has_second_row();
        let labels_height = if has_second_row { 40.0 } else { 26.0 };
        let pitch_down = panel_title + panel_height + labels_height;
        let height = heading.height() + panel_rows as f64 * pitch_down + 26.0;
        let mut drawing = Drawing::new(width, height);
        heading.draw(&mut drawing);
        for panel in 0..n_panels {
            let (row, column) = (panel / columns, panel % columns);
            let frame = Area {
                x: LEFT + column as f64 * (panel_width + GAP),
                y: heading.height() + row as f64 * pitch_down + panel_title,
                width: panel_width,
                height: panel_height,
            };
            let last_in_column = panel + columns >= n_panels;
            self.draw_panel(&mut drawing, panel, frame);
            if column == 0 {
                draw_y_labels(&mut drawing, frame);
            }
            if last_in_column {
                let title = self.rows.first().map(|row| self.plan.x.axis.title(&row.0));
                let below = (
                    frame.x + frame.width / 2.0,
                    frame.y + frame.height + labels_height + 14.0,
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
            let stroke = Stroke {
                colour: MUTED,
                width: 1.2,
                dash: Some((5, 4)),
            };
            drawing.line((frame.x, y), (frame.x + frame.width, y), stroke);
        }
        let lines: Vec<Vec<(f64, &CellScore)>> = (0..self.n_lines())
            .map(|line| self.points(line, panel, &scale))
            .collect();
        for (line, points) in lines.iter().enumerate() {
            draw_band(drawing, points, frame, line_colour(line));
        }
        for (line, points) in lines.iter().enumerate() {
            draw_line(drawing, points, frame, line);
        }
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
        let mut points: Vec<(f64, &CellScore)> = self
            .rows
            .iter()
            .filter(|row| matches(&self.plan.lines, line, &row.0))
            .filter(|row| matches(&self.plan.panels, panel, &row.0))
            .filter_map(|row| Some((scale.x(&self.plan.x.axis.value(&row.0))?, &row.1)))
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points
    }
}

/// Title, fixed settings and legend, above the panels, so that nothing covers data.
struct Heading {
    title: Vec<String>,
    settings: Vec<String>,
    legend: Vec<Vec<LegendEntry>>,
}

struct LegendEntry {
    text: String,
    mark: Mark,
    width: f64,
}

enum Mark {
    None,
    Line(usize),
    Dashes,
    Band,
}

impl Heading {
    fn of(chart: &Chart, width: f64) -> Self {
        let inner = width - LEFT - RIGHT;
        let cells: Vec<&Cell> = chart.rows.iter().map(|row| &row.0).collect();
        let mut constants = Settings::of(&cells).fixed;
        constants.retain(|levels| {
            let stated = chart
                .plan
                .fixed
                .iter()
                .any(|(axis, _)| *axis == levels.axis);
            !stated && levels.axis != chart.plan.x.axis
        });
        let constants: Vec<String> = constants.iter().map(Levels::sentence).collect();
        Self {
            title: wrap(&chart_title(chart.plan), f64::from(TITLE) * 1.12, inner),
            settings: wrap(&unbroken_parts(&constants), f64::from(SMALL), inner),
            legend: flow(legend_entries(chart), inner),
        }
    }

    fn height(&self) -> f64 {
        16.0 + 21.0 * self.title.len() as f64
            + 17.0 * self.settings.len() as f64
            + 21.0 * self.legend.len() as f64
            + 10.0
    }

    fn draw(&self, drawing: &mut Drawing) {
        let mut y = 10.0;
        for line in &self.title {
            y += 21.0;
            drawing.bold_text((LEFT, y), line, TextStyle::new(TITLE));
        }
        for line in &self.settings {
            y += 17.0;
            drawing.text((LEFT, y), line, TextStyle::new(SMALL).colour(MUTED));
        }
        y += 4.0;
        for row in &self.legend {
            y += 21.0;
            let mut x = LEFT;
            for entry in row {
                entry.draw(drawing, (x, y));
                x += entry.width;
            }
        }
    }
}

fn legend_entries(chart: &Chart) -> Vec<LegendEntry> {
    let mut entries = Vec::new();
    if let Some(lines) = &chart.plan.lines {
        let name = format!("{}:", lines.heading());
        entries.push(LegendEntry::new(name, Mark::None));
        for (line, value) in lines.values.iter().enumerate() {
            entries.push(LegendEntry::new(value.label.clone(), Mark::Line(line)));
        }
    }
    entries.push(LegendEntry::new("95 % interval".to_owned(), Mark::Band));
    if let Some(chance) = chart.chance {
        let text = format!("chance (1 in {:.0})", 1.0 / chance);
        entries.push(LegendEntry::new(text, Mark::Dashes));
    }
    entries
}

impl LegendEntry {
    fn new(text: String, mark: Mark) -> Self {
        let mark_width = if matches!(mark, Mark::None) {
            0.0
        } else {
            34.0
        };
        let gap = if matches!(mark, Mark::None) {
            10.0
        } else {
            20.0
        };
        let width = mark_width + text_width(&text, f64::from(SMALL)) + gap;
        Self { text, mark, width }
    }

    fn draw(&self, drawing: &mut Drawing, (x, y): Point) {
        let middle = y - 4.5;
        let mut text_x = x + 34.0;
        match self.mark {
            Mark::None => text_x = x,
            Mark::Line(line) => {
                let stroke = line_stroke(line);
                drawing.line((x, middle), (x + 28.0, middle), stroke);
                drawing.marker(line, (x + 14.0, middle), MARKER_RADIUS, stroke.colour);
            }
            Mark::Dashes => {
                let stroke = Stroke {
                    colour: MUTED,
                    width: 1.2,
                    dash: Some((5, 4)),
                };
                drawing.line((x, middle), (x + 28.0, middle), stroke);
            }
            Mark::Band => {
                let (top, bottom) = (middle - 6.0, middle + 6.0);
                let corners = [(x, top), (x + 28.0, top), (x + 28.0, bottom), (x, bottom)];
                drawing.polygon(&corners, MUTED, 0.25);
            }
        }
        drawing.text((text_x, y), &self.text, TextStyle::new(SMALL));
    }
}

/// Entries in rows no wider than `width`.
fn flow(entries: Vec<LegendEntry>, width: f64) -> Vec<Vec<LegendEntry>> {
    let mut rows: Vec<Vec<LegendEntry>> = Vec::new();
    let mut used = f64::INFINITY;
    for entry in entries {
        if used + entry.width > width + 20.0 {
            rows.push(Vec::new());
            used = 0.0;
        }
        used += entry.width;
        if let Some(row) = rows.last_mut() {
            row.push(entry);
        }
    }
    rows
}

/// Where the values of the x axis stand.
struct XScale {
    ticks: Vec<(AxisValue, f64)>,
    /// For each tick the row of labels in which it finds room: 0, 1 below it, or none.
    label_rows: Vec<Option<usize>>,
}

impl XScale {
    /// Numbers stand on a logarithmic axis where ratios are what matters, words at equal distances.
    fn of(levels: &Levels, frame: Area) -> Self {
        let places: Vec<f64> = match levels.numbers() {
            Some(numbers) if is_logarithmic(levels.axis, &numbers) => {
                numbers.iter().map(|number| number.ln()).collect()
            }
            Some(numbers) => numbers,
            None => (0..levels.values.len()).map(|i| i as f64).collect(),
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

    fn has_second_row(&self) -> bool {
        self.label_rows.contains(&Some(1))
    }

    fn x(&self, value: &AxisValue) -> Option<f64> {
        let tick = self.ticks.iter().find(|(tick, _)| tick == value);
        tick.map(|(_, x)| *x)
    }
}

fn label_rows(ticks: &[(AxisValue, f64)]) -> Vec<Option<usize>> {
    let mut free_from = [f64::NEG_INFINITY; 2];
    let mut rows = Vec::new();
    for (value, x) in ticks {
        let half = text_width(&value.tick, f64::from(SMALL)) / 2.0;
        let row = (0..2).find(|&row| x - half > free_from[row]);
        if let Some(row) = row {
            free_from[row] = x + half + 6.0;
        }
        rows.push(row);
    }
    rows
}

fn is_logarithmic(axis: Axis, numbers: &[f64]) -> bool {
    let by_nature = matches!(
        axis,
        Axis::Ratio | Axis::Measurements | Axis::C | Axis::TrainTouches
    );
    by_nature && numbers.iter().all(|&number| number > 0.0)
}

fn y_at(frame: Area, accuracy: f64) -> f64 {
    frame.y + frame.height * (1.0 - accuracy.clamp(0.0, 1.0))
}

fn draw_grid(drawing: &mut Drawing, scale: &XScale, frame: Area) {
    let bottom = frame.y + frame.height;
    for step in 0..=5 {
        let y = y_at(frame, f64::from(step) / 5.0);
        drawing.line(
            (frame.x, y),
            (frame.x + frame.width, y),
            Stroke::new(GRID, 1.0),
        );
    }
    for ((value, x), row) in scale.ticks.iter().zip(&scale.label_rows) {
        drawing.line((*x, frame.y), (*x, bottom), Stroke::new(GRID, 1.0));
        drawing.line((*x, bottom), (*x, bottom + 5.0), Stroke::new(INK, 1.0));
        if let Some(row) = row {
            let below = (*x, bottom + 19.0 + 14.0 * *row as f64);
            let style = TextStyle::new(SMALL).align(Align::Middle);
            drawing.text(below, &value.tick, style);
        }
    }
    drawing.line(
        (frame.x, bottom),
        (frame.x + frame.width, bottom),
        Stroke::new(INK, 1.0),
    );
    drawing.line((frame.x, frame.y), (frame.x, bottom), Stroke::new(INK, 1.0));
}

fn draw_y_labels(drawing: &mut Drawing, frame: Area) {
    for step in 0..=5 {
        let accuracy = f64::from(step) / 5.0;
        let at = (frame.x - 9.0, y_at(frame, accuracy) + 4.5);
        let style = TextStyle::new(SMALL).align(Align::End);
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

fn draw_band(drawing: &mut Drawing, points: &[(f64, &CellScore)], frame: Area, fill: [u8; 3]) {
    match points {
        [] => {}
        [(x, score)] => {
            let (low, high) = (
                y_at(frame, score.accuracy_low),
                y_at(frame, score.accuracy_high),
            );
            let corners = [
                (x - 7.0, low),
                (x + 7.0, low),
                (x + 7.0, high),
                (x - 7.0, high),
            ];
            drawing.polygon(&corners, fill, 0.18);
        }
        _ => {
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
    }
}

fn draw_line(drawing: &mut Drawing, points: &[(f64, &CellScore)], frame: Area, line: usize) {
    let stroke = line_stroke(line);
    let places: Vec<Point> = points
        .iter()
        .map(|(x, score)| (*x, y_at(frame, score.accuracy)))
        .collect();
    drawing.polyline(&places, stroke);
    for place in places {
        drawing.marker(line, place, MARKER_RADIUS, stroke.colour);
    }
}

fn line_colour(line: usize) -> [u8; 3] {
    LINES[line % LINES.len()]
}

/// Beyond the palette, colours come again with dashes.
fn line_stroke(line: usize) -> Stroke {
    let dash = match line / LINES.len() {
        0 => None,
        1 => Some((7, 3)),
        _ => Some((2, 3)),
    };
    Stroke {
        colour: line_colour(line),
        width: LINE_WIDTH,
        dash,
    }
}

fn named(axis: Axis, value: &AxisValue) -> String {
    match axis {
        Axis::Ensemble | Axis::Classifier => value.label.clone(),
        _ => format!("{} {}", axis.name(), value.label),
    }
}
