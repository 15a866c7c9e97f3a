//! Heading of a chart: title, fixed settings, and the legend.

use crate::report::pictures::{Area, Drawing, INK, LINES, MUTED, Stroke, TextStyle};
use crate::report::text_width::{text_width, wrap};

/// Left margin of all charts, pixels.
pub(super) const LEFT: f64 = 66.0;
/// Right margin of all charts, pixels.
pub(super) const RIGHT: f64 = 18.0;
/// Radius of a marker in a chart, pixels.
pub(super) const MARKER_RADIUS: f64 = 4.2;
/// Style of the line that joins the points of a Pareto front.
pub(super) const FRONT: Stroke = Stroke::new(INK, 1.4);
const TITLE: u32 = 16;
const SMALL: u32 = 12;
/// Width and height of the mark (line or marker) before the text of a legend entry, pixels.
const SWATCH: (f64, f64) = (28.0, 16.0);
/// Gap between the mark and the text of a legend entry, pixels.
const SWATCH_GAP: f64 = 6.0;
/// Gap between two legend entries, pixels.
const GAP: f64 = 20.0;

/// Heading of a chart above its panels: title, fixed settings and legend.
pub(super) struct Heading {
    title: Vec<String>,
    settings: Vec<String>,
    legend: Vec<Vec<LegendEntry>>,
}

/// Function that draws the mark of a legend entry into an area.
type DrawMark = Box<dyn Fn(&mut Drawing, Area)>;

/// Legend entry: a mark and a text with its meaning.
pub(super) struct LegendEntry {
    text: String,
    /// Function that draws the mark of the entry; `None` for entries without a mark, such as the legend's title.
    mark: Option<DrawMark>,
    /// Whether the entry is a series that readers of the page can hide with a click.
    is_series: bool,
}

impl Heading {
    /// Creates a heading of the given width without margins, pixels. The title and the legend entries wrap.
    pub(super) fn new(
        title: &str,
        settings: Vec<String>,
        entries: Vec<LegendEntry>,
        inner: f64,
    ) -> Self {
        Self {
            // Bold text is wider.
            title: wrap(title, 1.12 * f64::from(TITLE), inner),
            settings,
            legend: flow(entries, inner),
        }
    }

    /// Returns the height of the heading, pixels.
    pub(super) fn height(&self) -> f64 {
        let rows = self.title.len() + self.legend.len();
        26.0 + 21.0 * rows as f64 + 17.0 * self.settings.len() as f64
    }

    /// Draws the heading at the top of a drawing.
    pub(super) fn draw(&self, drawing: &mut Drawing) {
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
                entry.draw(drawing, x, y);
                x += entry.width();
            }
        }
    }
}

impl LegendEntry {
    /// Creates a legend entry without a mark.
    pub(super) fn title(text: String) -> Self {
        Self {
            text,
            mark: None,
            is_series: false,
        }
    }

    /// Creates a legend entry from its text and a function that draws its mark.
    pub(super) fn new(text: String, mark: impl Fn(&mut Drawing, Area) + 'static) -> Self {
        let mark: DrawMark = Box::new(mark);
        Self {
            text,
            mark: Some(mark),
            is_series: false,
        }
    }

    /// Creates the legend entry of a series, which readers of the page can click. A click hides or shows the groups whose `data-series` equals the text of the
    /// entry.
    pub(super) fn series(text: String, mark: impl Fn(&mut Drawing, Area) + 'static) -> Self {
        Self {
            is_series: true,
            ..Self::new(text, mark)
        }
    }

    /// Returns the width of the legend entry including the gap after it, pixels.
    fn width(&self) -> f64 {
        self.mark_width() + text_width(&self.text, f64::from(SMALL)) + GAP
    }

    fn mark_width(&self) -> f64 {
        self.mark.as_ref().map_or(0.0, |_| SWATCH.0 + SWATCH_GAP)
    }

    fn draw(&self, drawing: &mut Drawing, x: f64, y: f64) {
        match self.is_series {
            true => drawing.group([("toggle", self.text.clone())], |drawing| {
                self.draw_mark_and_text(drawing, x, y);
            }),
            false => self.draw_mark_and_text(drawing, x, y),
        }
    }

    fn draw_mark_and_text(&self, drawing: &mut Drawing, x: f64, y: f64) {
        if let Some(mark) = &self.mark {
            mark(drawing, Area::new((x, y - 12.0), SWATCH));
        }
        let at = (x + self.mark_width(), y);
        drawing.text(at, &self.text, TextStyle::new(SMALL));
    }
}

/// Arranges legend entries in rows of at most `width` pixels.
fn flow(entries: Vec<LegendEntry>, width: f64) -> Vec<Vec<LegendEntry>> {
    let mut rows: Vec<Vec<LegendEntry>> = Vec::new();
    let mut used = f64::INFINITY;
    for entry in entries {
        if used + entry.width() > width + GAP {
            rows.push(Vec::new());
            used = 0.0;
        }
        used += entry.width();
        if let Some(row) = rows.last_mut() {
            row.push(entry);
        }
    }
    rows
}

/// Returns the stroke (colour, width and dashes) of the line with this index. If there are more lines than marker shapes, the shapes repeat with other colours.
pub(super) fn line_stroke(line: usize) -> Stroke {
    let colour = line + 3 * (line / LINES.len());
    Stroke::new(LINES[colour % LINES.len()], 2.0)
}
