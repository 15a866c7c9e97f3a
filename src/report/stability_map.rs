//! Stability maps: for each part of a study, where each method is right and how it breaks.
//!
//! A panel a method and setting: time steps along x, taxel masses along y (as mass ratios where the ball is free). A cell's colour and
//! sign say what came of it; the line is the limit of an explicit spring, Δt = 2 √(m / k).

use super::legend::{LEFT, RIGHT};
use crate::report::axis::short_number;
use crate::report::colours::{INK, LINES, MUTED, PAPER, Rgb, text_on};
use crate::report::drawing::{Align, Area, Drawing, Point, Stroke, TextStyle};
use crate::report::text_width::{text_width, wrap};
use crate::study::stability::table::{StabilityCell, StabilityScore, StabilityTables};
use crate::study::stability::{ContactMethod, Outcome, StabilityScene, TOLERANCE};

/// Pixels of a cell.
const CELL: (f64, f64) = (36.0, 20.0);
/// Pixels between panels.
const GAP: f64 = 16.0;
/// Pixels above a row of panels, for its title.
const ABOVE: f64 = 22.0;

/// The line of the explicit limit.
const LIMIT: Stroke = Stroke {
    colour: INK,
    width: 1.5,
    dash: Some((4, 3)),
};

type Row = (StabilityCell, StabilityScore);

/// All maps: file name without ending, title, drawing. Parts with one method or one step and mass have none.
pub fn draw_stability_maps(tables: &StabilityTables) -> Vec<(String, String, Drawing)> {
    let mut maps: Vec<(String, String, Drawing)> = Vec::new();
    let parts = tables.stability.chunk_by(|a, b| a.0.part == b.0.part);
    for rows in parts {
        let map = Map::of(rows, &tables.peers);
        if map.columns.len() < 2 || map.dts.len() * map.masses.len() < 2 {
            continue;
        }
        let scene = format!("stability_{}", scene_file(map.scene));
        let n_before = maps.iter().filter(|map| map.0.starts_with(&scene)).count();
        let name = match n_before {
            0 => scene,
            n => format!("{scene}_{}", n + 1),
        };
        let drawing = map.draw();
        maps.push((name, map.title().to_owned(), drawing));
    }
    maps
}

/// A method in words.
pub(super) fn method_name(method: ContactMethod, iterations: Option<usize>) -> String {
    let name = match method {
        ContactMethod::QuasiStatic => "quasi-static (ours)",
        ContactMethod::SemiImplicit => "semi-implicit Euler, penalty",
        ContactMethod::ImplicitEuler => "implicit Euler, exact contact",
        ContactMethod::RapierAsItComes => "rapier as it comes",
        ContactMethod::RapierTuned => "rapier tuned",
        ContactMethod::RapierSkinSim => "rapier as SkinSim's engine",
        ContactMethod::MujocoEuler => "MuJoCo as it comes",
        ContactMethod::MujocoImplicitfast => "MuJoCo, implicitfast",
        ContactMethod::MujocoDiscrete => "MuJoCo, discrete, hard",
    };
    match iterations {
        Some(n) => format!("{name}, {n} iterations"),
        None => name.to_owned(),
    }
}

fn scene_file(scene: StabilityScene) -> &'static str {
    match scene {
        StabilityScene::Rest => "rest",
        StabilityScene::Press => "press",
        StabilityScene::Plunger => "plunger",
    }
}

/// One part of a study.
struct Map<'a> {
    rows: &'a [Row],
    /// Who measured the rows of other programs, and when.
    peers: &'a str,
    scene: StabilityScene,
    /// Methods and iterations.
    columns: Vec<(ContactMethod, Option<usize>)>,
    /// What a row of panels has in common: stiffness, mass of the ball, taxels a side.
    settings: Vec<(f64, Option<f64>, usize)>,
    /// Of taxels, ascending.
    masses: Vec<f64>,
    /// Ascending.
    dts: Vec<f64>,
}

impl<'a> Map<'a> {
    fn of(rows: &'a [Row], peers: &'a str) -> Self {
        let cells = || rows.iter().map(|(cell, _)| cell);
        let rising = |values: Vec<f64>| {
            let mut values = distinct(values);
            values.sort_by(f64::total_cmp);
            values
        };
        Self {
            rows,
            peers,
            scene: rows[0].0.scene,
            columns: distinct(
                cells()
                    .map(|cell| (cell.method, cell.solver_iterations))
                    .collect(),
            ),
            settings: distinct(cells().map(setting).collect()),
            masses: rising(cells().map(|cell| cell.taxel_mass_kg).collect()),
            dts: rising(cells().map(|cell| cell.dt_s).collect()),
        }
    }

    fn title(&self) -> &'static str {
        match self.scene {
            StabilityScene::Rest => {
                "A ball is let go on taxels and comes to rest: what is right, and what breaks"
            }
            StabilityScene::Press => {
                "A ball is pressed on taxels with 0.5 m/s, held, and taken off: what is right, and what breaks"
            }
            StabilityScene::Plunger => {
                "A plunger is let go on SkinSim's taxels: what is right, and what breaks"
            }
        }
    }

    fn panel_size(&self) -> (f64, f64) {
        (
            self.dts.len() as f64 * CELL.0,
            self.masses.len() as f64 * CELL.1,
        )
    }

    fn draw(&self) -> Drawing {
        let (width, height) = self.panel_size();
        let n_columns = self.columns.len() as f64;
        let across = LEFT + n_columns * width + (n_columns - 1.0) * GAP + RIGHT;
        let across = across.max(640.0);
        let title = wrap(self.title(), 17.5, across - LEFT - RIGHT);
        let names: Vec<Vec<String>> = self
            .columns
            .iter()
            .map(|&(method, iterations)| wrap(&method_name(method, iterations), 13.0, width))
            .collect();
        let n_lines = names.iter().map(Vec::len).max().unwrap_or(1) as f64;
        let legend = 20.0 + 21.0 * title.len() as f64;
        let top = legend + 3.0 * 20.0 + 14.0 + 16.0 * n_lines;
        let n_rows = self.settings.len() as f64;
        let bottom = top + n_rows * (ABOVE + height + GAP * 0.5);
        let mut drawing = Drawing::new(across, bottom + 52.0);
        for (line, text) in title.iter().enumerate() {
            let at = (LEFT, 26.0 + 21.0 * line as f64);
            drawing.bold_text(at, text, TextStyle::new(16));
        }
        self.draw_legend(&mut drawing, legend);
        for (column, lines) in names.iter().enumerate() {
            let x = LEFT + column as f64 * (width + GAP);
            for (line, text) in lines.iter().rev().enumerate() {
                let at = (x, top - 4.0 - 16.0 * line as f64);
                drawing.bold_text(at, text, TextStyle::new(12));
            }
        }
        for (row, setting) in self.settings.iter().enumerate() {
            let y = top + row as f64 * (ABOVE + height + GAP * 0.5);
            let style = TextStyle::new(12).colour(MUTED);
            drawing.text((LEFT, y + ABOVE - 6.0), &self.words(setting), style);
            for column in 0..self.columns.len() {
                let area = Area {
                    x: LEFT + column as f64 * (width + GAP),
                    y: y + ABOVE,
                    width,
                    height,
                };
                self.draw_panel(&mut drawing, area, setting, column);
            }
            self.draw_masses(&mut drawing, y + ABOVE, setting);
        }
        for column in 0..self.columns.len() {
            let x = LEFT + column as f64 * (width + GAP);
            self.draw_dts(&mut drawing, x, bottom);
        }
        drawing
    }

    /// What a row of panels has in common.
    fn words(&self, &(stiffness, mass, taxels): &(f64, Option<f64>, usize)) -> String {
        let mut words = format!("k = {} N/m", power(stiffness));
        if let Some(mass) = mass {
            words += &format!(", ball of {} kg", power(mass));
        }
        format!("{words}, {taxels} × {taxels} taxels")
    }

    fn draw_panel(
        &self,
        drawing: &mut Drawing,
        area: Area,
        setting_of_row: &(f64, Option<f64>, usize),
        column: usize,
    ) {
        let of_panel = self.rows.iter().filter(|(cell, _)| {
            setting(cell) == *setting_of_row
                && (cell.method, cell.solver_iterations) == self.columns[column]
        });
        let mut signs = Vec::new();
        for (cell, score) in of_panel {
            let (Some(x), Some(y)) = (
                self.dts.iter().position(|&dt| dt == cell.dt_s),
                self.masses.iter().position(|&m| m == cell.taxel_mass_kg),
            ) else {
                continue;
            };
            let place = Area {
                x: area.x + x as f64 * CELL.0,
                y: area.y + area.height - (y + 1) as f64 * CELL.1,
                width: CELL.0,
                height: CELL.1,
            };
            let (fill, sign) = look(score);
            draw_ground(drawing, place, fill);
            signs.push((place, fill, sign));
        }
        self.draw_limit(drawing, area, setting_of_row.0);
        for (place, fill, sign) in signs {
            draw_sign(drawing, place, fill, &sign);
        }
        drawing.frame(area, Stroke::new(INK, 1.0));
    }

    /// Δt = 2 √(m / k), one step of a stair a mass.
    fn draw_limit(&self, drawing: &mut Drawing, area: Area, stiffness: f64) {
        let mut stair: Vec<Point> = Vec::new();
        for (row, mass) in self.masses.iter().enumerate() {
            let x = area.x + self.place(2.0 * (mass / stiffness).sqrt());
            let low = area.y + area.height - row as f64 * CELL.1;
            stair.extend([(x, low), (x, low - CELL.1)]);
        }
        drawing.polyline(&stair, Stroke::new(PAPER, 3.5));
        drawing.polyline(&stair, LIMIT);
    }

    /// Where a time step stands in a panel, pixels from its left; at its edges what is beyond.
    fn place(&self, dt: f64) -> f64 {
        let logs: Vec<f64> = self.dts.iter().map(|dt| dt.ln()).collect();
        let last = logs.len() - 1;
        let wanted = dt.ln();
        let above = logs.iter().position(|&log| log > wanted);
        let share = match above {
            _ if last == 0 => match wanted < logs[0] {
                true => -0.5,
                false => 0.5,
            },
            Some(0) => (wanted - logs[0]) / (logs[1] - logs[0]),
            Some(k) => (k - 1) as f64 + (wanted - logs[k - 1]) / (logs[k] - logs[k - 1]),
            None => last as f64 + (wanted - logs[last]) / (logs[last] - logs[last - 1]),
        };
        CELL.0 * (share + 0.5).clamp(0.0, logs.len() as f64)
    }

    fn draw_masses(&self, drawing: &mut Drawing, y: f64, setting: &(f64, Option<f64>, usize)) {
        let height = self.panel_size().1;
        let style = TextStyle::new(11).align(Align::End);
        for (row, mass) in self.masses.iter().enumerate() {
            let text = match setting.1 {
                Some(ball) => power(ball / mass),
                None => power(*mass),
            };
            let at = (LEFT - 6.0, y + height - (row as f64 + 0.5) * CELL.1 + 4.0);
            drawing.text(at, &text, style);
        }
        let what = match setting.1 {
            Some(_) => "M : m",
            None => "m, kg",
        };
        let style = TextStyle::new(11).align(Align::Middle).colour(MUTED);
        drawing.text((LEFT - 46.0, y + height / 2.0), what, style.angle(-90.0));
    }

    fn draw_dts(&self, drawing: &mut Drawing, x: f64, bottom: f64) {
        let style = TextStyle::new(11).align(Align::Middle);
        for (column, dt) in self.dts.iter().enumerate() {
            let at = (x + (column as f64 + 0.5) * CELL.0, bottom + 8.0);
            drawing.text(at, &short_number(1e3 * dt), style);
        }
        let middle = x + 0.5 * self.panel_size().0;
        drawing.text(
            (middle, bottom + 26.0),
            "time step, ms",
            style.colour(MUTED),
        );
    }

    fn draw_legend(&self, drawing: &mut Drawing, top: f64) {
        let entries = [
            (
                Outcome::Right,
                "−9",
                format!("within {} %", 100.0 * TOLERANCE),
            ),
            (
                Outcome::Inaccurate,
                "−1",
                "worse; the number is the power of ten of the error".to_owned(),
            ),
            (Outcome::MissedContact, "m", "contact was missed".to_owned()),
            (Outcome::EnergyGrowth, "e", "gained energy".to_owned()),
            (Outcome::NotFinite, "n", "not finite".to_owned()),
        ];
        let mut at = (LEFT, top + 8.0);
        for (number, (outcome, sign, text)) in entries.iter().enumerate() {
            if number == 2 {
                at = (LEFT, at.1 + 20.0);
            }
            let place = Area {
                x: at.0,
                y: at.1 - 12.0,
                width: 26.0,
                height: 15.0,
            };
            draw_ground(drawing, place, colour(*outcome));
            draw_sign(drawing, place, colour(*outcome), sign);
            drawing.text((at.0 + 32.0, at.1), text, TextStyle::new(12));
            at.0 += 56.0 + text_width(text, 12.0);
        }
        let y = at.1 + 20.0;
        drawing.line((LEFT, y - 4.0), (LEFT + 26.0, y - 4.0), LIMIT);
        let text = "limit of an explicit spring without damper, Δt = 2 √(m / k)";
        drawing.text((LEFT + 32.0, y), text, TextStyle::new(12));
        if self.columns.iter().any(|(method, _)| method.is_peer()) {
            let at = (LEFT + 56.0 + text_width(text, 12.0), y);
            drawing.text(at, self.peers, TextStyle::new(12).colour(MUTED));
        }
    }
}

fn setting(cell: &StabilityCell) -> (f64, Option<f64>, usize) {
    (cell.stiffness_n_per_m, cell.object_mass_kg, cell.taxels)
}

fn distinct<T: PartialEq>(values: Vec<T>) -> Vec<T> {
    let mut found = Vec::new();
    for value in values {
        if !found.contains(&value) {
            found.push(value);
        }
    }
    found
}

/// Blue is right, ochre is off, red has no contact, black is gone: told apart by lightness, too.
fn colour(outcome: Outcome) -> Rgb {
    match outcome {
        Outcome::Right => LINES[5],
        Outcome::Inaccurate => LINES[4],
        Outcome::MissedContact => LINES[1],
        Outcome::EnergyGrowth => LINES[7],
        Outcome::NotFinite => INK,
    }
}

fn look(score: &StabilityScore) -> (Rgb, String) {
    let sign = match score.outcome {
        Outcome::MissedContact => "m".to_owned(),
        Outcome::EnergyGrowth => "e".to_owned(),
        Outcome::NotFinite => "n".to_owned(),
        Outcome::Right | Outcome::Inaccurate => {
            let errors = [score.deflection_error, score.force_imbalance];
            let worst = errors.into_iter().flatten().fold(0.0, f64::max);
            // Rounding has no size worth a number.
            let tenths = worst.max(1e-15).log10().floor() as i32;
            tenths.to_string().replace('-', "−")
        }
    };
    (colour(score.outcome), sign)
}

fn draw_ground(drawing: &mut Drawing, place: Area, fill: Rgb) {
    drawing.area(place, fill);
    drawing.frame(place, Stroke::new(PAPER, 1.0));
}

/// On a ground of its own, so that no line runs through it: a minus would be read as a plus.
fn draw_sign(drawing: &mut Drawing, place: Area, fill: Rgb, sign: &str) {
    let width = text_width(sign, 11.0) + 4.0;
    let ground = Area {
        x: place.x + 0.5 * (place.width - width),
        y: place.y + 3.0,
        width,
        height: place.height - 6.0,
    };
    drawing.area(ground, fill);
    let middle = (
        place.x + place.width / 2.0,
        place.y + place.height / 2.0 + 4.0,
    );
    let style = TextStyle::new(11).align(Align::Middle);
    drawing.text(middle, sign, style.colour(text_on(fill)));
}

/// `10⁻⁷` for powers of ten beyond what is read easily, else the number.
fn power(value: f64) -> String {
    let exponent = value.log10().round();
    let is_power = (value.log10() - exponent).abs() < 1e-9;
    if !is_power || exponent.abs() < 4.0 {
        return short_number(value);
    }
    let digits = format!("{exponent}");
    let raised = digits.chars().map(|digit| match digit {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => char::from_u32('⁰' as u32 + digit as u32 - '0' as u32).unwrap_or(digit),
    });
    format!("10{}", raised.collect::<String>())
}
