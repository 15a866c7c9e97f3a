//! Charts of a stability study: methods in the same scenes, and computing time against the number of taxels.
//!
//! Methods are compared in the scenes that all methods of a part have computed, because shares of different scenes differ. A method that has computed less than
//! half of the scenes is not compared.

use crate::dynamics::skin_sim::UNSTABLE_JOINTS;
use crate::report::advice::Candidates;
use crate::report::swept::Setting;
use crate::studies::prelude::*;
use crate::studies::stability::plan::*;
use crate::studies::stability::rows::*;
use crate::table::{Along, At, Rule};

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

/// Columns that distinguish the methods of a part.
const METHOD: [&str; 2] = ["method", "solver_iterations"];

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
    let parts = configurations.groups(&["part"], 0..configurations.n_rows.min(timing.n_rows));
    let scenes = parts
        .iter()
        .map(|rows| common_scenes(configurations, timing, rows));
    let scenes: Vec<CommonScene> = scenes.flatten().collect();
    let is_same = |a: &CommonScene, b: &CommonScene| (a.part, &a.method) == (b.part, &b.method);
    let methods: Vec<MethodScore> = scenes.chunk_by(is_same).map(score).collect();
    for table in [SCENES.table(&scenes)?, METHODS.table(&methods)?] {
        tables.push(table.with((table.file, table.title), None));
    }
    Ok(tables)
}

/// Returns the outcomes of each method of a part in the scenes that all its methods have computed, method by method.
fn common_scenes(configurations: &Table, timing: &Table, rows: &[usize]) -> Vec<CommonScene> {
    let groups = |columns: &[&str]| configurations.groups(columns, rows.iter().copied());
    let mut by_method = groups(&METHOD);
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
    let varying = |columns: &[&str]| -> Vec<Setting> {
        let settings = columns
            .iter()
            .filter_map(|name| configurations.column(name));
        let settings = settings.map(|(column, data)| Setting { column, data });
        settings.filter(|one| one.varies(rows)).collect()
    };
    let [method, step, load] = [&METHOD[..], &SCENE[3..], &SCENE[..3]].map(varying);
    let scenes = by_method.iter().flat_map(|of_method| {
        let own = common
            .iter()
            .filter_map(|rows| rows.iter().find(|row| of_method.contains(row)));
        own.map(|&row| CommonScene {
            part: configurations.number("part", row) as usize,
            scene: configurations.word("scene", row).to_owned(),
            method: Setting::short_words(&method, row),
            step: Setting::short_words(&step, row),
            load: Setting::short_words(&load, row),
            outcome: configurations.word("outcome", row).to_owned(),
            wall_s: timing.number("wall_s", row),
        })
    });
    scenes.collect()
}

/// Returns the number of correct results and the median time of a method in its scenes.
fn score(scenes: &[CommonScene]) -> MethodScore {
    let mut times: Vec<f64> = scenes.iter().map(|scene| scene.wall_s).collect();
    let right = scenes.iter().filter(|scene| scene.outcome == "right");
    MethodScore {
        part: scenes[0].part,
        scene: scenes[0].scene.clone(),
        method: scenes[0].method.clone(),
        n_scenes: scenes.len(),
        n_right: right.count(),
        median_s: quantile(&mut times, 0.5),
    }
}

/// Charts of each part of the study in the scenes that all its methods have computed, followed by charts of growing arrays.
pub(super) const CHARTS: &[Chart] = &[
    Chart {
        table: METHODS.name(),
        name: "stability_{scene}_time",
        title: "Right of the same scenes, {scene}: {best} with {choice}",
        each: &["part"],
        x: "median_s",
        y: "n_right",
        lines: &["method"],
        ..Chart::FRONT
    },
    Chart {
        table: SCENES.name(),
        name: "stability_{scene}",
        title: "What is right and what breaks, {scene}",
        each: &["part"],
        x: "step",
        y: "load",
        panels: Some("method"),
        mark: Mark::Tiles { fill: "outcome" },
        ..Chart::LINES
    },
    Chart {
        table: JOINTS.name(),
        name: "stability_joints",
        title: "Time of a simulated second by {x}, {dt_s}",
        note: "Each taxel carries {load_kg}. {note}",
        each: &["dt_s"],
        x: "joints",
        y: "time_s",
        lines: &["method", "solver_iterations"],
        panels: Some("taxel_mass_kg"),
        right: Some(("outcome", "right")),
        rules: &[
            Rule::constant(
                Along::X,
                At::Value(UNSTABLE_JOINTS as f64),
                "SkinSim's authors: unstable near 280 joints",
            ),
            Rule::constant(Along::Y, At::Value(1.0), "real time"),
        ],
        ..Chart::LINES
    },
];

/// Returns the constant charts. Charts of parts with another program name its version.
pub(super) fn charts(tables: &[Table]) -> Vec<ChartSpec> {
    let mut charts: Vec<ChartSpec> = CHARTS.iter().flat_map(|one| one.specs(tables)).collect();
    let Some(methods) = tables.iter().find(|table| table.file == METHODS.name()) else {
        return charts;
    };
    for chart in &mut charts {
        let mut shown = methods.rows_shown(&chart.shown).into_iter();
        if shown.any(|row| methods.word("method", row).starts_with("MuJoCo")) {
            chart.note += &format!(" {}", tables[0].note);
        }
    }
    charts
}

/// Returns the answers: the best method of each part. A last sentence names the table of other programs if it does not exist.
pub(super) fn answers(plan: &StabilityPlan, tables: &[Table]) -> Vec<String> {
    let missing = plan.peers.as_ref().filter(|path| !path.exists());
    let missing = missing.map(|path| {
        format!(
            "No rows of other programs: {} does not exist.",
            path.display()
        )
    });
    let methods = tables.iter().find(|table| table.file == METHODS.name());
    let best = methods.and_then(|table| Candidates::of_columns(table, "n_right", "median_s"));
    let best = best.map_or_else(Vec::new, |best| best.sentences());
    best.into_iter().chain(missing).collect()
}
