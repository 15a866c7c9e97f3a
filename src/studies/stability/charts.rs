//! Charts of a stability study: outcomes for each part, and computing time against the number of taxels.

use crate::dynamics::skin_sim::UNSTABLE_JOINTS;
use crate::studies::stability::plan::StabilityPlan;
use crate::table::{Along, At, ChartSpec, Mark, Rule, Table};

impl StabilityPlan {
    /// Returns the charts: outcome maps, followed by charts of growing arrays. A part of the study has an outcome map if it has several methods, and several
    /// time steps or masses. The map has time steps along x and taxel masses along y, one column of panels per method, and one row per setting.
    pub(crate) fn charts(&self, tables: &[Table]) -> Vec<ChartSpec> {
        let (configurations, joints) = (&tables[0], &tables[3]);
        let mut charts: Vec<ChartSpec> = Vec::new();
        for rows in configurations.groups(&["part"], 0..configurations.n_rows) {
            let n = |columns: &[&str]| configurations.groups(columns, rows.iter().copied()).len();
            if n(&["method", "solver_iterations"]) < 2 || n(&["dt_s", "taxel_mass_kg"]) < 2 {
                continue;
            }
            let mut map = map(configurations, &rows);
            let of_scene = charts.iter().filter(|chart| chart.title == map.title);
            let n_before = of_scene.count();
            if n_before > 0 {
                map.name += &format!("_{}", n_before + 1);
            }
            charts.push(map);
        }
        charts.extend(joint_charts(joints));
        charts
    }

    /// Returns one sentence per method with its number of correct results, sorted from the largest to the smallest number. A last sentence names the table of
    /// other programs if it does not exist.
    pub(crate) fn answers(&self, tables: &[Table]) -> Vec<String> {
        let summary = &tables[1];
        let methods = summary.groups(&["method", "solver_iterations"], 0..summary.n_rows);
        let found = methods.iter().map(|rows| {
            let sum = |column| rows.iter().map(|&row| summary.number(column, row)).sum();
            let (n_correct, n_configurations): (f64, f64) = (sum("n_correct"), sum("n_configurations"));
            let share = n_correct / n_configurations.max(1.0);
            let mut method = summary.words("method", rows[0]);
            let iterations = summary.words("solver_iterations", rows[0]);
            if !iterations.is_empty() {
                method += &format!(", {iterations} iterations");
            }
            let percent = 100.0 * share;
            let sentence =
                format!("Right in {n_correct} of {n_configurations} configurations ({percent:.0} %): {method}.");
            (share, sentence)
        });
        let mut found: Vec<(f64, String)> = found.collect();
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        let found = found.into_iter().map(|(_, sentence)| sentence);
        let missing = self.peers.as_ref().filter(|path| !path.exists());
        let missing = missing.map(|path| {
            format!(
                "No rows of other programs: {} does not exist.",
                path.display()
            )
        });
        found.chain(missing).collect()
    }
}

/// Returns the outcome chart of one part of the study: outcomes for each time step and taxel mass.
fn map(configurations: &Table, rows: &[usize]) -> ChartSpec {
    let scene = configurations.word("scene", rows[0]);
    let what = match scene {
        "rest" => "A ball is let go on taxels and comes to rest",
        "press" => "A ball is pressed on taxels with 0.5 m/s, held, and taken off",
        "stack_of_two" => "Two balls, one upon the other, are let go on taxels and come to rest",
        "stack_of_four" => "Four balls, one upon the other, are let go on taxels and come to rest",
        _ => "A plunger is let go on SkinSim's taxels",
    };
    let settings = [
        "stiffness_n_per_m",
        "object_mass_kg",
        "taxels",
        "solver_iterations",
    ];
    let mut chart = ChartSpec {
        shown: configurations.shown("part", rows[0]).into_iter().collect(),
        lines: varying(configurations, &settings, rows),
        panels: Some("method".to_owned()),
        mark: tiles("deflection_error"),
        rules: vec![Rule {
            along: Along::X,
            at: At::Column("explicit_limit_s".to_owned()),
            words: "limit of an explicit spring without damper, Δt = 2 √(m / k)".to_owned(),
        }],
        ..configurations.chart(
            format!("stability_{scene}"),
            format!("{what}: what is right, and what breaks"),
            ("taxel_mass_kg", "dt_s"),
        )
    };
    let mut methods = rows.iter().map(|&row| configurations.word("method", row));
    if !methods.any(|method| method.starts_with("mujoco")) {
        chart.note.clear();
    }
    chart
}

/// Returns a chart mark that draws outcomes as coloured tiles.
fn tiles(sign: &str) -> Mark {
    Mark::Tiles {
        fill: "outcome".to_owned(),
        sign: Some(sign.to_owned()),
    }
}

/// Returns the given columns that have several values in the given rows.
fn varying(table: &Table, columns: &[&str], rows: &[usize]) -> Vec<String> {
    let varies = |column: &str| table.groups(&[column], rows.iter().copied()).len() > 1;
    let varying = columns.iter().filter(|column| varies(column));
    varying.map(|column| (*column).to_owned()).collect()
}

/// Returns a chart of the computing time against the number of joints (taxels), for each time step, followed by a chart of the outcomes.
fn joint_charts(joints: &Table) -> Vec<ChartSpec> {
    let all: Vec<usize> = (0..joints.n_rows).collect();
    if all.is_empty() {
        return Vec::new();
    }
    let carried = joints.words("load_kg", 0);
    let limit = "SkinSim's authors: unstable near 280 joints";
    let chart = |name: String, title: String, y: &str| ChartSpec {
        note: format!("Each taxel carries {carried}. {}", joints.note),
        panels: Some("taxel_mass_kg".to_owned()),
        rules: vec![Rule::at(Along::X, UNSTABLE_JOINTS as f64, limit)],
        ..joints.chart(name, title, (y, "joints"))
    };
    let cost = |rows: &Vec<usize>| {
        let name = format!("stability_joints_dt_{}", joints.number("dt_s", rows[0]));
        let step = joints.words("dt_s", rows[0]);
        let title = format!(
            "Taxels on joints: what a simulated second costs as their number rises, steps of {step}"
        );
        ChartSpec {
            shown: joints.shown("dt_s", rows[0]).into_iter().collect(),
            lines: varying(joints, &["method", "solver_iterations"], rows),
            ..chart(name, title, "time_s")
        }
    };
    let steps = joints.groups(&["dt_s"], all.iter().copied());
    let mut charts: Vec<ChartSpec> = steps.iter().map(cost).collect();
    let title = "Taxels on joints: what is right as their number rises, and what breaks";
    charts.push(ChartSpec {
        lines: varying(joints, &["dt_s", "solver_iterations"], &all),
        mark: tiles("time_s"),
        ..chart("stability_joints".to_owned(), title.to_owned(), "method")
    });
    charts
}
