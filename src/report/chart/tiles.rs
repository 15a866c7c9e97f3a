//! Tiles: a field at each x and y, filled by an outcome or a number.

use super::layout::{Layout, TICK};
use super::rules;
use super::view::View;
use crate::report::colours::{GRID, INK, LINES, PAPER, Rgb, share, text_on};
use crate::report::drawing::{Align, Area, Drawing, Stroke, TextStyle};
use crate::report::legend::{LegendEntry, Mark};
use crate::report::text_width::{text_width, wrap};
use crate::table::{Column, Data, Mark as TableMark, Role, Scale};

/// Colours of outcomes in the order in which the table first has them; told apart by lightness, too.
const OUTCOMES: [Rgb; 8] = [
    LINES[5], LINES[4], LINES[1], LINES[7], INK, LINES[2], LINES[3], LINES[0],
];
const SIGN: u32 = 11;
/// Rows and columns from which on tiles are small.
const MANY: usize = 20;

/// How tiles look.
struct Look<'a> {
    column: (&'a Column, &'a Data),
    sign: Option<(&'a Column, &'a Data)>,
    /// The smallest and the largest number that is shown.
    ends: (f64, f64),
}

pub(super) fn draw(view: &View) -> Drawing {
    let TableMark::Tiles { fill, sign } = &view.spec.mark else {
        return Drawing::new(1.0, 1.0);
    };
    let Some(column) = view.column(fill) else {
        return Drawing::new(1.0, 1.0);
    };
    let sign = sign.as_ref().and_then(|sign| view.column(sign));
    let look = Look::of(view, column, sign);
    let (n_rows, n_columns) = (view.lines.names.len(), view.panels.names.len());
    let signs = view
        .rows
        .iter()
        .map(|&row| text_width(&look.sign(row), f64::from(SIGN)));
    let ticks = view
        .x
        .ticks
        .iter()
        .map(|tick| text_width(&tick.label, TICK))
        .take(if view.x.is_words() { 0 } else { 99 });
    let is_many = view.x.n_levels().min(view.y.n_levels()) >= MANY;
    let (margin, high) = if is_many { (4.0, 18.0) } else { (8.0, 22.0) };
    let widest = signs.chain(ticks).fold(14.0, f64::max) + margin;
    let most = 640.0 / (view.x.n_levels() * n_columns) as f64;
    let width = widest.max(most.min(64.0)) * view.x.n_levels() as f64;
    let height = high * view.y.n_levels() as f64;
    let titles = view
        .panels
        .names
        .iter()
        .map(|name| wrap(name, 15.0, width).len());
    let titles = match n_columns {
        1 => 0.0,
        _ => 16.0 * titles.max().unwrap_or(1) as f64,
    };
    let (first, above) = match n_rows {
        1 => (0.0, 8.0 + titles),
        _ => (titles, 24.0),
    };
    let n_panels = n_rows * n_columns;
    let mut layout = Layout::of(
        view,
        look.legend(view),
        (n_panels, n_columns),
        (width, height),
        above,
    );
    layout.first = first;
    let mut drawing = Drawing::new(layout.width(), layout.bottom());
    layout.draw_heading(&mut drawing);
    for panel in 0..n_panels {
        let frame = layout.frame(panel);
        let (row, column) = (panel / n_columns, panel % n_columns);
        layout.draw_axes(&mut drawing, view, panel, false);
        if n_columns > 1 && row == 0 {
            let up = if n_rows > 1 { 24.0 } else { 8.0 };
            layout.draw_title(&mut drawing, panel, &view.panel_title(column), up);
        }
        if n_rows > 1 && layout.is_first_in_row(panel) {
            layout.draw_row_title(&mut drawing, panel, &view.row_title(row));
        }
        let here = view
            .places
            .iter()
            .filter(|place| place.panel == column && place.line == row);
        let here = here.filter(|place| look.column.1.value(place.row).is_some());
        let size = (
            width / view.x.n_levels() as f64,
            height / view.y.n_levels() as f64,
        );
        let tiles: Vec<(Area, Rgb, String)> = here
            .map(|place| {
                let area = Area {
                    x: frame.x + place.x * width - 0.5 * size.0,
                    y: frame.y + (1.0 - place.y) * height - 0.5 * size.1,
                    width: size.0,
                    height: size.1,
                };
                (area, look.fill(place.row), look.sign(place.row))
            })
            .collect();
        if is_many {
            draw_grid(&mut drawing, view, frame);
        }
        for (area, fill, _) in &tiles {
            drawing.area(*area, *fill);
            drawing.frame(*area, Stroke::new(PAPER, 1.0));
        }
        rules::draw(&mut drawing, view, panel, frame);
        for (area, fill, sign) in &tiles {
            draw_sign(&mut drawing, *area, *fill, sign);
        }
        drawing.frame(frame, Stroke::new(INK, 1.0));
    }
    drawing
}

/// Lines between tiles, which lead the eye where most places are empty.
fn draw_grid(drawing: &mut Drawing, view: &View, frame: Area) {
    let stroke = Stroke::new(GRID, 1.0);
    for column in 1..view.x.n_levels() {
        let x = frame.x + frame.width * column as f64 / view.x.n_levels() as f64;
        drawing.line((x, frame.y), (x, frame.y + frame.height), stroke);
    }
    for row in 1..view.y.n_levels() {
        let y = frame.y + frame.height * row as f64 / view.y.n_levels() as f64;
        drawing.line((frame.x, y), (frame.x + frame.width, y), stroke);
    }
}

/// The colour of a number between the least and the most: the least is not yet white, which is none.
pub(in crate::report) fn tint(part: f64) -> Rgb {
    share(0.12 + 0.88 * part.clamp(0.0, 1.0))
}

/// On a ground of its own, so that no line runs through it: a minus would be read as a plus.
pub(in crate::report) fn draw_sign(drawing: &mut Drawing, place: Area, fill: Rgb, sign: &str) {
    let width = text_width(sign, f64::from(SIGN)) + 4.0;
    let (x, y) = (place.x + 0.5 * place.width, place.y + 0.5 * place.height);
    let ground = Area {
        x: x - 0.5 * width,
        y: y - 7.0,
        width,
        height: 14.0,
    };
    drawing.area(ground, fill);
    let style = TextStyle::new(SIGN).align(Align::Middle);
    drawing.text((x, y + 4.0), sign, style.colour(text_on(fill)));
}

impl<'a> Look<'a> {
    fn of(
        view: &View,
        column: (&'a Column, &'a Data),
        sign: Option<(&'a Column, &'a Data)>,
    ) -> Self {
        let ends = match column.1 {
            Data::Numbers(numbers) => {
                let shown = view.places.iter().map(|place| numbers[place.row]);
                let shown =
                    shown.filter(|&n| n.is_finite() && (column.0.scale != Scale::Log || n > 0.0));
                shown.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), n| {
                    (low.min(n), high.max(n))
                })
            }
            Data::Words { .. } => (0.0, 1.0),
        };
        let ends = match column.0.scale == Scale::Share && column.0.role != Role::Condition {
            true => (ends.0.min(0.0), ends.1.max(1.0)),
            false => ends,
        };
        Self { column, sign, ends }
    }

    fn fill(&self, row: usize) -> Rgb {
        match self.column.1 {
            Data::Words { codes, .. } => OUTCOMES[codes[row] as usize % OUTCOMES.len()],
            Data::Numbers(numbers) => tint(self.part(numbers[row])),
        }
    }

    fn part(&self, number: f64) -> f64 {
        let spaced = |n: f64| match self.column.0.scale {
            Scale::Log => n.max(1e-300).log10(),
            _ => n,
        };
        let (low, high) = (spaced(self.ends.0), spaced(self.ends.1));
        match high > low {
            true => (spaced(number) - low) / (high - low),
            false => 0.5,
        }
    }

    fn sign(&self, row: usize) -> String {
        if let Some((column, data)) = self.sign
            && let Some(value) = data.value(row)
        {
            return match value {
                crate::table::Value::Number(number) => column.tick(number),
                crate::table::Value::Word(word) => column.word(&word),
            };
        }
        let (column, data) = self.column;
        match data {
            Data::Words { levels, codes } => letter(column, levels, codes[row] as usize),
            Data::Numbers(numbers) if numbers[row].is_nan() => String::new(),
            Data::Numbers(numbers) => column.tick(numbers[row]),
        }
    }

    fn legend(&self, view: &View) -> Vec<LegendEntry> {
        let (column, data) = self.column;
        let mut entries = vec![LegendEntry::new(format!("{}:", column.title()), Mark::None)];
        match data {
            Data::Words { levels, codes } => {
                for (code, level) in levels.iter().enumerate() {
                    let mut places = view.places.iter();
                    if places.any(|place| codes[place.row] as usize == code) {
                        let sign = letter(column, levels, code);
                        let mark = Mark::Tile(OUTCOMES[code % OUTCOMES.len()], sign);
                        entries.push(LegendEntry::new(column.word(level), mark));
                    }
                }
            }
            Data::Numbers(_) => {
                let (low, high) = self.ends;
                let text = format!("{} to {}", column.tick(low), column.tick(high));
                entries.push(LegendEntry::new(text, Mark::Bar));
            }
        }
        entries.extend(rules::entries(view));
        if let Some((column, _)) = self.sign {
            entries.push(LegendEntry::new(
                format!("written: {}", column.title()),
                Mark::None,
            ));
        }
        entries
    }
}

/// The first letters of a word that no word before it has.
fn letter(column: &Column, levels: &[String], code: usize) -> String {
    let start = |level: &str, n: usize| {
        column
            .word(level)
            .chars()
            .take(n)
            .collect::<String>()
            .to_lowercase()
    };
    let is_free = |n: &usize| {
        levels[..code]
            .iter()
            .all(|other| start(other, *n) != start(&levels[code], *n))
    };
    let n = (1..=3).find(is_free).unwrap_or(3);
    start(&levels[code], n)
}
