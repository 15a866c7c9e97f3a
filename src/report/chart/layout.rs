//! Pixel layout of a chart: a heading, and below it a grid of panels with tick labels and titles.

use super::legend::{Heading, LEFT, LegendEntry, RIGHT};
use super::scale::{AxisScale, Tick, thin};
use super::view::View;
use crate::report::pictures::{Align, Area, Drawing, GRID, INK, MUTED, PAPER, Stroke, TextStyle};
use crate::report::text_width::{shorten, text_width, wrap};

/// Font size of the labels of axis ticks, pixels.
const TICK: f64 = 12.0;
/// Font size of axis and panel titles, pixels.
const LABEL: u32 = 13;
/// Gap between neighbouring panels, pixels.
const GAP: f64 = 26.0;
/// Minimum width of a chart, pixels; leaves enough space for the title.
const NARROWEST: f64 = 560.0;
/// Maximum width of the labels to the left of panels or tiles, pixels.
pub(super) const WIDEST: f64 = 230.0;
/// Font size of the names at the ends of lines, pixels.
pub(super) const END_LABEL: f64 = 11.0;
/// Space between a panel and the name of a line beside it, pixels.
pub(super) const END_GAP: f64 = 24.0;
/// Maximum height of a rotated label below a panel, pixels.
const DEEPEST: f64 = 160.0;
/// Maximum number of lines of a label below a panel.
const MAX_LINES: usize = 3;
/// Font size and line height of the caption below the panels, pixels.
pub(super) const CAPTION: f64 = 12.0;
const CAPTION_LINE: f64 = 17.0;
/// Height of a line in a panel's title, pixels.
const TITLE_LINE: f64 = 16.0;

/// Pixel positions of the panels of a chart, with their titles and labels.
pub(super) struct Layout {
    columns: usize,
    /// Width and height of a panel, pixels.
    size: (f64, f64),
    /// Top left corner of the first panel, pixels.
    corner: (f64, f64),
    /// Width of the whole chart, pixels.
    pub width: f64,
    /// Lines of the title above each panel.
    titles: Vec<Vec<String>>,
    /// Height above each row of panels, pixels.
    above: f64,
    labels: XLabels,
    heading: Heading,
    /// Lines below the panels: what the chart shows, and which rows it omits.
    caption: Vec<String>,
}

/// Labels of the horizontal axis below a panel, wrapped into lines. A label for which there is no space has no lines.
struct XLabels {
    is_turned: bool,
    lines: Vec<Vec<String>>,
    /// Height of the axis labels below a panel, pixels.
    depth: f64,
}

impl Layout {
    /// Creates the layout of a chart whose panels have the given size (width, height) and are arranged in `columns` columns.
    pub fn new(view: &View, entries: Vec<LegendEntry>, columns: usize, size: (f64, f64)) -> Self {
        let labels = view.y.ticks.iter();
        let labels = labels.map(|tick| text_width(&tick.label, TICK).min(WIDEST));
        let left = f64::max(LEFT, 44.0 + labels.fold(0.0, f64::max));
        let titles = view.titles.iter();
        let titles = titles.map(|title| wrap(title, 1.12 * f64::from(LABEL), size.0));
        let titles: Vec<Vec<String>> = titles.collect();
        let titled = TITLE_LINE * titles.iter().map(Vec::len).max().unwrap_or(0) as f64;
        let above = 10.0 + titled;
        let panels_width = columns as f64 * (size.0 + GAP) - GAP;
        let ends = view.lines.names.iter().chain([&view.lines.heading]);
        let ends = ends.filter(|_| view.has_end_labels());
        let ends = ends.map(|name| END_GAP + text_width(name, END_LABEL).min(WIDEST));
        let right = RIGHT + ends.fold(0.0, f64::max);
        let width = f64::max(panels_width + left + right, NARROWEST);
        let inner = width - LEFT - RIGHT;
        let mut settings = wrap(&view.constants(), CAPTION, inner);
        let mut note = view.spec.note.clone();
        if settings.len() > 1 {
            note = format!("{} {note}", view.constants());
            settings.clear();
        }
        let caption = [note, view.omitted()];
        let caption = caption.iter().flat_map(|text| wrap(text, CAPTION, inner));
        let caption = caption.collect();
        let heading = Heading::new(&view.spec.title, settings, entries, inner);
        Self {
            columns,
            size,
            corner: (left, heading.height() + above),
            width,
            titles,
            above,
            labels: XLabels::new(&view.x, size.0),
            heading,
            caption,
        }
    }

    /// Creates the layout of a small chart without heading and titles, whose panel has the given corner and size.
    pub fn of_part(view: &View, corner: (f64, f64), size: (f64, f64)) -> Self {
        Self {
            columns: 1,
            size,
            corner,
            width: size.0,
            titles: vec![Vec::new()],
            above: 0.0,
            labels: XLabels::new(&view.x, size.0),
            heading: Heading::new("", Vec::new(), Vec::new(), size.0),
            caption: Vec::new(),
        }
    }

    /// Returns the height of the chart, pixels.
    pub fn bottom(&self) -> f64 {
        self.below() + 16.0 + CAPTION_LINE * self.caption.len() as f64
    }

    /// Returns the y coordinate of the title of the horizontal axis, pixels.
    fn below(&self) -> f64 {
        let panels = self.panels();
        panels.y + panels.height + self.labels.depth + 16.0
    }

    /// Returns the area that contains all panels, pixels.
    fn panels(&self) -> Area {
        let (across, down) = (self.columns, self.titles.len().div_ceil(self.columns));
        let width = across as f64 * (self.size.0 + GAP) - GAP;
        let height = (down - 1) as f64 * self.pitch() + self.size.1;
        Area::new(self.corner, (width, height))
    }

    fn pitch(&self) -> f64 {
        self.above + self.size.1 + self.labels.depth
    }

    /// Returns the area of the panel with this index, pixels.
    pub fn frame(&self, panel: usize) -> Area {
        let (row, column) = (panel / self.columns, panel % self.columns);
        let panels = self.panels();
        let x = panels.x + column as f64 * (self.size.0 + GAP);
        let y = panels.y + row as f64 * self.pitch();
        Area::new((x, y), self.size)
    }

    /// Draws the heading of the chart and the axis titles that all panels share.
    pub fn draw_titles(&self, drawing: &mut Drawing, view: &View) {
        self.heading.draw(drawing);
        let panels = self.panels();
        let style = TextStyle::new(LABEL).align(Align::Middle);
        let shortened = |text: &str, room: f64| shorten(text, f64::from(LABEL), room);
        let below = (panels.at(0.5, 0.0).0, self.below());
        let text = shortened(&view.x.title, panels.width + panels.x);
        drawing.text(below, &text, style);
        let small = TextStyle::new(CAPTION as u32).colour(MUTED);
        for (line, text) in self.caption.iter().enumerate() {
            let y = self.below() + 6.0 + CAPTION_LINE * (line + 1) as f64;
            drawing.text((LEFT, y), text, small);
        }
        let beside = (16.0, panels.at(0.0, 0.5).1);
        let text = shortened(&view.y.title, panels.height + 100.0);
        drawing.text(beside, &text, style.angle(-90.0));
    }

    /// Draws the title, the grid and the axis labels of a panel.
    pub fn draw_axes(&self, drawing: &mut Drawing, view: &View, panel: usize) {
        let frame = self.frame(panel);
        let style = TextStyle::new(LABEL);
        let mut up = 8.0;
        for text in self.titles[panel].iter().rev() {
            drawing.bold_text((frame.x, frame.y - up), text, style);
            up += TITLE_LINE;
        }
        draw_grid(drawing, view, frame);
        self.labels.draw(drawing, &view.x, frame);
        if panel.is_multiple_of(self.columns) {
            let style = TextStyle::new(TICK as u32).align(Align::End);
            let half = 7.0 / frame.height;
            let shown = thin(&view.y.ticks, |_| half);
            for (tick, _) in view.y.ticks.iter().zip(shown).filter(|(_, shown)| *shown) {
                let (x, y) = frame.at(0.0, tick.at);
                let text = shorten(&tick.label, TICK, WIDEST);
                drawing.text((x - 9.0, y + 4.5), &text, style);
            }
        }
    }
}

/// Draws the axes and the grid lines at the ticks. A gap of an axis separates the value zero from a logarithmic axis.
fn draw_grid(drawing: &mut Drawing, view: &View, frame: Area) {
    let grid = Stroke::new(GRID, 1.0);
    for tick in &view.x.ticks {
        drawing.line(frame.at(tick.at, 1.0), frame.at(tick.at, 0.0), grid);
    }
    for tick in &view.y.ticks {
        drawing.line(frame.at(0.0, tick.at), frame.at(1.0, tick.at), grid);
    }
    let corners = [(0.0, 1.0), (0.0, 0.0), (1.0, 0.0)];
    let axes = corners.map(|(across, up)| frame.at(across, up));
    drawing.polyline(&axes, Stroke::new(INK, 1.0));
    let breaks = [
        view.x.shelf.map(|at| (at, 0.0)),
        view.y.shelf.map(|at| (0.0, at)),
    ];
    for (x, y) in breaks.into_iter().flatten().map(|(x, y)| frame.at(x, y)) {
        drawing.line(
            (x - 3.0, y + 4.0),
            (x + 3.0, y - 4.0),
            Stroke::new(PAPER, 4.0),
        );
    }
}

impl XLabels {
    /// Wraps the labels of the horizontal axis into lines of at most `width` pixels. If one label is too wide or has too many lines, all labels are rotated.
    fn new(scale: &AxisScale, width: f64) -> Self {
        let labels = scale.ticks.iter().map(|tick| &tick.label[..]);
        let mut is_turned = false;
        let lines: Vec<Vec<String>> = if scale.is_words {
            let room = width / scale.levels.len() as f64 - 4.0;
            let lines: Vec<_> = labels
                .clone()
                .map(|label| wrap(label, TICK, room))
                .collect();
            let is_too_wide = |line: &String| text_width(line, TICK) > room;
            is_turned = lines.iter().flatten().any(is_too_wide)
                || lines.iter().any(|lines| lines.len() > MAX_LINES);
            match is_turned {
                true => labels
                    .map(|label| vec![shorten(label, TICK, DEEPEST)])
                    .collect(),
                false => lines,
            }
        } else {
            let half = |tick: &Tick| (text_width(&tick.label, TICK) / 2.0 + 4.0) / width;
            let shown = thin(&scale.ticks, half).into_iter();
            let shown = labels.zip(shown);
            let lines = shown.map(|(label, shown)| shown.then(|| label.to_owned()));
            lines.map(|label| label.into_iter().collect()).collect()
        };
        let depth = match is_turned {
            true => {
                let widths = lines.iter().flatten().map(|line| text_width(line, TICK));
                14.0 + widths.fold(0.0, f64::max)
            }
            false => 12.0 + 14.0 * lines.iter().map(Vec::len).max().unwrap_or(1) as f64,
        };
        Self {
            is_turned,
            lines,
            depth,
        }
    }

    fn draw(&self, drawing: &mut Drawing, scale: &AxisScale, frame: Area) {
        let style = TextStyle::new(TICK as u32);
        for (tick, lines) in scale.ticks.iter().zip(&self.lines) {
            let (x, bottom) = frame.at(tick.at, 0.0);
            for (line, text) in lines.iter().enumerate() {
                match self.is_turned {
                    true => {
                        let style = style.align(Align::End).angle(-90.0);
                        drawing.text((x + 4.0, bottom + 8.0), text, style);
                    }
                    false => {
                        let at = (x, bottom + 19.0 + 14.0 * line as f64);
                        drawing.text(at, text, style.align(Align::Middle));
                    }
                }
            }
        }
    }
}
