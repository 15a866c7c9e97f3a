//! Pixels of a chart: heading above, panels below it side by side and row by row, ticks and titles around each.

use super::rules;
use super::scale::{Scale, Tick, thin};
use super::view::View;
use crate::report::colours::{GRID, INK, MUTED};
use crate::report::drawing::{Align, Area, Drawing, Stroke, TextStyle};
use crate::report::legend::{Heading, LEFT, LegendEntry, RIGHT, dashes};
use crate::report::text_width::{shorten, text_width, wrap};

/// Letters of tick labels.
pub(super) const TICK: f64 = 12.0;
/// Letters of titles.
const LABEL: u32 = 13;
/// Pixels between panels.
const GAP: f64 = 26.0;
/// Letters of a word beside a row, pixels.
const WIDEST: f64 = 230.0;
/// Letters of a turned word below a column, pixels.
const DEEPEST: f64 = 160.0;
/// Lines of a word below a column.
const MOST_LINES: usize = 3;

/// Where panels stand.
pub(super) struct Layout {
    columns: usize,
    n_panels: usize,
    /// Pixels across and down of one.
    size: (f64, f64),
    /// Left of the first.
    left: f64,
    /// Pixels above the first row, for what its columns have in common.
    pub first: f64,
    /// Pixels above and below each.
    above: f64,
    below: f64,
    heading: Heading,
}

impl Layout {
    /// Of panels of a size in so many columns, `above` pixels for what stands over each.
    pub fn of(
        view: &View,
        entries: Vec<LegendEntry>,
        (n_panels, columns): (usize, usize),
        size: (f64, f64),
        above: f64,
    ) -> Self {
        let labels = view
            .y
            .ticks
            .iter()
            .map(|tick| text_width(&tick.label, TICK).min(WIDEST));
        let left = f64::max(LEFT, 44.0 + labels.fold(0.0, f64::max));
        let below = below(&view.x, size.0);
        let spec = view.spec;
        let settings = [&spec.note[..], &view.constants()].join(" ");
        let columns_width = columns as f64 * (size.0 + GAP) - GAP;
        let width = f64::max(left + columns_width + RIGHT, 560.0);
        Self {
            columns,
            n_panels,
            size,
            left,
            first: 0.0,
            above,
            below,
            heading: Heading::of(&spec.title, settings.trim(), entries, width),
        }
    }

    pub fn width(&self) -> f64 {
        let panels = self.columns as f64 * (self.size.0 + GAP) - GAP;
        f64::max(self.left + panels + RIGHT, 560.0)
    }

    /// Where the last title ends.
    pub fn bottom(&self) -> f64 {
        self.top() + self.n_panels.div_ceil(self.columns) as f64 * self.pitch() + 26.0
    }

    /// Where the first row begins.
    fn top(&self) -> f64 {
        self.heading.height() + self.first
    }

    fn pitch(&self) -> f64 {
        self.above + self.size.1 + self.below
    }

    pub fn frame(&self, panel: usize) -> Area {
        let (row, column) = (panel / self.columns, panel % self.columns);
        Area {
            x: self.left + column as f64 * (self.size.0 + GAP),
            y: self.top() + row as f64 * self.pitch() + self.above,
            width: self.size.0,
            height: self.size.1,
        }
    }

    pub fn is_first_in_row(&self, panel: usize) -> bool {
        panel.is_multiple_of(self.columns)
    }

    fn is_last_in_column(&self, panel: usize) -> bool {
        panel + self.columns >= self.n_panels
    }

    /// The heading.
    pub fn draw_heading(&self, drawing: &mut Drawing) {
        self.heading.draw(drawing);
    }

    /// Grid, ticks, labels and titles of a panel, and its rules.
    pub fn draw_axes(&self, drawing: &mut Drawing, view: &View, panel: usize, has_grid: bool) {
        let frame = self.frame(panel);
        let (right, bottom) = (frame.x + frame.width, frame.y + frame.height);
        let ink = Stroke::new(INK, 1.0);
        for (tick, label) in view.x.ticks.iter().zip(x_labels(&view.x, frame.width)) {
            let x = frame.x + tick.at * frame.width;
            if has_grid {
                drawing.line((x, frame.y), (x, bottom), Stroke::new(GRID, 1.0));
                drawing.line((x, bottom), (x, bottom + 5.0), ink);
            }
            if is_turned(&view.x, frame.width) {
                let style = TextStyle::new(TICK as u32).align(Align::End).angle(-90.0);
                let text = shorten(&tick.label, TICK, DEEPEST);
                drawing.text((x + 4.0, bottom + 8.0), &text, style);
                continue;
            }
            for (line, text) in label.into_iter().flatten().enumerate() {
                let below = (x, bottom + 19.0 + 14.0 * line as f64);
                drawing.text(
                    below,
                    &text,
                    TextStyle::new(TICK as u32).align(Align::Middle),
                );
            }
        }
        let half = 7.0 / frame.height;
        for (tick, is_labelled) in view.y.ticks.iter().zip(thin(&view.y.ticks, |_| half)) {
            let y = frame.y + (1.0 - tick.at) * frame.height;
            if has_grid {
                drawing.line((frame.x, y), (right, y), Stroke::new(GRID, 1.0));
            }
            if is_labelled && self.is_first_in_row(panel) {
                if has_grid {
                    drawing.line((frame.x - 5.0, y), (frame.x, y), ink);
                }
                let style = TextStyle::new(TICK as u32).align(Align::End);
                let text = shorten(&tick.label, TICK, WIDEST);
                drawing.text((frame.x - 9.0, y + 4.5), &text, style);
            }
        }
        if has_grid {
            self.draw_shelves(drawing, view, frame);
            drawing.line((frame.x, bottom), (right, bottom), ink);
            drawing.line((frame.x, frame.y), (frame.x, bottom), ink);
        }
        let style = TextStyle::new(LABEL).align(Align::Middle);
        if self.is_last_in_column(panel) {
            let below = (frame.x + frame.width / 2.0, bottom + self.below + 14.0);
            for (line, text) in wrap(&view.x.title, f64::from(LABEL), frame.width + GAP)
                .iter()
                .take(2)
                .enumerate()
            {
                drawing.text((below.0, below.1 + 15.0 * line as f64 - 2.0), text, style);
            }
        }
        if self.is_first_in_row(panel) {
            // Rows of few tiles have one title for all.
            let (first, last) = match has_grid {
                true => (frame, frame),
                false => (self.frame(0), self.frame(self.n_panels - 1)),
            };
            let (top, bottom) = (first.y, last.y + last.height);
            let text = shorten(&view.y.title, f64::from(LABEL), bottom - top + 40.0);
            if has_grid || panel == 0 {
                drawing.text((16.0, 0.5 * (top + bottom)), &text, style.angle(-90.0));
            }
        }
        rules::draw(drawing, view, panel, frame);
    }

    /// A line between zero and the decades of a logarithmic axis.
    fn draw_shelves(&self, drawing: &mut Drawing, view: &View, frame: Area) {
        if let Some(part) = view.x.shelf() {
            let x = frame.x + part * frame.width;
            drawing.line((x, frame.y), (x, frame.y + frame.height), dashes(1.0));
        }
        if let Some(part) = view.y.shelf() {
            let y = frame.y + (1.0 - part) * frame.height;
            drawing.line((frame.x, y), (frame.x + frame.width, y), dashes(1.0));
        }
    }

    /// What a panel is, so many pixels above it.
    pub fn draw_title(&self, drawing: &mut Drawing, panel: usize, text: &str, up: f64) {
        let frame = self.frame(panel);
        let lines = wrap(text, 1.12 * f64::from(LABEL), frame.width);
        for (line, text) in lines.iter().rev().enumerate() {
            let at = (frame.x, frame.y - up - 16.0 * line as f64);
            drawing.bold_text(at, text, TextStyle::new(LABEL));
        }
    }

    /// What a row of panels has in common, above it.
    pub fn draw_row_title(&self, drawing: &mut Drawing, panel: usize, text: &str) {
        let frame = self.frame(panel);
        drawing.text(
            (frame.x, frame.y - 6.0),
            text,
            TextStyle::new(12).colour(MUTED),
        );
    }
}

/// Whether words are too many to stand below their columns unless they are turned.
fn is_turned(scale: &Scale, width: f64) -> bool {
    let room = width / scale.n_levels() as f64 - 4.0;
    let longest = |tick: &Tick| {
        let words = tick.label.split(' ').map(|word| text_width(word, TICK));
        words.fold(0.0, f64::max)
    };
    scale.is_words() && scale.ticks.iter().any(|tick| longest(tick) > room)
}

/// Pixels below a panel for its labels.
fn below(scale: &Scale, width: f64) -> f64 {
    if is_turned(scale, width) {
        let labels = scale
            .ticks
            .iter()
            .map(|tick| text_width(&tick.label, TICK).min(DEEPEST));
        return 14.0 + labels.fold(0.0, f64::max);
    }
    let n_lines = x_labels(scale, width).iter().flatten().map(Vec::len).max();
    12.0 + 14.0 * n_lines.unwrap_or(1) as f64
}

/// Lines of text below each tick; none where there is no room.
fn x_labels(scale: &Scale, width: f64) -> Vec<Option<Vec<String>>> {
    if !scale.is_words() {
        let half = |tick: &Tick| (text_width(&tick.label, TICK) / 2.0 + 4.0) / width;
        let shown = thin(&scale.ticks, half);
        let labels = scale.ticks.iter().zip(shown);
        return labels
            .map(|(tick, shown)| shown.then(|| vec![tick.label.clone()]))
            .collect();
    }
    let room = width / scale.n_levels() as f64 - 4.0;
    let label = |tick: &Tick| {
        let mut lines = wrap(&tick.label, TICK, room);
        lines.truncate(MOST_LINES);
        lines
            .iter()
            .map(|line| shorten(line, TICK, room.max(30.0)))
            .collect()
    };
    scale.ticks.iter().map(|tick| Some(label(tick))).collect()
}
