//! Charts of a reconstruction study: error against measurements, error against rate, and frames side by side.

use super::legend::{
    Heading, LEFT, LegendEntry, MARKER_RADIUS, Mark, RIGHT, line_colour, line_stroke,
};
use super::log_scale::LogScale;
use crate::error::Result;
use crate::report::axis::{basis_name, ensemble_name, short_number, solver_name};
use crate::report::colours::{GRID, INK, MUTED};
use crate::report::drawing::{Align, Area, Drawing, Stroke, TextStyle};
use crate::report::snapshots::snapshots;
use crate::sensing::{Basis, Ensemble, Solver};
use crate::signal::{NoiseUnit, Quantity};
use crate::study::reconstruction::SampleFrames;
use crate::study::reconstruction::table::{
    ReconstructionCell, ReconstructionPareto, ReconstructionScore, ReconstructionTables,
};
use ndarray::Array2;

const PANEL: (f64, f64) = (290.0, 250.0);
/// Room for a panel's tick labels.
const GAP: f64 = 56.0;

type Scored<'a> = (&'a ReconstructionCell, &'a ReconstructionScore);

/// The different values of a cell's setting, in order of appearance.
pub(super) fn values_of<'a, T: PartialEq>(
    cells: impl IntoIterator<Item = &'a ReconstructionCell>,
    value: impl Fn(&ReconstructionCell) -> T,
) -> Vec<T> {
    cells.into_iter().fold(Vec::new(), |mut found, cell| {
        let value = value(cell);
        if !found.contains(&value) {
            found.push(value);
        }
        found
    })
}

/// A noise level in words: `10 % of full scale`.
pub fn noise_words(level: f64, unit: NoiseUnit) -> String {
    match (level, unit) {
        (0.0, _) => "no noise".to_owned(),
        (_, NoiseUnit::FullScale) => {
            format!("noise of {} % of full scale", short_number(100.0 * level))
        }
        (_, NoiseUnit::Mm) => format!("noise of {} mm", short_number(level)),
        (_, NoiseUnit::N) => format!("noise of {} N", short_number(level)),
    }
}

/// All charts: file name without ending, title, drawing.
pub fn draw_reconstruction_charts(tables: &ReconstructionTables) -> Vec<(String, String, Drawing)> {
    let cells = || tables.reconstruction.iter().map(|(cell, _)| cell);
    let mut charts = Vec::new();
    for (noise, unit) in values_of(cells(), |c| (c.noise_std, c.noise_unit)) {
        for ensemble in values_of(cells(), |c| c.ensemble) {
            let rows: Vec<Scored> = tables
                .reconstruction
                .iter()
                .filter(|(c, _)| c.noise_std == noise && c.ensemble == ensemble)
                .map(|(cell, score)| (cell, score))
                .collect();
            if ensemble != Ensemble::Identity {
                let name = format!(
                    "error_{}_noise_{}",
                    file_word(ensemble),
                    short_number(noise)
                );
                charts.push((
                    name,
                    error_title(ensemble),
                    draw_errors(ensemble, noise_words(noise, unit), &rows),
                ));
            }
        }
        let rows: Vec<_> = tables
            .pareto
            .iter()
            .filter(|(c, _)| c.noise_std == noise)
            .collect();
        let name = format!("error_by_rate_noise_{}", short_number(noise));
        charts.push((
            name,
            RATE_TITLE.to_owned(),
            draw_rates(&noise_words(noise, unit), &rows),
        ));
    }
    charts
}

const RATE_TITLE: &str = "Error of reconstructed frames against frames a second";

fn file_word(ensemble: Ensemble) -> String {
    ensemble_name(ensemble)
        .to_ascii_lowercase()
        .replace(' ', "_")
}

fn error_title(ensemble: Ensemble) -> String {
    format!(
        "Error of reconstructed frames by measurements, {}",
        ensemble_name(ensemble)
    )
}

/// One panel a dictionary, one line a solver; the noisy frame itself as a dashed line.
fn draw_errors(ensemble: Ensemble, noise: String, rows: &[Scored]) -> Drawing {
    let cells = || rows.iter().map(|(cell, _)| *cell);
    let bases = values_of(cells(), |c| (c.dictionary, c.atoms));
    let solvers = values_of(cells(), |c| c.solver);
    let full = rows
        .first()
        .map_or(0.0, |(_, score)| score.full_sampling_error);
    let mut entries: Vec<LegendEntry> = solvers
        .iter()
        .enumerate()
        .map(|(line, solver)| LegendEntry::new(solver_name(*solver).to_owned(), Mark::Line(line)))
        .collect();
    entries.push(LegendEntry::new(
        "95 % interval over touches".to_owned(),
        Mark::Whisker,
    ));
    if full > 0.0 {
        let text = "full sampling: the noisy frame itself".to_owned();
        entries.push(LegendEntry::new(text, Mark::Dashes));
    }
    let columns = bases.len().clamp(1, 3);
    let width = (LEFT + columns as f64 * (PANEL.0 + GAP) - GAP + RIGHT).max(520.0);
    let settings = format!("{noise}; 0 is perfect, 1 is as wrong as an empty frame");
    let heading = Heading::of(&error_title(ensemble), &settings, entries, width);
    let panel_height = PANEL.1 + 82.0;
    let height = heading.height() + bases.len().div_ceil(columns) as f64 * panel_height;
    let mut drawing = Drawing::new(width, height);
    heading.draw(&mut drawing);
    let errors = || rows.iter().flat_map(|(_, s)| [s.error_low, s.error_high]);
    for (number, &(basis, atoms)) in bases.iter().enumerate() {
        let area = Area {
            x: LEFT + (number % columns) as f64 * (PANEL.0 + GAP),
            y: heading.height() + (number / columns) as f64 * panel_height + 24.0,
            width: PANEL.0,
            height: PANEL.1,
        };
        let x = LogScale::over(
            cells().map(|c| c.measurements as f64),
            area.x,
            area.x + area.width,
        );
        let all = errors().chain((full > 0.0).then_some(full));
        let y = LogScale::over(all, area.y + area.height, area.y);
        let title = format!("{}, {atoms} atoms", basis_name(basis));
        let above = (area.x + area.width / 2.0, area.y - 8.0);
        drawing.bold_text(above, &title, TextStyle::new(13).align(Align::Middle));
        let counts: Vec<f64> = values_of(cells(), |c| c.measurements)
            .iter()
            .map(|&m| m as f64)
            .collect();
        draw_axes(&mut drawing, area, (x, &counts), (y, &y.ticks()));
        axis_titles(
            &mut drawing,
            area,
            "measurements, m",
            (number % columns == 0).then_some("error"),
        );
        if full > 0.0 {
            let dashes = Stroke {
                dash: Some((5, 4)),
                ..Stroke::new(MUTED, 1.4)
            };
            drawing.line(
                (area.x, y.place(full)),
                (area.x + area.width, y.place(full)),
                dashes,
            );
        }
        for (line, &solver) in solvers.iter().enumerate() {
            draw_error_line(&mut drawing, rows, (basis, solver, line), (x, y));
        }
    }
    drawing
}

fn draw_error_line(
    drawing: &mut Drawing,
    rows: &[Scored],
    (basis, solver, line): (Basis, Solver, usize),
    (x, y): (LogScale, LogScale),
) {
    let of_line = rows
        .iter()
        .filter(|(c, _)| c.dictionary == basis && c.solver == solver);
    let mut points: Vec<_> = of_line.map(|(c, s)| (c.measurements as f64, s)).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let places: Vec<_> = points
        .iter()
        .map(|(m, s)| (x.place(*m), y.place(s.error)))
        .collect();
    if places.len() > 1 {
        drawing.polyline(&places, line_stroke(line));
    }
    for ((_, score), &place) in points.iter().zip(&places) {
        let (low, high) = (y.place(score.error_low), y.place(score.error_high));
        drawing.line(
            (place.0, low),
            (place.0, high),
            Stroke::new(line_colour(line), 1.5),
        );
        drawing.marker(line, place, MARKER_RADIUS, line_colour(line));
    }
}

/// Every cell of a noise level; those that no other beats are joined, numbered and named below.
fn draw_rates(noise: &str, rows: &[&(ReconstructionCell, ReconstructionPareto)]) -> Drawing {
    let solvers = values_of(rows.iter().map(|(cell, _)| cell), |c| c.solver);
    let mut entries: Vec<LegendEntry> = solvers
        .iter()
        .enumerate()
        .map(|(line, solver)| LegendEntry::new(solver_name(*solver).to_owned(), Mark::Line(line)))
        .collect();
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
        let dashes = Stroke {
            dash: Some((5, 4)),
            ..Stroke::new(MUTED, 1.2)
        };
        drawing.polyline(&joined, dashes);
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

/// `LMMSE, PCA, SBHE, m = 1024`
pub(super) fn cell_words(cell: &ReconstructionCell) -> String {
    format!(
        "{}, {}, {}, m = {}",
        solver_name(cell.solver),
        basis_name(cell.dictionary),
        ensemble_name(cell.ensemble),
        cell.measurements
    )
}

fn draw_axes(
    drawing: &mut Drawing,
    area: Area,
    (x, x_ticks): (LogScale, &[f64]),
    (y, y_ticks): (LogScale, &[f64]),
) {
    let (right, bottom) = (area.x + area.width, area.y + area.height);
    let ink = Stroke::new(INK, 1.0);
    let mut free_from = f64::NEG_INFINITY;
    let mut ticks = x_ticks.to_vec();
    ticks.sort_by(f64::total_cmp);
    for tick in ticks {
        let at = x.place(tick);
        drawing.line((at, area.y), (at, bottom), Stroke::new(GRID, 1.0));
        drawing.line((at, bottom), (at, bottom + 5.0), ink);
        let text = short_number(tick);
        let half = crate::report::text_width::text_width(&text, 12.0) / 2.0;
        if at - half > free_from {
            drawing.text(
                (at, bottom + 19.0),
                &text,
                TextStyle::new(12).align(Align::Middle),
            );
            free_from = at + half + 5.0;
        }
    }
    for &tick in y_ticks {
        let at = y.place(tick);
        drawing.line((area.x, at), (right, at), Stroke::new(GRID, 1.0));
        drawing.line((area.x - 5.0, at), (area.x, at), ink);
        let beside = (area.x - 9.0, at + 4.5);
        drawing.text(
            beside,
            &short_number(tick),
            TextStyle::new(12).align(Align::End),
        );
    }
    drawing.line((area.x, bottom), (right, bottom), ink);
    drawing.line((area.x, area.y), (area.x, bottom), ink);
}

fn axis_titles(drawing: &mut Drawing, area: Area, along_x: &str, along_y: Option<&str>) {
    let style = TextStyle::new(13).align(Align::Middle);
    let below = (area.x + area.width / 2.0, area.y + area.height + 38.0);
    drawing.text(below, along_x, style);
    if let Some(text) = along_y {
        let beside = (area.x - 46.0, area.y + area.height / 2.0);
        drawing.text(beside, text, style.angle(-90.0));
    }
}

/// A row a touch: as it was, as it was read, and as the best cells of about a quarter and of the fewest measurements found it.
pub fn draw_samples(
    tables: &ReconstructionTables,
    samples: &SampleFrames,
    (ny, nx): (usize, usize),
    pitch_mm: f64,
    quantity: Quantity,
) -> Result<Drawing> {
    let loudest = samples.noisy.iter().max_by(|a, b| a.0.total_cmp(&b.0));
    let Some((level, noisy)) = loudest else {
        return snapshots(&[], pitch_mm, quantity, "");
    };
    let shown = chosen(tables, *level);
    let mut frames = Vec::new();
    for (row, name) in samples.names.iter().enumerate() {
        let grid = |frames: &Array2<f64>| {
            let values = frames.row(row).to_vec();
            Array2::from_shape_vec((ny, nx), values).expect("one value a taxel")
        };
        frames.push((name.replace('_', " "), grid(&samples.clean)));
        frames.push(("full, noisy".to_owned(), grid(noisy)));
        for cell in &shown {
            let title = format!("{} of m = {}", solver_name(cell.solver), cell.measurements);
            frames.push((title, grid(&samples.reconstructed[cell.cell])));
        }
    }
    let words: Vec<String> = shown.iter().map(|cell| cell_words(cell)).collect();
    let unit = tables.reconstruction[0].0.noise_unit;
    let caption = format!("{}; {}", noise_words(*level, unit), words.join("; "));
    snapshots(&frames, pitch_mm, quantity, &caption)
}

/// The best cell at the m nearest to a quarter of the taxels, and at the fewest measurements.
fn chosen(tables: &ReconstructionTables, level: f64) -> Vec<&ReconstructionCell> {
    let cells = || {
        let rows = tables.reconstruction.iter();
        rows.filter(|(c, _)| c.noise_std == level && c.ensemble != Ensemble::Identity)
    };
    let off = |cell: &ReconstructionCell| (cell.ratio / 4.0).ln().abs();
    let quarter = cells()
        .min_by(|a, b| off(&a.0).total_cmp(&off(&b.0)))
        .map(|row| row.0.measurements);
    let fewest = cells().map(|(cell, _)| cell.measurements).min();
    let best = |m: usize| {
        let of_m = cells().filter(|(cell, _)| cell.measurements == m);
        of_m.min_by(|a, b| a.1.error.total_cmp(&b.1.error))
            .map(|(cell, _)| cell)
    };
    [quarter, fewest]
        .into_iter()
        .flatten()
        .filter_map(best)
        .collect()
}
