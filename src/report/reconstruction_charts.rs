//! Charts of a reconstruction study: error against measurements here, error against rate in `reconstruction_rates`.

use super::legend::{
    Heading, LEFT, LegendEntry, MARKER_RADIUS, Mark, RIGHT, dashes, line_colour, line_entries,
    line_stroke,
};
use super::log_scale::{LogScale, axis_titles, draw_axes};
use super::reconstruction_rates::{RATE_TITLE, draw_rates};
use crate::report::axis::{basis_name, ensemble_name, short_number, solver_name};
use crate::report::drawing::{Align, Area, Drawing, Stroke, TextStyle};
use crate::sensing::{Basis, Ensemble, Solver};
use crate::signal::NoiseUnit;
use crate::study::reconstruction::table::{
    ReconstructionCell, ReconstructionScore, ReconstructionTables,
};

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
    let mut entries = line_entries(solvers.iter().map(|&solver| solver_name(solver)));
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
            let (left, right) = (area.x, area.x + area.width);
            drawing.line((left, y.place(full)), (right, y.place(full)), dashes(1.4));
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
