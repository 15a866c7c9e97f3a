//! What is charted: a map for each part of a study, and what taxels on joints cost.

use crate::dynamics::skin_sim::UNSTABLE_JOINTS;
use crate::table::{Along, At, ChartSpec, Mark, Rule, Table};

/// Maps of parts with several methods and several steps or masses: time steps across, taxel masses up, a panel a method and a row of
/// panels a setting; then the ladder of joints.
pub(super) fn charts(tables: &[Table]) -> Vec<ChartSpec> {
    let [cells, _, _, joints, ..] = tables else {
        return Vec::new();
    };
    let mut charts: Vec<ChartSpec> = Vec::new();
    for rows in cells.groups(&["part"], 0..cells.n_rows) {
        let n = |columns: &[&str]| cells.groups(columns, rows.iter().copied()).len();
        if n(&["method", "solver_iterations"]) < 2 || n(&["dt_s", "taxel_mass_kg"]) < 2 {
            continue;
        }
        let map = map(cells, &rows);
        let n_before = charts
            .iter()
            .filter(|chart| chart.title == map.title)
            .count();
        let name = match n_before {
            0 => map.name,
            n => format!("{}_{}", map.name, n + 1),
        };
        charts.push(ChartSpec { name, ..map });
    }
    charts.extend(joint_charts(joints));
    charts
}

/// Of one part.
fn map(cells: &Table, rows: &[usize]) -> ChartSpec {
    let scene = cells.word("scene", rows[0]);
    let what = match scene {
        "rest" => "A ball is let go on taxels and comes to rest",
        "press" => "A ball is pressed on taxels with 0.5 m/s, held, and taken off",
        _ => "A plunger is let go on SkinSim's taxels",
    };
    let has_peers = rows
        .iter()
        .any(|&row| cells.word("method", row).starts_with("mujoco"));
    let settings = [
        "stiffness_n_per_m",
        "object_mass_kg",
        "taxels",
        "solver_iterations",
    ];
    ChartSpec {
        name: format!("stability_{scene}"),
        title: format!("{what}: what is right, and what breaks"),
        note: if has_peers {
            cells.note.clone()
        } else {
            String::new()
        },
        table: cells.file,
        shown: cells.shown("part", rows[0]).into_iter().collect(),
        x: "dt_s".to_owned(),
        y: "taxel_mass_kg".to_owned(),
        lines: varying(cells, &settings, rows),
        panels: Some("method".to_owned()),
        mark: Mark::Tiles {
            fill: "outcome".to_owned(),
            sign: Some("deflection_error".to_owned()),
        },
        rules: vec![Rule {
            along: Along::X,
            at: At::Column("explicit_limit_s".to_owned()),
            words: "limit of an explicit spring without damper, Δt = 2 √(m / k)".to_owned(),
        }],
        ..ChartSpec::default()
    }
}

/// Those of some columns that have several values in these rows.
fn varying(table: &Table, columns: &[&str], rows: &[usize]) -> Vec<String> {
    let varies = |column: &&&str| table.groups(&[**column], rows.iter().copied()).len() > 1;
    columns
        .iter()
        .filter(varies)
        .map(|column| (*column).to_owned())
        .collect()
}

/// Of each time step what joints cost, then what comes of all of them.
fn joint_charts(joints: &Table) -> Vec<ChartSpec> {
    let all: Vec<usize> = (0..joints.n_rows).collect();
    if all.is_empty() {
        return Vec::new();
    }
    let chart = ChartSpec {
        note: format!(
            "Each taxel carries {}. {}",
            joints.words("carried_kg", 0),
            joints.note
        ),
        table: joints.file,
        x: "joints".to_owned(),
        panels: Some("taxel_mass_kg".to_owned()),
        rules: vec![Rule {
            along: Along::X,
            at: At::Value(UNSTABLE_JOINTS as f64),
            words: "SkinSim's authors: unstable near 280 joints".to_owned(),
        }],
        ..ChartSpec::default()
    };
    let cost = |rows: &Vec<usize>| {
        let step = joints.words("dt_s", rows[0]);
        ChartSpec {
            name: format!("stability_joints_dt_{}", joints.number("dt_s", rows[0])),
            title: format!(
                "Taxels on joints: what a simulated second costs as their number rises, steps of {step}"
            ),
            shown: joints.shown("dt_s", rows[0]).into_iter().collect(),
            y: "time_s".to_owned(),
            lines: varying(joints, &["method", "solver_iterations"], rows),
            ..chart.clone()
        }
    };
    let steps = joints.groups(&["dt_s"], all.iter().copied());
    let mut charts: Vec<ChartSpec> = steps.iter().map(cost).collect();
    charts.push(ChartSpec {
        name: "stability_joints".to_owned(),
        title: "Taxels on joints: what is right as their number rises, and what breaks".to_owned(),
        y: "method".to_owned(),
        lines: varying(joints, &["dt_s", "solver_iterations"], &all),
        mark: Mark::Tiles {
            fill: "outcome".to_owned(),
            sign: Some("time_s".to_owned()),
        },
        ..chart
    });
    charts
}

/// How often each method is right, the best first.
pub(super) fn answers(tables: &[Table]) -> Vec<String> {
    let [_, summary, ..] = tables else {
        return Vec::new();
    };
    let sum = |column: &str, rows: &[usize]| {
        rows.iter()
            .map(|&row| summary.number(column, row))
            .sum::<f64>()
    };
    let methods = summary.groups(&["method", "solver_iterations"], 0..summary.n_rows);
    let mut found: Vec<(f64, String)> = methods
        .iter()
        .map(|rows| {
            let (n_right, n_cells) = (sum("n_right", rows), sum("n_cells", rows));
            let share = n_right / n_cells.max(1.0);
            let iterations = summary.words("solver_iterations", rows[0]);
            let iterations = match iterations.is_empty() {
                true => iterations,
                false => format!(", {iterations} iterations"),
            };
            let method = summary.words("method", rows[0]);
            let percent = 100.0 * share;
            (
                share,
                format!(
                    "Right in {n_right} of {n_cells} cells ({percent:.0} %): {method}{iterations}."
                ),
            )
        })
        .collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found.into_iter().map(|(_, sentence)| sentence).collect()
}
