//! Tile charts: one tile for each pair of x and y, coloured by an outcome or a number.

use super::layout::Layout;
use super::legend::LegendEntry;
use super::view::View;
use crate::error::Result;
use crate::report::pictures::{
    Align, Area, Drawing, INK, LINES, PAPER, Rgb, Stroke, TextStyle, text_on, tint,
};
use crate::report::swept::Setting;
use crate::report::text_width::text_width;
use crate::table::{Data, Value};

/// Colours of the outcomes in a chart, in the order of the column's names, or else of first occurrence. The colours also differ in lightness.
const OUTCOMES: [Rgb; 8] = [
    [0x9e, 0xca, 0xe1],
    [0xf0, 0xc0, 0x4a],
    LINES[3],
    [0x8c, 0x2d, 0x04],
    INK,
    LINES[2],
    LINES[7],
    LINES[0],
];
/// Largest number of panels side by side.
const PANELS_ACROSS: usize = 4;
const SIGN: u32 = 11;
/// Number of rows or columns of tiles above which tiles are small.
const MANY: usize = 20;

/// Appearance of the tiles of a chart: rules that convert values to colours and texts.
struct Look<'a> {
    fill: Setting<'a>,
    /// Smallest and largest value of the tiles in the chart.
    ends: (f64, f64),
}

/// Draws a chart of tiles, coloured by the column `fill`.
pub(super) fn draw(view: &View, fill: Setting) -> Result<Drawing> {
    let look = Look::new(view, fill);
    let (across, down) = (view.x.levels.len(), view.y.levels.len());
    let columns = view.panels.names.len().min(PANELS_ACROSS);
    let is_many = across.min(down) >= MANY || across * columns >= MANY;
    let (margin, high) = if is_many { (4.0, 18.0) } else { (8.0, 22.0) };
    let signs = view
        .rows
        .iter()
        .map(|&row| text_width(&look.sign(row), f64::from(SIGN)));
    let widest = signs.fold(9.0, f64::max) + margin;
    let most = 640.0 / (across * columns) as f64;
    let size = (widest.max(most.min(64.0)), high);
    let panel = (size.0 * across as f64, size.1 * down as f64);
    let layout = Layout::new(view, look.legend(view), columns, panel);
    let mut drawing = Drawing::new(layout.width, layout.bottom());
    layout.draw_titles(&mut drawing, view);
    for panel in 0..view.titles.len() {
        let frame = layout.frame(panel);
        layout.draw_axes(&mut drawing, view, panel);
        for place in view
            .here(panel)
            .filter(|place| look.fill.data.value(place.row).is_some())
        {
            let area = Area::around(frame.at(place.x, place.y), size);
            let (colour, sign) = (look.colour(place.row), look.sign(place.row));
            view.draw_mark(&mut drawing, place, |drawing| {
                drawing.area(area, colour);
                drawing.frame(area, Stroke::new(PAPER, 1.0));
            });
            if !sign.is_empty() {
                let (x, y) = area.at(0.5, 0.5);
                let style = TextStyle::new(SIGN).align(Align::Middle);
                drawing.text((x, y + 4.0), &sign, style.colour(text_on(colour)));
            }
        }
        drawing.frame(frame, Stroke::new(INK, 1.0));
    }
    Ok(drawing)
}

impl<'a> Look<'a> {
    fn new(view: &View, fill: Setting<'a>) -> Self {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        if let Data::Numbers(numbers) = fill.data {
            let shown = view.places.iter().map(|place| numbers[place.row]);
            for number in shown.filter(|n| n.is_finite()) {
                (low, high) = (low.min(number), high.max(number));
            }
        }
        Self {
            fill,
            ends: (low, high),
        }
    }

    fn colour(&self, row: usize) -> Rgb {
        match self.fill.data {
            Data::Words { codes, .. } => self.outcome_colour(codes[row] as usize),
            Data::Numbers(numbers) => tint(self.part(numbers[row])),
        }
    }

    /// Returns the colour of an outcome, given its code in the table. Named outcomes have the same colours in all tables.
    fn outcome_colour(&self, code: usize) -> Rgb {
        let named = match self.fill.data {
            Data::Words { levels, .. } => {
                let mut names = self.fill.column.names.iter();
                names.position(|(known, _)| *known == levels[code])
            }
            Data::Numbers(_) => None,
        };
        OUTCOMES[named.unwrap_or(code) % OUTCOMES.len()]
    }

    fn part(&self, number: f64) -> f64 {
        let (low, high) = self.ends;
        match high > low {
            true => (number - low) / (high - low),
            false => 0.5,
        }
    }

    /// Returns the text on the tile of a table row: a number; an outcome has its colour alone.
    fn sign(&self, row: usize) -> String {
        match self.fill.data.value(row) {
            Some(Value::Number(number)) => self.fill.column.tick(number),
            _ => String::new(),
        }
    }

    fn legend(&self, view: &View) -> Vec<LegendEntry> {
        let column = self.fill.column;
        let tile = |text: String, colour: Rgb| {
            LegendEntry::new(text, move |drawing, area| drawing.area(area, colour))
        };
        let mut entries = vec![LegendEntry::title(format!("{}:", column.title()))];
        match self.fill.data {
            Data::Words { levels, codes } => {
                let is_shown = |code: &usize| {
                    let mut places = view.places.iter();
                    places.any(|place| codes[place.row] as usize == *code)
                };
                entries.extend((0..levels.len()).filter(is_shown).map(|code| {
                    let colour = self.outcome_colour(code);
                    tile(column.word(&levels[code]), colour)
                }));
            }
            Data::Numbers(_) => {
                let (low, high) = self.ends;
                for end in [low, high] {
                    entries.push(tile(column.tick(end), tint(self.part(end))));
                }
            }
        }
        entries
    }
}
