//! What moved between two runs, as a page: sentences, a chart, and every cell.

use crate::report::chart::{draw_axes, draw_y_labels, y_at};
use crate::report::colours::{GRID, INK, LINES};
use crate::report::drawing::{Align, Area, Drawing, Stroke, TextStyle};
use crate::report::legend::{Heading, LEFT, LegendEntry, MARKER_RADIUS, Mark, RIGHT, dashes};
use crate::report::page::{Picture, Section, figure, plain};
use crate::report::run_differences::{differences_table, verdict};
use crate::report::varying::{Levels, Settings, unbroken_parts};
use crate::study::RunComparison;
use crate::study::table::Cell;

/// Cells in the page's table, at most.
const MOST_CELLS: usize = 1000;
/// Pixels a side of the chart.
const SIDE: f64 = 460.0;

/// The page of two runs by their names, and the program that made it.
pub fn differences_page(
    comparison: &RunComparison,
    (first, second): (&str, &str),
    program: &str,
) -> String {
    let cells: Vec<&Cell> = comparison.both.iter().map(|(cell, _)| cell).collect();
    let settings = Settings::of(&cells);
    let fixed: Vec<String> = settings.fixed.iter().map(Levels::sentence).collect();
    let table = differences_table(comparison, &settings, 400, MOST_CELLS);
    let note = format!(
        "First: {first}; second: {second}. The cells that moved most surely come first{}. All cells: {}.",
        match cells.len() > MOST_CELLS {
            true => format!(", {MOST_CELLS} of {}", cells.len()),
            false => String::new(),
        },
        unbroken_parts(&fixed)
    );
    let title = "Accuracy of each cell in both runs";
    let chart = figure(&Picture::of(
        &draw(comparison, (first, second), title),
        title,
    ));
    let found = vec![
        plain::answer(&verdict(comparison)),
        Section::new("chart", "Side by side", chart),
        plain::table("cells", "Cells", &note, &table),
    ];
    plain::bare_page(&format!("{first} and {second}"), found, program)
}

/// The second run's accuracy against the first's: what lies on the diagonal has not moved.
fn draw(comparison: &RunComparison, (first, second): (&str, &str), title: &str) -> Drawing {
    let width = LEFT + SIDE + RIGHT + 40.0;
    let legend = vec![
        LegendEntry::new("more than chance explains".to_owned(), Mark::Point(1)),
        LegendEntry::new("chance explains it".to_owned(), Mark::Point(0)),
        LegendEntry::new("no difference".to_owned(), Mark::Dashes),
    ];
    let heading = Heading::of(
        title,
        &format!("Up: {second}. Across: {first}."),
        legend,
        width,
    );
    let top = heading.height();
    let mut drawing = Drawing::new(width, top + SIDE + 66.0);
    heading.draw(&mut drawing);
    let frame = Area {
        x: LEFT,
        y: top + 6.0,
        width: SIDE,
        height: SIDE,
    };
    draw_axes(&mut drawing, frame);
    draw_y_labels(&mut drawing, frame);
    let bottom = frame.y + frame.height;
    let x_at = |accuracy: f64| frame.x + frame.width * accuracy.clamp(0.0, 1.0);
    for step in 0..=5 {
        let accuracy = f64::from(step) / 5.0;
        let x = x_at(accuracy);
        drawing.line((x, frame.y), (x, bottom), Stroke::new(GRID, 1.0));
        drawing.line((x, bottom), (x, bottom + 5.0), Stroke::new(INK, 1.0));
        let style = TextStyle::new(12).align(Align::Middle);
        drawing.text((x, bottom + 19.0), &format!("{accuracy:.1}"), style);
    }
    let below = (frame.x + frame.width / 2.0, bottom + 42.0);
    let style = TextStyle::new(13).align(Align::Middle);
    drawing.text(below, "accuracy in the first run (share recognised)", style);
    drawing.line(
        (frame.x, bottom),
        (frame.x + frame.width, frame.y),
        dashes(1.2),
    );
    let mut rows: Vec<_> = comparison.both.iter().map(|(_, row)| row).collect();
    // What matters lies on top.
    rows.sort_by_key(|row| row.is_significant());
    for row in rows {
        let line = usize::from(row.is_significant());
        let at = (x_at(row.first_accuracy), y_at(frame, row.second_accuracy));
        drawing.marker(line, at, MARKER_RADIUS, LINES[line]);
    }
    drawing
}
