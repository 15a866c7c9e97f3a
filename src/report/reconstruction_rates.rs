//! The chart of error against frames a second, its Pareto front marked.

use super::legend::{
    Heading, LEFT, LegendEntry, MARKER_RADIUS, Mark, RIGHT, dashes, line_colour, line_entries,
};
use super::log_scale::{LogScale, axis_titles, draw_axes};
use super::reconstruction_charts::{cell_words, values_of};
use crate::report::axis::{short_number, solver_name};
use crate::report::drawing::{Align, Area, Drawing, TextStyle};
use crate::study::reconstruction::table::{ReconstructionCell, ReconstructionPareto};

/// The chart's title.
pub(super) const RATE_TITLE: &str = "Error of reconstructed frames against frames a second";

/// Every cell of a noise level; those that no other beats are joined, numbered and named below.
pub(super) fn draw_rates(
    noise: &str,
    rows: &[&(ReconstructionCell, ReconstructionPareto)],
) -> Drawing {
    let solvers = values_of(rows.iter().map(|(cell, _)| cell), |c| c.solver);
    let mut entries = line_entries(solvers.iter().map(|&solver| solver_name(solver)));
    entries.push(LegendEntry::new("Pareto front".to_owned(), Mark::Dashes));
    let mut front: Vec<_> = rows.iter().filter(|(_, p)| p.on_front).collect();
    front.sort_by(|a, b| a.1.error.total_cmp(&b.1.error));
    let width = 760.0;
    let settings =
        format!("{noise}; one core, frames in blocks of 64; better is lower and further right");
    let heading = Heading::of(RATE_TITLE, &settings, entries, width);
    let area = Area {
        x: LEFT,
        y: heading.height() + 8.0,
        width: width - LEFT - RIGHT,
        height: 360.0,
    };
    let bottom = area.y + area.height + 58.0;
    let mut drawing = Drawing::new(width, bottom + 18.0 * front.len() as f64 + 8.0);
    heading.draw(&mut drawing);
    let x = LogScale::over(
        rows.iter().map(|(_, p)| p.frames_per_s_per_core),
        area.x,
        area.x + area.width,
    );
    let y = LogScale::over(
        rows.iter().map(|(_, p)| p.error),
        area.y + area.height,
        area.y,
    );
    draw_axes(&mut drawing, area, (x, &x.ticks()), (y, &y.ticks()));
    axis_titles(
        &mut drawing,
        area,
        "frames a second on one core",
        Some("error"),
    );
    let place = |p: &ReconstructionPareto| (x.place(p.frames_per_s_per_core), y.place(p.error));
    let joined: Vec<_> = front.iter().map(|(_, p)| place(p)).collect();
    if joined.len() > 1 {
        drawing.polyline(&joined, dashes(1.2));
    }
    for (cell, point) in rows {
        let line = solvers.iter().position(|s| *s == cell.solver).unwrap_or(0);
        drawing.marker(line, place(point), MARKER_RADIUS, line_colour(line));
    }
    for (number, (cell, point)) in front.iter().enumerate() {
        let (left, top) = place(point);
        let label = (number + 1).to_string();
        drawing.bold_text(
            (left, top + 19.0),
            &label,
            TextStyle::new(12).align(Align::Middle),
        );
        let text = format!(
            "{label}  {}: error {}, {} frames/s",
            cell_words(cell),
            short_number(point.error),
            short_number(point.frames_per_s_per_core.round())
        );
        drawing.text(
            (LEFT, bottom + 18.0 * number as f64),
            &text,
            TextStyle::new(12),
        );
    }
    drawing
}
