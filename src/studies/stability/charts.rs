//! Charts of a stability study: methods in the same scenes, and computing time against the number of taxels.

use crate::dynamics::skin_sim::UNSTABLE_JOINTS;
use crate::studies::stability::common::{METHODS, SCENES};
use crate::studies::stability::plan::StabilityPlan;
use crate::table::{Along, ChartSpec, Mark, Rule, Shown, Table, Value};

/// Maximum number of methods that a title lists.
const MAX_LISTED: usize = 3;

impl StabilityPlan {
    /// Returns the charts: for each part, the number of correct results against time and a map of the outcomes for each method, both in the scenes that all
    /// methods of the part have computed; then charts of growing arrays.
    pub(crate) fn charts(&self, tables: &[Table]) -> Vec<ChartSpec> {
        let (configurations, joints) = (&tables[0], &tables[3]);
        let mut charts: Vec<ChartSpec> = Vec::new();
        let methods = tables.iter().find(|table| table.file == METHODS.name());
        if let Some(methods) = methods {
            for rows in methods.groups(&["part"], 0..methods.n_rows) {
                let mut of_part = of_part(methods, &rows, &charts);
                let mut names = rows.iter().map(|&row| methods.word("method", row));
                if names.any(|name| name.starts_with("MuJoCo")) {
                    let note = format!(" {}", configurations.note);
                    of_part.iter_mut().for_each(|chart| chart.note += &note);
                }
                charts.extend(of_part);
            }
        }
        charts.extend(joint_charts(joints));
        charts
    }

    /// Returns the titles of the charts of times as sentences. A last sentence names the table of other programs if it does not exist.
    pub(crate) fn answers(&self, charts: &[ChartSpec]) -> Vec<String> {
        let timed = charts.iter().filter(|chart| chart.table != SCENES.name());
        let missing = self.peers.as_ref().filter(|path| !path.exists());
        let missing = missing.map(|path| {
            format!(
                "No rows of other programs: {} does not exist.",
                path.display()
            )
        });
        timed
            .map(|chart| format!("{}.", chart.title))
            .chain(missing)
            .collect()
    }
}

/// Returns the two charts of a part: correct results against time, and the outcomes of each method. A repeated scene has its number in the name.
fn of_part(methods: &Table, rows: &[usize], earlier: &[ChartSpec]) -> [ChartSpec; 2] {
    let scene = methods.word("scene", rows[0]);
    let what = match scene {
        "rest" => "A ball is let go on taxels",
        "press" => "A ball is pressed on taxels with 0.5 m/s, held, and taken off",
        "stack_of_two" => "Two balls, one upon the other, are let go on taxels",
        "stack_of_four" => "Four balls, one upon the other, are let go on taxels",
        _ => "A plunger is let go on SkinSim's taxels",
    };
    let best = rows.iter().take(MAX_LISTED).map(|&row| {
        let [method, right, time] =
            ["method", "n_right", "median_s"].map(|c| methods.words(c, row));
        format!("{method} {right} in {time}")
    });
    let best = best.collect::<Vec<_>>().join("; ");
    let n = methods.number("n_scenes", rows[0]);
    let name = format!("stability_{scene}");
    let is_of_scene = |chart: &&ChartSpec| chart.name.starts_with(&name) && chart.front;
    let name = match earlier.iter().filter(is_of_scene).count() {
        0 => name,
        n => format!("{name}_{}", n + 1),
    };
    let shown: Vec<Shown> = methods.shown("part", rows[0]).into_iter().collect();
    [
        ChartSpec {
            lines: vec!["method".to_owned()],
            shown: shown.clone(),
            mark: Mark::Points,
            front: true,
            ..methods.chart(
                format!("{name}_time"),
                format!("{what}; right of the same {n} scenes: {best}"),
                ("n_right", "median_s"),
            )
        },
        ChartSpec {
            panels: Some("method".to_owned()),
            shown,
            mark: Mark::Tiles {
                fill: "outcome".to_owned(),
            },
            table: SCENES.name(),
            ..methods.chart(
                name,
                format!("{what}: what is right, and what breaks"),
                ("load", "step"),
            )
        },
    ]
}

/// Returns the given columns that have several values in the given rows.
fn varying(table: &Table, columns: &[&str], rows: &[usize]) -> Vec<String> {
    let varies = |column: &str| table.groups(&[column], rows.iter().copied()).len() > 1;
    let varying = columns.iter().filter(|column| varies(column));
    varying.map(|column| (*column).to_owned()).collect()
}

/// Returns a chart of the computing time against the number of joints (taxels) for each time step; crosses are wrong results.
fn joint_charts(joints: &Table) -> Vec<ChartSpec> {
    let steps = joints.groups(&["dt_s"], 0..joints.n_rows);
    let chart = |(number, rows): (usize, &Vec<usize>)| {
        let step = joints.words("dt_s", rows[0]);
        let name = match number {
            0 => "stability_joints".to_owned(),
            _ => format!("stability_joints_dt_{}", joints.number("dt_s", rows[0])),
        };
        let title = format!(
            "Taxels on joints, steps of {step}: {}",
            largest_words(joints, rows)
        );
        let limit = "SkinSim's authors: unstable near 280 joints";
        ChartSpec {
            note: format!(
                "Each taxel carries {}. {}",
                joints.words("load_kg", rows[0]),
                joints.note
            ),
            shown: joints.shown("dt_s", rows[0]).into_iter().collect(),
            lines: varying(joints, &["method", "solver_iterations"], rows),
            panels: Some("taxel_mass_kg".to_owned()),
            right: Some(Shown {
                column: "outcome".to_owned(),
                value: Value::from("right"),
            }),
            rules: vec![
                Rule::at(Along::X, UNSTABLE_JOINTS as f64, limit),
                Rule::at(Along::Y, 1.0, "real time"),
            ],
            ..joints.chart(name, title, ("time_s", "joints"))
        }
    };
    steps.iter().enumerate().map(chart).collect()
}

/// Returns the methods that are right on the largest array and its lightest taxels as text, the fastest first.
fn largest_words(joints: &Table, rows: &[usize]) -> String {
    let number = |column| move |row: &usize| joints.number(column, *row);
    let most = rows.iter().map(number("joints")).fold(0.0, f64::max);
    let here = rows.iter().filter(|row| number("joints")(row) == most);
    let masses = here.clone().map(number("taxel_mass_kg"));
    let lightest = masses.fold(f64::INFINITY, f64::min);
    let mut here: Vec<usize> = here.copied().collect();
    here.retain(|row| {
        number("taxel_mass_kg")(row) == lightest && joints.word("outcome", *row) == "right"
    });
    here.sort_by(|a, b| number("time_s")(a).total_cmp(&number("time_s")(b)));
    let words = |column: &str, row: usize| joints.words(column, row);
    let said = here.iter().take(MAX_LISTED);
    let said = said.map(|&row| format!("{} in {}", words("method", row), words("time_s", row)));
    match here.first() {
        None => format!("nothing is right on {most}"),
        Some(&row) => format!(
            "right on {most} of {}: {}",
            words("taxel_mass_kg", row),
            said.collect::<Vec<_>>().join(", ")
        ),
    }
}
