//! What stands above a chart's panels: title, fixed settings, and the legend.

use crate::report::chart::{draw_sign, tint};
use crate::report::colours::{INK, LINES, MUTED, Rgb};
use crate::report::drawing::{Area, Drawing, Point, Stroke, TextStyle};
use crate::report::text_width::{text_width, wrap};

/// Left margin of a chart, pixels.
pub(super) const LEFT: f64 = 66.0;
/// Right margin, pixels.
pub(super) const RIGHT: f64 = 18.0;
/// Radius of a marker, pixels.
pub(super) const MARKER_RADIUS: f64 = 4.2;
/// The line of a Pareto front.
pub(super) const FRONT: Stroke = Stroke {
    colour: INK,
    width: 1.4,
    dash: None,
};
const TITLE: u32 = 16;
const SMALL: u32 = 12;
const LINE_WIDTH: f64 = 2.0;
/// Steps of a bar of colours.
const BAR: u32 = 40;

/// A dashed line of a width in pixels: something to compare data with.
pub(super) const fn dashes(width: f64) -> Stroke {
    Stroke {
        colour: MUTED,
        width,
        dash: Some((5, 4)),
    }
}

/// Title, fixed settings and legend, above the panels, so that nothing covers data.
pub(super) struct Heading {
    title: Vec<String>,
    settings: Vec<String>,
    legend: Vec<Vec<LegendEntry>>,
}

/// A mark and what it means.
pub(super) struct LegendEntry {
    text: String,
    mark: Mark,
    width: f64,
}

/// What a legend entry shows before its text.
pub(super) enum Mark {
    /// Nothing: the legend's title.
    None,
    /// The line of a number with its marker.
    Line(usize),
    /// The marker of a number, without a line.
    Point(usize),
    /// The steps of a Pareto front.
    Front,
    /// A line across the chart.
    Rule(Stroke),
    /// A band around a line.
    Band,
    /// A bar through a marker.
    Whisker,
    /// A tile with its sign.
    Tile(Rgb, String),
    /// All colours of numbers.
    Bar,
}

impl Heading {
    /// A heading for a drawing of some width: lines break, and legend entries flow, within its margins.
    pub(super) fn of(title: &str, settings: &str, entries: Vec<LegendEntry>, width: f64) -> Self {
        let inner = width - LEFT - RIGHT;
        Self {
            // Bold letters are wider.
            title: wrap(title, 1.12 * f64::from(TITLE), inner),
            settings: wrap(settings, f64::from(SMALL), inner),
            legend: flow(entries, inner),
        }
    }

    /// Pixels down.
    pub(super) fn height(&self) -> f64 {
        16.0 + 21.0 * self.title.len() as f64
            + 17.0 * self.settings.len() as f64
            + 21.0 * self.legend.len() as f64
            + 10.0
    }

    /// Draws it at the top of a drawing.
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
                entry.draw(drawing, (x, y));
                x += entry.width;
            }
        }
    }
}

impl LegendEntry {
    /// An entry as wide as its mark and text.
    pub(super) fn new(text: String, mark: Mark) -> Self {
        let mark_width = mark.width();
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
        let text_x = x + self.mark.width();
        match &self.mark {
            Mark::None => {}
            Mark::Tile(fill, sign) => {
                let area = Area {
                    x,
                    y: y - 12.0,
                    width: 28.0,
                    height: 16.0,
                };
                drawing.area(area, *fill);
                draw_sign(drawing, area, *fill, sign);
            }
            Mark::Bar => {
                for step in 0..BAR {
                    let area = Area {
                        x: x + 2.0 * f64::from(step),
                        y: y - 12.0,
                        width: 2.0,
                        height: 14.0,
                    };
                    drawing.area(area, tint(f64::from(step) / f64::from(BAR - 1)));
                }
            }
            Mark::Point(number) => {
                let at = (x + 6.0, middle);
                drawing.marker(*number, at, MARKER_RADIUS, point_colour(*number));
            }
            Mark::Front => {
                let corner = (x + 14.0, middle + 4.0);
                let steps = [
                    (x, corner.1),
                    corner,
                    (corner.0, middle - 4.0),
                    (x + 28.0, middle - 4.0),
                ];
                drawing.polyline(&steps, FRONT);
            }
            Mark::Line(line) => {
                let stroke = line_stroke(*line);
                drawing.line((x, middle), (x + 28.0, middle), stroke);
                drawing.marker(*line, (x + 14.0, middle), MARKER_RADIUS, stroke.colour);
            }
            Mark::Rule(stroke) => drawing.line((x, middle), (x + 28.0, middle), *stroke),
            Mark::Whisker => {
                let centre = x + 14.0;
                drawing.line(
                    (centre, middle - 8.0),
                    (centre, middle + 8.0),
                    Stroke::new(MUTED, 1.5),
                );
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

impl Mark {
    /// Pixels that it takes before its text.
    fn width(&self) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Point(_) => 18.0,
            Self::Bar => 2.0 * f64::from(BAR) + 8.0,
            _ => 34.0,
        }
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

/// Colour of a line by its number.
pub(super) fn line_colour(line: usize) -> Rgb {
    LINES[line % LINES.len()]
}

/// Colour of points without a line: beyond the palette, shapes come again in other colours.
pub(super) fn point_colour(number: usize) -> Rgb {
    line_colour(number + 3 * (number / LINES.len()))
}

/// Beyond the palette, colours come again with dashes.
pub(super) fn line_stroke(line: usize) -> Stroke {
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
