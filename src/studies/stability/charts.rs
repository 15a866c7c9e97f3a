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
        if let Some(methods) = tables.iter().find(|table| table.file == METHODS.name()) {
            for rows in methods.groups(&["part"], 0..methods.n_rows) {
                let part = Value::Number(methods.number("part", rows[0]));
                let mut all = 0..configurations.n_rows;
                let row = all.find(|&row| configurations.has_setting("part", row, &part));
                let scene = row.map_or("", |row| configurations.word("scene", row));
                let mut of_part = of_part(methods, scene, &rows, &charts);
                let mut names = rows.iter().map(|&row| methods.word("method", row));
                if names.any(|name| name.starts_with("MuJoCo")) {
                    of_part
                        .iter_mut()
                        .for_each(|chart| chart.note += &format!(" {}", configurations.note));
                }
                charts.extend(of_part);
            }
        }
        charts.extend(joint_charts(joints));
        charts
    }

    /// Returns one sentence per part with the number of correct results of each method in the same scenes. A last sentence names the table of other programs if
    /// it does not exist.
    pub(crate) fn answers(&self, tables: &[Table]) -> Vec<String> {
        let methods = tables.iter().find(|table| table.file == METHODS.name());
        let found = methods.into_iter().flat_map(|methods| {
            let parts = methods.groups(&["part"], 0..methods.n_rows).into_iter();
            parts.map(|rows| {
                let part = methods.number("part", rows[0]);
                let best = right_words(methods, &rows, MAX_LISTED);
                let others = match rows.len().saturating_sub(MAX_LISTED) {
                    0 => String::new(),
                    n => format!("; {n} other methods are no better"),
                };
                format!("Part {part}, {best}{others}.")
            })
        });
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

/// Returns the numbers of correct results of the first methods as text, such as `right in the same 81 scenes: implicit Euler 81 in 34 µs, …`.
fn right_words(methods: &Table, rows: &[usize], most: usize) -> String {
    let n = methods.number("n_scenes", rows[0]);
    let said = rows.iter().take(most).map(|&row| {
        let [method, right, time] =
            ["method", "n_right", "median_s"].map(|c| methods.words(c, row));
        format!("{method} {right} in {time}")
    });
    let said: Vec<String> = said.collect();
    format!("right of the same {n} scenes: {}", said.join("; "))
}

/// Returns the two charts of a part: correct results against time, and the outcomes of each method.
fn of_part(methods: &Table, scene: &str, rows: &[usize], earlier: &[ChartSpec]) -> [ChartSpec; 2] {
    let what = match scene {
        "rest" => "A ball is let go on taxels",
        "press" => "A ball is pressed on taxels with 0.5 m/s, held, and taken off",
        "stack_of_two" => "Two balls, one upon the other, are let go on taxels",
        "stack_of_four" => "Four balls, one upon the other, are let go on taxels",
        _ => "A plunger is let go on SkinSim's taxels",
    };
    let name = format!("stability_{scene}");
    let is_of_scene = |chart: &&ChartSpec| chart.name.starts_with(&name) && chart.front;
    let name = match earlier.iter().filter(is_of_scene).count() {
        0 => name,
        n => format!("{name}_{}", n + 1),
    };
    let chart = |name: String, title: String, table: &'static str, axes: [&str; 2]| ChartSpec {
        name,
        title,
        note: methods.note.clone(),
        table,
        shown: methods.shown("part", rows[0]).into_iter().collect(),
        x: axes[0].to_owned(),
        y: axes[1].to_owned(),
        ..ChartSpec::default()
    };
    let best = right_words(methods, rows, MAX_LISTED);
    [
        ChartSpec {
            lines: vec!["method".to_owned()],
            mark: Mark::Points,
            front: true,
            ..chart(
                format!("{name}_time"),
                format!("{what}; {best}"),
                METHODS.name(),
                ["median_s", "n_right"],
            )
        },
        ChartSpec {
            panels: Some("method".to_owned()),
            mark: Mark::Tiles {
                fill: "outcome".to_owned(),
            },
            ..chart(
                name,
                format!("{what}: what is right, and what breaks"),
                SCENES.name(),
                ["step", "load"],
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
    let number = |column, row| joints.number(column, row);
    let most = rows
        .iter()
        .map(|&row| number("joints", row))
        .fold(0.0, f64::max);
    let mut here: Vec<usize> = rows.to_vec();
    here.retain(|&row| number("joints", row) == most);
    let lightest = here
        .iter()
        .map(|&row| number("taxel_mass_kg", row))
        .fold(f64::INFINITY, f64::min);
    here.retain(|&row| {
        number("taxel_mass_kg", row) == lightest && joints.word("outcome", row) == "right"
    });
    here.sort_by(|&a, &b| number("time_s", a).total_cmp(&number("time_s", b)));
    let said = here.iter().take(MAX_LISTED).map(|&row| {
        format!(
            "{} in {}",
            joints.words("method", row),
            joints.words("time_s", row)
        )
    });
    let said: Vec<String> = said.collect();
    let mass = here
        .first()
        .map_or_else(String::new, |&row| joints.words("taxel_mass_kg", row));
    match said.is_empty() {
        true => format!("nothing is right on {most}"),
        false => format!("right on {most} of {mass}: {}", said.join(", ")),
    }
}
