//! Charts of a study of breaking points: accuracy along each way, and where it is half of its best.

use super::chart::{draw_axes, draw_band, draw_line, draw_markers, draw_y_labels, y_at};
use super::legend::{CHANCE, Heading, LegendEntry, Mark, line_colour};
use super::panels::Panels;
use super::text_width::{text_width, wrap};
use crate::recognition::ClassifierKind;
use crate::report::axis::{classifier_name, short_number};
use crate::report::colours::{GRID, INK, PAPER};
use crate::report::drawing::{Align, Area, Drawing, Stroke, TextStyle};
use crate::study::breaking_points::table::{BreakingPoint, BreakingPointsTables, CellScore};
use crate::study::breaking_points::{DrivenTouches, PlannedWay, WayScale};

const TICK: f64 = 12.0;
/// Charts side by side in the picture of all ways.
const COLUMNS: usize = 3;

/// A chart of all ways, then one a way: file name without ending, title, drawing.
pub fn draw_breaking_points(
    ways: &[PlannedWay],
    tables: &BreakingPointsTables,
) -> Vec<(String, String, Drawing)> {
    let charts: Vec<WayChart> = ways.iter().map(|way| WayChart::of(way, tables)).collect();
    let mut drawn = vec![all_ways(&charts)];
    drawn.extend(charts.iter().map(WayChart::draw));
    drawn
}

/// Everything that one panel shows.
struct WayChart<'a> {
    way: &'a PlannedWay,
    lines: Vec<(ClassifierKind, Vec<&'a CellScore>)>,
    breaks: Vec<&'a BreakingPoint>,
}

/// All ways in one picture.
fn all_ways(charts: &[WayChart]) -> (String, String, Drawing) {
    let title = "Accuracy as each setting is driven until recognition breaks".to_owned();
    let columns = charts.len().min(COLUMNS);
    let panels = Panels::new(charts.len(), columns, 16.0, 64.0);
    let settings = "One setting at a time; all others stay as the study has them. A triangle and a dotted line: down to half of the \
                    best accuracy, the bar being the 95 % interval of that place.";
    let mut entries: Vec<LegendEntry> = Vec::new();
    let mut kinds: Vec<ClassifierKind> = Vec::new();
    for kind in charts.iter().flat_map(WayChart::kinds) {
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    for (line, &kind) in kinds.iter().enumerate() {
        entries.push(LegendEntry::new(
            classifier_name(kind).to_owned(),
            Mark::Line(line),
        ));
    }
    entries.extend(common_entries());
    let heading = Heading::of(&title, settings, entries, panels.width());
    let top = heading.height();
    let mut drawing = Drawing::new(panels.width(), panels.bottom(top));
    heading.draw(&mut drawing);
    for (panel, chart) in charts.iter().enumerate() {
        let frame = panels.frame(panel, top);
        chart.draw_panel(&mut drawing, frame, &kinds);
        if panels.is_first_in_row(panel) {
            draw_y_labels(&mut drawing, frame);
        }
    }
    ("breaking_points".to_owned(), title, drawing)
}

fn common_entries() -> [LegendEntry; 2] {
    [
        LegendEntry::new("95 % interval".to_owned(), Mark::Band),
        LegendEntry::new("chance".to_owned(), Mark::Dashes),
    ]
}

impl<'a> WayChart<'a> {
    fn of(way: &'a PlannedWay, tables: &'a BreakingPointsTables) -> Self {
        let mut lines: Vec<(ClassifierKind, Vec<&CellScore>)> = Vec::new();
        let rows = tables.summary.iter().filter(|row| row.0.way == way.name);
        for (cell, score) in rows {
            match lines.iter_mut().find(|line| line.0 == cell.classifier) {
                Some(line) => line.1.push(score),
                None => lines.push((cell.classifier, vec![score])),
            }
        }
        let breaks = tables.breaking_points.iter();
        Self {
            way,
            lines,
            breaks: breaks.filter(|row| row.way == way.name).collect(),
        }
    }

    fn kinds(&self) -> impl Iterator<Item = ClassifierKind> {
        self.lines.iter().map(|line| line.0)
    }

    fn draw(&self) -> (String, String, Drawing) {
        let title = format!("Accuracy by {}", self.way.label);
        let panels = Panels::new(1, 1, 6.0, 40.0);
        let touches = match self.way.touches {
            DrivenTouches::All => "training and test touches have it alike",
            DrivenTouches::Training => "training touches have it; what is tested stays as it was",
            DrivenTouches::Test => "test touches have it; what is learned stays as it was",
        };
        let settings = format!("{}; {touches}", self.size());
        let kinds: Vec<ClassifierKind> = self.kinds().collect();
        let mut entries: Vec<LegendEntry> = Vec::new();
        for (line, &kind) in kinds.iter().enumerate() {
            let words = format!("{}: {}", classifier_name(kind), self.words(kind));
            entries.push(LegendEntry::new(words, Mark::Line(line)));
        }
        entries.extend(common_entries());
        let heading = Heading::of(&title, &settings, entries, panels.width());
        let top = heading.height();
        let mut drawing = Drawing::new(panels.width(), panels.bottom(top));
        heading.draw(&mut drawing);
        let frame = panels.frame(0, top);
        self.draw_panel(&mut drawing, frame, &kinds);
        draw_y_labels(&mut drawing, frame);
        (self.way.name.clone(), title, drawing)
    }

    /// `38 objects, 1520 test touches a trial, 3 trials`.
    fn size(&self) -> String {
        let score = self.lines.first().and_then(|line| line.1.first());
        let chance = self.breaks.first().map_or(1.0, |row| row.chance);
        let (n_test, n_trials) = score.map_or((0, 0), |score| (score.n_test, score.n_trials));
        format!(
            "{:.0} objects, {n_test} test touches a trial, {n_trials} trials",
            1.0 / chance
        )
    }

    /// Where a classifier breaks: `half of its best at 0.53 (0.48 to 0.6)`.
    fn words(&self, kind: ClassifierKind) -> String {
        let of_kind = self.breaks.iter().filter(|row| row.classifier == kind);
        let reached: Vec<String> = of_kind.filter_map(|row| break_words(row)).collect();
        match reached.is_empty() {
            true => "half of its best is not reached".to_owned(),
            false => format!("half of its best at {}", reached.join(" and ")),
        }
    }

    fn draw_panel(&self, drawing: &mut Drawing, frame: Area, kinds: &[ClassifierKind]) {
        let scale = PanelScale::of(self.way, frame);
        scale.draw_ticks(drawing, frame);
        draw_axes(drawing, frame);
        scale.draw_gap(drawing, frame);
        let style = TextStyle::new(12).align(Align::Middle);
        for (row, line) in wrap(&self.way.label, TICK, frame.width).iter().enumerate() {
            let below = frame.y + frame.height + 37.0 + 15.0 * row as f64;
            drawing.text((frame.x + frame.width / 2.0, below), line, style);
        }
        if let Some(row) = self.breaks.first() {
            let y = y_at(frame, row.chance);
            drawing.line((frame.x, y), (frame.x + frame.width, y), CHANCE);
        }
        let number = |kind| kinds.iter().position(|&k| k == kind).unwrap_or(0);
        let lines: Vec<(usize, Vec<(f64, &CellScore)>)> = self
            .lines
            .iter()
            .map(|(kind, scores)| {
                let values = self.way.values.iter().zip(scores);
                let points = values.map(|(planned, score)| (scale.x(planned.value), *score));
                (number(*kind), points.collect())
            })
            .collect();
        for (line, points) in &lines {
            draw_band(drawing, points, frame, line_colour(*line));
        }
        for row in &self.breaks {
            draw_break(drawing, frame, &scale, row, number(row.classifier));
        }
        for (line, points) in &lines {
            draw_line(drawing, points, frame, *line);
            draw_markers(drawing, points, frame, *line);
        }
        self.let_ask(drawing, frame, (&scale, kinds));
    }

    /// Every point, with its interval.
    fn let_ask(
        &self,
        drawing: &mut Drawing,
        frame: Area,
        (scale, kinds): (&PanelScale, &[ClassifierKind]),
    ) {
        for (kind, scores) in &self.lines {
            let line = kinds.iter().position(|k| k == kind).unwrap_or(0);
            for (planned, score) in self.way.values.iter().zip(scores) {
                let at = (scale.x(planned.value), y_at(frame, score.accuracy));
                let title = format!(
                    "{}, {} {}",
                    classifier_name(*kind),
                    self.way.label,
                    short_number(planned.value)
                );
                let interval = format!(
                    "accuracy {:.3} ({:.3} to {:.3})",
                    score.accuracy, score.accuracy_low, score.accuracy_high
                );
                drawing.ask(at, line, title, vec![interval]);
            }
        }
    }
}

/// `0.53 (0.48 to 0.6)`; none if it does not break.
pub(super) fn break_words(row: &BreakingPoint) -> Option<String> {
    let at = row.breaks_at?;
    let end = |end: Option<f64>| end.map_or("beyond".to_owned(), short_number_rounded);
    Some(format!(
        "{} ({} to {})",
        short_number_rounded(at),
        end(row.breaks_at_low),
        end(row.breaks_at_high)
    ))
}

/// Three digits: interpolated places have no more.
pub(super) fn short_number_rounded(value: f64) -> String {
    let digits = 10f64.powi(2 - value.abs().max(f64::MIN_POSITIVE).log10().floor() as i32);
    short_number((value * digits).round() / digits)
}

/// The place, a line down to its value, and its interval.
fn draw_break(
    drawing: &mut Drawing,
    frame: Area,
    scale: &PanelScale,
    row: &BreakingPoint,
    line: usize,
) {
    let Some(at) = row.breaks_at else { return };
    let (x, y, bottom) = (scale.x(at), y_at(frame, row.half), frame.y + frame.height);
    let colour = line_colour(line);
    let dots = Stroke {
        dash: Some((2, 3)),
        ..Stroke::new(colour, 1.4)
    };
    drawing.line((x, y), (x, bottom), dots);
    let (first, last) = (frame.x, frame.x + frame.width);
    let low = row.breaks_at_low.map_or(first, |value| scale.x(value));
    let high = row.breaks_at_high.map_or(last, |value| scale.x(value));
    drawing.line((low, y), (high, y), Stroke::new(colour, 3.5));
    let triangle = [
        (x, bottom - 1.0),
        (x - 5.0, bottom - 10.0),
        (x + 5.0, bottom - 10.0),
    ];
    drawing.polygon(&triangle, colour, 1.0);
}

/// Where the values of a way stand in a panel.
struct PanelScale {
    scale: WayScale,
    /// The smallest positive value.
    start: f64,
    values: Vec<f64>,
    /// Places of the first and of the last value.
    ends: (f64, f64),
    /// Their pixels.
    pixels: (f64, f64),
}

impl PanelScale {
    fn of(way: &PlannedWay, frame: Area) -> Self {
        let values: Vec<f64> = way.values.iter().map(|planned| planned.value).collect();
        let start = WayScale::start(values.iter().copied());
        let place = |value: Option<&f64>| way.scale.place(*value.unwrap_or(&0.0), start);
        let margin = 0.05 * frame.width;
        Self {
            scale: way.scale,
            start,
            ends: (place(values.first()), place(values.last())),
            pixels: (frame.x + margin, frame.x + frame.width - margin),
            values,
        }
    }

    fn x(&self, value: f64) -> f64 {
        let (first, last) = self.ends;
        let part = (self.scale.place(value, self.start) - first) / (last - first);
        self.pixels.0 + part * (self.pixels.1 - self.pixels.0)
    }

    /// Ticks at the values; of labels that would touch, powers of ten come first, then those more to the left.
    fn draw_ticks(&self, drawing: &mut Drawing, frame: Area) {
        let bottom = frame.y + frame.height;
        let is_round = |value: f64| (value.log10() - value.log10().round()).abs() < 1e-9;
        let ends = [self.values.first(), self.values.last()];
        let mut order: Vec<f64> = ends.into_iter().flatten().copied().collect();
        order.extend(self.values.iter().copied().filter(|&value| is_round(value)));
        order.extend(self.values.iter().copied());
        let mut taken: Vec<(f64, f64)> = Vec::new();
        for value in order {
            let x = self.x(value);
            let text = short_number(value);
            let half = text_width(&text, TICK) / 2.0 + 4.0;
            if taken
                .iter()
                .any(|&(from, to)| x + half > from && x - half < to)
            {
                continue;
            }
            taken.push((x - half, x + half));
            drawing.line((x, frame.y), (x, bottom), Stroke::new(GRID, 1.0));
            let style = TextStyle::new(12).align(Align::Middle);
            drawing.text((x, bottom + 19.0), &text, style);
        }
        for &value in &self.values {
            let x = self.x(value);
            drawing.line((x, bottom), (x, bottom + 4.0), Stroke::new(INK, 1.0));
        }
    }

    /// A gap in the axis between zero and the first decade.
    fn draw_gap(&self, drawing: &mut Drawing, frame: Area) {
        if self.scale == WayScale::Linear || self.values.first() != Some(&0.0) {
            return;
        }
        let bottom = frame.y + frame.height;
        let x = 0.5 * (self.x(0.0) + self.x(self.start));
        drawing.line(
            (x - 2.5, bottom),
            (x + 2.5, bottom),
            Stroke::new(PAPER, 3.0),
        );
        for side in [-2.5, 2.5] {
            let (from, to) = (
                (x + side - 2.0, bottom + 5.0),
                (x + side + 2.0, bottom - 5.0),
            );
            drawing.line(from, to, Stroke::new(INK, 1.0));
        }
    }
}
