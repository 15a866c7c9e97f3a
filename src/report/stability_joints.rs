//! What taxels on joints cost as their number rises, and where they are right.
//!
//! A panel a taxel mass and time step: joints along x, seconds of computing a simulated second along y, a line a method. A marker says what
//! came of it.

use super::legend::{
    Heading, LegendEntry, MARKER_RADIUS, Mark, dashes, draw_cross, draw_hollow, line_colour,
    line_entries, line_stroke,
};
use super::log_scale::{LogScale, draw_axes, draw_x_ticks};
use super::panels::Panels;
use super::stability_map::method_name;
use super::time_scale::time_words;
use crate::dynamics::skin_sim::UNSTABLE_JOINTS;
use crate::report::axis::short_number;
use crate::report::colours::{GRID, INK};
use crate::report::drawing::{Align, Area, Drawing, Point, Stroke, TextStyle};
use crate::study::stability::table::{StabilityCell, StabilityTables};
use crate::study::stability::{ContactMethod, Outcome, StabilityScene};

/// Arrays of different sizes that make a ladder, at least.
const LEAST_RUNGS: usize = 3;

/// File name without ending.
pub const JOINTS_FILE: &str = "stability_joints";

/// A cell of the ladder.
struct Rung<'a> {
    cell: &'a StabilityCell,
    outcome: Outcome,
    /// Seconds a simulated second; of what steps nothing, in all.
    seconds: f64,
}

impl Rung<'_> {
    /// A line each.
    fn said(&self) -> Vec<String> {
        let came = match self.outcome {
            Outcome::Right => "right",
            Outcome::Inaccurate => "worse than 1 %",
            Outcome::MissedContact => "contact was missed",
            Outcome::EnergyGrowth => "gained energy",
            Outcome::NotFinite => "not finite",
        };
        let time = match self.cell.method {
            ContactMethod::QuasiStatic => "for the whole answer",
            _ => "of computing a simulated second",
        };
        vec![
            came.to_owned(),
            format!("{} {time}", time_words(self.seconds)),
        ]
    }
}

/// A method with its iterations.
type Line = (ContactMethod, Option<usize>);

/// The chart of the plungers whose taxels carry the same on all arrays; `None` where no three sizes are there.
pub fn draw_joints(tables: &StabilityTables) -> Option<(String, String, Drawing)> {
    let rows = tables.stability.iter().zip(&tables.timing);
    let rungs: Vec<Rung> = rows
        .filter(|((cell, _), _)| cell.scene == StabilityScene::Plunger)
        .map(|((cell, score), (_, time))| Rung {
            cell,
            outcome: score.outcome,
            seconds: time.per_simulated_s.unwrap_or(time.wall_s),
        })
        .collect();
    let load = most_rungs(&rungs)?;
    let is_of_it = |rung: &Rung| same(load_of(rung.cell), load);
    let rungs: Vec<Rung> = rungs.into_iter().filter(is_of_it).collect();
    let chart = Ladder {
        lines: distinct(rungs.iter().map(|rung| line_of(rung.cell))),
        panels: distinct(rungs.iter().map(|rung| panel_of(rung.cell))),
        load,
        rungs,
    };
    let title = chart.title();
    let drawing = chart.draw(&title);
    Some((JOINTS_FILE.to_owned(), title, drawing))
}

/// What a taxel carries, kg: of all loads the one that is on most sizes of arrays, if they are enough for a ladder.
fn most_rungs(rungs: &[Rung]) -> Option<f64> {
    let mut loads: Vec<f64> = Vec::new();
    for rung in rungs {
        let load = load_of(rung.cell);
        if !loads.iter().any(|&known| same(known, load)) {
            loads.push(load);
        }
    }
    let n_sizes = |load: f64| {
        let of_load = rungs.iter().filter(|rung| same(load_of(rung.cell), load));
        distinct(of_load.map(|rung| rung.cell.taxels)).len()
    };
    let most = loads.into_iter().max_by_key(|&load| n_sizes(load))?;
    (n_sizes(most) >= LEAST_RUNGS).then_some(most)
}

fn load_of(cell: &StabilityCell) -> f64 {
    cell.object_mass_kg.unwrap_or(0.0) / joints(cell)
}

fn joints(cell: &StabilityCell) -> f64 {
    (cell.taxels * cell.taxels) as f64
}

/// But for rounding.
fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * a.abs()
}

fn line_of(cell: &StabilityCell) -> Line {
    (cell.method, cell.solver_iterations)
}

fn panel_of(cell: &StabilityCell) -> (f64, f64) {
    (cell.taxel_mass_kg, cell.dt_s)
}

fn distinct<T: PartialEq>(values: impl Iterator<Item = T>) -> Vec<T> {
    let mut found = Vec::new();
    for value in values {
        if !found.contains(&value) {
            found.push(value);
        }
    }
    found
}

struct Ladder<'a> {
    rungs: Vec<Rung<'a>>,
    lines: Vec<Line>,
    /// Taxel mass, and time step.
    panels: Vec<(f64, f64)>,
    /// What a taxel carries, kg.
    load: f64,
}

impl Ladder<'_> {
    fn title(&self) -> String {
        "Taxels on joints: what a simulated second costs as their number rises, and what is right"
            .to_owned()
    }

    fn heading(&self, title: &str, width: f64) -> Heading {
        let names: Vec<String> = self.lines.iter().map(|&(m, n)| method_name(m, n)).collect();
        let mut entries = line_entries(names.iter().map(String::as_str));
        for (text, mark) in [
            ("worse than 1 %", Mark::Hollow),
            ("diverged, or contact missed", Mark::Cross),
            ("SkinSim's authors: unstable near 280 joints", Mark::Dashes),
        ] {
            entries.push(LegendEntry::new(text.to_owned(), mark));
        }
        let settings = format!(
            "a ball of {} g a taxel let go on SkinSim's springs and dampers; quasi-static steps nothing: its time is that of the whole answer",
            short_number(1e3 * self.load)
        );
        Heading::of(title, &settings, entries, width)
    }

    fn draw(&self, title: &str) -> Drawing {
        let columns = self.panels.len().min(2);
        let panels = Panels::new(self.panels.len(), columns, 24.0, 44.0);
        let heading = self.heading(title, panels.width());
        let top = heading.height();
        let mut drawing = Drawing::new(panels.width(), panels.bottom(top));
        heading.draw(&mut drawing);
        for (number, panel) in self.panels.iter().enumerate() {
            let area = panels.frame(number, top);
            self.draw_panel(&mut drawing, area, *panel, panels.is_first_in_row(number));
        }
        drawing
    }

    fn draw_panel(&self, drawing: &mut Drawing, area: Area, panel: (f64, f64), is_first: bool) {
        let (right, bottom) = (area.x + area.width, area.y + area.height);
        let all = || self.rungs.iter();
        let x = LogScale::over(all().map(|rung| joints(rung.cell)), area.x, right);
        let y = LogScale::over(all().map(|rung| rung.seconds), bottom, area.y);
        if is_first {
            draw_axes(drawing, area, (x, &x.ticks()), (y, &y.ticks()));
            let beside = (area.x - 55.0, area.y + area.height / 2.0);
            let style = TextStyle::new(13).align(Align::Middle).angle(-90.0);
            drawing.text(beside, "computing a simulated second, s", style);
        } else {
            draw_x_ticks(drawing, area, x, &x.ticks());
            draw_grid(drawing, area, y);
        }
        let below = (area.x + area.width / 2.0, bottom + 37.0);
        let style = TextStyle::new(13).align(Align::Middle);
        drawing.text(below, "joints", style);
        let above = format!(
            "taxels of {} g, steps of {} ms",
            short_number(1e3 * panel.0),
            short_number(1e3 * panel.1)
        );
        drawing.bold_text((area.x, area.y - 8.0), &above, TextStyle::new(13));
        let unstable = x.place(UNSTABLE_JOINTS as f64);
        drawing.line((unstable, area.y), (unstable, bottom), dashes(1.2));
        for (number, &line) in self.lines.iter().enumerate() {
            let is_here = |rung: &&Rung| panel_of(rung.cell) == panel && line_of(rung.cell) == line;
            let mut rungs: Vec<&Rung> = all().filter(is_here).collect();
            rungs.sort_by_key(|rung| rung.cell.taxels);
            let at = |rung: &Rung| (x.place(joints(rung.cell)), y.place(rung.seconds));
            let places: Vec<Point> = rungs.iter().map(|rung| at(rung)).collect();
            if places.len() > 1 {
                drawing.polyline(&places, line_stroke(number));
            }
            for (rung, &place) in rungs.iter().zip(&places) {
                draw_outcome(drawing, number, place, rung.outcome);
                let title = format!(
                    "{}, {} joints",
                    method_name(line.0, line.1),
                    joints(rung.cell)
                );
                drawing.ask(place, number, title, rung.said());
            }
        }
    }
}

/// The grid without numbers: they stand at the panel to the left.
fn draw_grid(drawing: &mut Drawing, area: Area, y: LogScale) {
    for tick in y.ticks() {
        let at = y.place(tick);
        let right = area.x + area.width;
        drawing.line((area.x, at), (right, at), Stroke::new(GRID, 1.0));
    }
    let (right, bottom) = (area.x + area.width, area.y + area.height);
    let ink = Stroke::new(INK, 1.0);
    drawing.line((area.x, bottom), (right, bottom), ink);
    drawing.line((area.x, area.y), (area.x, bottom), ink);
}

fn draw_outcome(drawing: &mut Drawing, line: usize, at: Point, outcome: Outcome) {
    match outcome {
        Outcome::Right => drawing.marker(line, at, MARKER_RADIUS, line_colour(line)),
        Outcome::Inaccurate => draw_hollow(drawing, line, at),
        _ => draw_cross(drawing, at),
    }
}
