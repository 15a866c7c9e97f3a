//! What was taken for what: a confusion matrix as a picture.

use crate::report::axis::axes_of;
use crate::report::colours::{GRID, INK, MUTED, PAPER, share, text_on};
use crate::report::drawing::{Align, Area, Drawing, Stroke, TextStyle};
use crate::report::heat_map::draw_colours;
use crate::report::text_width::{shorten, text_width, wrap};
use crate::report::varying::{Levels, unbroken_parts};
use crate::study::table::{Confusion, Tables};
use crate::world::TouchKind;
use ndarray::Array2;

/// Pixels that a name gets, at most.
const LONGEST_NAME: f64 = 170.0;

/// Pixels that the colour bar is high, at least: its title stands beside it.
const LOWEST_BAR: f64 = 170.0;

/// Counts of one cell: row = touched object, column = what it was taken for.
#[derive(Clone, Debug, PartialEq)]
pub struct ConfusionMatrix {
    /// Names of the objects, rows and columns, in the order in which the table first has them.
    pub names: Vec<String>,
    /// Counts over all trials, names × names.
    pub counts: Array2<usize>,
}

impl ConfusionMatrix {
    /// The matrix of a cell; every object of the table has a place, even if this cell has no row of it.
    pub fn of(confusion: &[Confusion], cell: usize) -> Self {
        let mut names: Vec<String> = Vec::new();
        let objects = confusion.iter().map(|row| &row.object);
        for name in objects.chain(confusion.iter().map(|row| &row.predicted)) {
            if !names.contains(name) {
                names.push(name.clone());
            }
        }
        let mut counts = Array2::zeros((names.len(), names.len()));
        let place = |name: &String| names.iter().position(|known| known == name);
        for row in confusion.iter().filter(|row| row.cell == cell) {
            if let (Some(object), Some(predicted)) = (place(&row.object), place(&row.predicted)) {
                counts[(object, predicted)] += row.count;
            }
        }
        Self { names, counts }
    }

    /// Share of a row's touches in one column; 0 for a row without touches.
    pub fn share(&self, row: usize, column: usize) -> f64 {
        let total = self.counts.row(row).sum();
        self.counts[(row, column)] as f64 / total.max(1) as f64
    }
}

/// The confusion matrix of a cell as a heat map of row shares, with counts where they fit; the darkness grows with the
/// share's square root, so that rare confusions are seen. None if the table has no row of
/// the cell.
pub fn confusion_picture(tables: &Tables, cell: usize) -> Option<Drawing> {
    let (settings, score) = tables.summary.iter().find(|(c, _)| c.cell == cell)?;
    tables.confusion.iter().find(|row| row.cell == cell)?;
    let matrix = ConfusionMatrix::of(&tables.confusion, cell);
    let is_kind = |name: &String| TouchKind::named(name).is_ok();
    let what = match matrix.names.iter().all(is_kind) {
        true => "kind of touch",
        false => "object",
    };
    let title = format!(
        "What each {what} was taken for: accuracy {:.2} [{:.2}, {:.2}]",
        score.accuracy, score.accuracy_low, score.accuracy_high
    );
    let mut parts: Vec<String> = axes_of(&[settings])
        .iter()
        .map(|axis| Levels::of(*axis, &[settings]))
        .filter(|levels| !levels.go_without_saying())
        .map(|levels| levels.sentence())
        .collect();
    if score.n_trials > 1 {
        parts.push(format!("{} trials together", score.n_trials));
    }
    Some(draw(&matrix, &title, &unbroken_parts(&parts)))
}

fn draw(matrix: &ConfusionMatrix, title: &str, settings: &str) -> Drawing {
    let n = matrix.names.len();
    let side = (560.0 / n as f64).floor().clamp(13.0, 72.0);
    let font = if side >= 16.0 { 12 } else { 10 };
    let names: Vec<String> = matrix
        .names
        .iter()
        .map(|name| shorten(name, f64::from(font), LONGEST_NAME))
        .collect();
    let longest = names
        .iter()
        .map(|name| text_width(name, f64::from(font)))
        .fold(0.0, f64::max);
    let extent = side * n as f64;
    let left = 40.0 + longest;
    let width = (left + extent + 96.0).max(600.0);
    let heading = wrap(title, 17.5, width - 40.0);
    let lines = wrap(settings, 12.0, width - 40.0);
    let top = 18.0 + 21.0 * heading.len() as f64 + 17.0 * lines.len() as f64 + 12.0;
    let foot = (extent + longest + 46.0).max(LOWEST_BAR + 20.0);
    let mut drawing = Drawing::new(width, top + foot);
    let mut y = 8.0;
    for line in &heading {
        y += 21.0;
        drawing.bold_text((20.0, y), line, TextStyle::new(16));
    }
    for line in &lines {
        y += 17.0;
        drawing.text((20.0, y), line, TextStyle::new(12).colour(MUTED));
    }
    let area = Area {
        x: left,
        y: top,
        width: extent,
        height: extent,
    };
    draw_cells(&mut drawing, matrix, area, side);
    draw_names(&mut drawing, &names, area, side, font);
    let bar = Area {
        x: area.x + extent + 16.0,
        y: area.y,
        width: 14.0,
        height: extent.clamp(LOWEST_BAR, 260.0),
    };
    draw_bar(&mut drawing, bar);
    drawing
}

fn draw_cells(drawing: &mut Drawing, matrix: &ConfusionMatrix, area: Area, side: f64) {
    let n = matrix.names.len();
    for line in 1..n {
        let along = line as f64 * side;
        let stroke = Stroke::new(GRID, 0.75);
        drawing.line(
            (area.x, area.y + along),
            (area.x + area.width, area.y + along),
            stroke,
        );
        drawing.line(
            (area.x + along, area.y),
            (area.x + along, area.y + area.height),
            stroke,
        );
    }
    let size = if side >= 26.0 { 11 } else { 9 };
    // All counts or none: a number missing here and there would look like a zero.
    let largest = matrix
        .counts
        .iter()
        .max()
        .map_or(0, |count| *count)
        .to_string();
    let has_room = text_width(&largest, f64::from(size)) + 3.0 <= side;
    for ((row, column), &count) in matrix
        .counts
        .indexed_iter()
        .filter(|(_, count)| **count > 0)
    {
        let fill = share(matrix.share(row, column).sqrt());
        let cell = Area {
            x: area.x + column as f64 * side,
            y: area.y + row as f64 * side,
            width: side,
            height: side,
        };
        drawing.area(cell, fill);
        if has_room {
            let middle = (
                cell.x + side / 2.0,
                cell.y + side / 2.0 + 0.36 * f64::from(size),
            );
            let style = TextStyle::new(size)
                .align(Align::Middle)
                .colour(text_on(fill));
            drawing.text(middle, &count.to_string(), style);
        }
    }
    drawing.frame(area, Stroke::new(INK, 1.0));
}

fn draw_names(drawing: &mut Drawing, names: &[String], area: Area, side: f64, font: u32) {
    let lift = 0.36 * f64::from(font);
    let wide = |name: &String| text_width(name, f64::from(font));
    let names_height = names.iter().map(wide).fold(0.0, f64::max);
    for (index, name) in names.iter().enumerate() {
        let middle = (index as f64 + 0.5) * side;
        let style = TextStyle::new(font).align(Align::End);
        drawing.text((area.x - 6.0, area.y + middle + lift), name, style);
        let foot = (area.x + middle + lift, area.y + area.height + 6.0);
        drawing.text(foot, name, style.angle(-90.0));
    }
    let style = TextStyle::new(13).align(Align::Middle);
    let beside = (16.0, area.y + area.height / 2.0);
    drawing.text(beside, "touched", style.angle(-90.0));
    let below = (
        area.x + area.width / 2.0,
        area.y + area.height + names_height + 30.0,
    );
    drawing.text(below, "taken for", style);
}

fn draw_bar(drawing: &mut Drawing, bar: Area) {
    drawing.area(bar, PAPER);
    draw_colours(drawing, bar, 50, share);
    for (value, text) in [
        (0.0f64, "0"),
        (0.05, "0.05"),
        (0.2, "0.2"),
        (0.5, "0.5"),
        (1.0, "1"),
    ] {
        let y = bar.y + bar.height * (1.0 - value.sqrt());
        let right = bar.x + bar.width;
        drawing.line((right, y), (right + 4.0, y), Stroke::new(INK, 1.0));
        drawing.text((right + 8.0, y + 4.5), text, TextStyle::new(12));
    }
    let beside = (bar.x + bar.width + 56.0, bar.y + bar.height / 2.0);
    let style = TextStyle::new(12).align(Align::Middle).angle(-90.0);
    drawing.text(beside, "share of the row's touches", style);
}
