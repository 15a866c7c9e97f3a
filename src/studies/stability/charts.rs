//! Charts of a stability study: methods in the same scenes, and computing time against the number of taxels.
//!
//! Methods are compared in the scenes that all methods of a part have computed, because shares of different scenes differ. A method that has computed less than
//! half of the scenes is not compared.

use crate::dynamics::skin_sim::UNSTABLE_JOINTS;
use crate::studies::prelude::*;
use crate::studies::stability::plan::*;
use crate::studies::stability::rows::*;
use crate::table::{Along, Rule, Shown, Value};

/// Table of the outcomes in the common scenes, which is not written to a file.
pub(super) const SCENES: File<CommonScene> = File::new(
    "common_scenes.csv",
    "Scenes that all methods have computed",
    "Right: force and deflections within 1 % of the exact result.",
);
/// Table of the methods in the common scenes, which is not written to a file.
pub(super) const METHODS: File<MethodScore> = File::new(
    "common_methods.csv",
    "Methods in the same scenes",
    "Right: force and deflections within 1 % of the exact result. Times are of one thread while other threads run other simulations.",
);

/// Number of array sizes from which a part of the study is a series of growing arrays, which has charts of its own.
const MANY_SIZES: usize = 3;

/// Columns that distinguish the scenes of a part.
const SCENE: [&str; 5] = [
    "stiffness_n_per_m",
    "object_mass_kg",
    "taxels",
    "dt_s",
    "taxel_mass_kg",
];

/// Returns the tables of a study, followed by the tables of the common scenes. Parts with one method, one scene or growing arrays have no rows in them.
///
/// # Errors
/// If a row cannot be written to a table.
pub(super) fn with_common(mut tables: Vec<Table>) -> Result<Vec<Table>> {
    let (configurations, timing) = (&tables[0], &tables[2]);
    let (mut scenes, mut methods) = (Vec::new(), Vec::new());
    for rows in configurations.groups(&["part"], 0..configurations.n_rows.min(timing.n_rows)) {
        let of_part = scored_methods(configurations, timing, &rows);
        for (score, of_method) in of_part {
            methods.push(score);
            scenes.extend(of_method);
        }
    }
    for table in [SCENES.table(&scenes)?, METHODS.table(&methods)?] {
        tables.push(table.with((table.file, table.title), None));
    }
    Ok(tables)
}

/// Returns the score and the outcomes of each method of a part in its common scenes: the method with the most correct results first, and the faster one first
/// among equals.
fn scored_methods(
    configurations: &Table,
    timing: &Table,
    rows: &[usize],
) -> Vec<(MethodScore, Vec<CommonScene>)> {
    let groups = |columns: &[&str]| configurations.groups(columns, rows.iter().copied());
    let mut by_method = groups(&["method", "solver_iterations"]);
    let n_scenes = groups(&SCENE).len();
    by_method.retain(|rows| 2 * rows.len() >= n_scenes);
    let compared = by_method.iter().flatten().copied();
    let mut common = configurations.groups(&SCENE, compared);
    common.retain(|rows| rows.len() == by_method.len());
    if by_method.len() < 2 || common.len() < 2 || groups(&["taxels"]).len() >= MANY_SIZES {
        return Vec::new();
    }
    // Stiff taxels are at the top, long steps and light taxels on the right.
    common.sort_by(|a, b| {
        let key = |rows: &[usize]| {
            let [stiffness, mass, taxels, step, taxel] =
                SCENE.map(|column| configurations.number(column, rows[0]));
            // A ball whose motion is imposed has no mass.
            [-stiffness, mass.max(0.0), taxels, step, -taxel]
        };
        let order = key(a).partial_cmp(&key(b));
        order.expect("all are numbers")
    });
    let varies = |column: &str| groups(&[column]).len() > 1;
    let words = |columns: &[&str], row: usize| {
        let varying = columns.iter().filter(|column| varies(column));
        let words = varying.map(|column| configurations.words(column, row));
        words.collect::<Vec<_>>().join(", ")
    };
    let mut n_iterations = groups(&["solver_iterations"]);
    n_iterations.retain(|rows| {
        configurations
            .number("solver_iterations", rows[0])
            .is_finite()
    });
    let method_words = |row: usize| {
        let method = configurations.words("method", row);
        match &configurations.words("solver_iterations", row)[..] {
            n if n_iterations.len() > 1 && !n.is_empty() => {
                format!("{method}, {n} iterations")
            }
            _ => method,
        }
    };
    let scored = by_method.iter().map(|of_method| {
        let own = common
            .iter()
            .filter_map(|rows| rows.iter().find(|row| of_method.contains(row)));
        let scenes = own.map(|&row| CommonScene {
            part: configurations.number("part", row) as usize,
            method: method_words(row),
            step: words(&SCENE[3..], row),
            load: words(&SCENE[..3], row),
            outcome: configurations.word("outcome", row).to_owned(),
            wall_s: timing.number("wall_s", row),
        });
        let scenes: Vec<CommonScene> = scenes.collect();
        let mut times: Vec<f64> = scenes.iter().map(|scene| scene.wall_s).collect();
        let score = MethodScore {
            part: scenes[0].part,
            scene: configurations.word("scene", rows[0]).to_owned(),
            method: scenes[0].method.clone(),
            n_scenes: scenes.len(),
            n_right: scenes
                .iter()
                .filter(|scene| scene.outcome == "right")
                .count(),
            median_s: quantile(&mut times, 0.5),
        };
        (score, scenes)
    });
    let mut scored: Vec<_> = scored.collect();
    scored.sort_by(|(a, _), (b, _)| {
        let by_right = b.n_right.cmp(&a.n_right);
        by_right.then(a.median_s.total_cmp(&b.median_s))
    });
    scored
}

/// Maximum number of methods that a title lists.
const MAX_LISTED: usize = 3;

/// Returns the charts: for each part, the number of correct results against time and a map of the outcomes for each method, both in the scenes that all
/// methods of the part have computed; then charts of growing arrays.
pub(super) fn charts(tables: &[Table]) -> Vec<ChartSpec> {
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
pub(super) fn answers(plan: &StabilityPlan, charts: &[ChartSpec]) -> Vec<String> {
    let timed = charts.iter().filter(|chart| chart.table != SCENES.name());
    let missing = plan.peers.as_ref().filter(|path| !path.exists());
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
