//! The folder of a study of stability, and what it prints at its end.

use super::stability_joints::draw_joints;
use super::stability_map::{draw_stability_maps, method_name};
use crate::error::Result;
use crate::report::folder::Folder;
use crate::report::page::StudyAbout;
use crate::report::page::plain::{self, plain_page};
use crate::report::study_tables::{StudyTables, TableFiles, table_file};
use crate::report::terminal::{align_right, plain_table, wrap};
use crate::study::stability::table::StabilityTables;
use crate::study::stability::{StabilityScene, TOLERANCE};
use comfy_table::Table;
use std::path::Path;

const FILES: [&str; 3] = ["stability.csv", "stability_summary.csv", "timing.csv"];

impl StudyTables for StabilityTables {
    const OF_PIECES: &'static [&'static str] = &["stability.csv"];
    const OF_ALL: &'static [&'static str] = &["stability_summary.csv"];

    fn files(&self) -> Result<TableFiles> {
        Ok(vec![
            table_file(FILES[0], &self.stability)?,
            table_file(FILES[1], &self.summary)?,
            table_file(FILES[2], &self.timing)?,
        ])
    }
}

/// Tables, maps and the page, tables first, for the folder `dir`: nothing is written yet.
///
/// # Errors
/// What cannot be drawn, or written as a table.
pub fn stability_folder<'a>(
    dir: &'a Path,
    tables: &StabilityTables,
    about: &StudyAbout,
) -> Result<Folder<'a>> {
    let mut folder = Folder::new(dir);
    folder.add_files(tables.files()?);
    let mut maps = draw_stability_maps(tables);
    maps.extend(draw_joints(tables));
    for (name, title, drawing) in &maps {
        folder.add_chart(name, title, drawing);
    }
    let found = vec![
        plain::answer(&sentences(tables)),
        plain::table(
            "methods",
            "Scenes and methods",
            &note(),
            &summary_table(tables, 200),
        ),
        plain::charts(&maps),
    ];
    folder.add("report.html", plain_page(about, found, &FILES));
    Ok(folder)
}

/// How often each method is right, the best first.
fn sentences(tables: &StabilityTables) -> Vec<String> {
    let mut methods: Vec<(String, usize, usize)> = Vec::new();
    for row in &tables.summary {
        let name = method_name(row.method, row.solver_iterations);
        let known = methods.iter().position(|(known, ..)| *known == name);
        let place = known.unwrap_or(methods.len());
        if known.is_none() {
            methods.push((name, 0, 0));
        }
        methods[place].1 += row.n_right;
        methods[place].2 += row.n_cells;
    }
    let share = |n_right: usize, n_cells: usize| n_right as f64 / n_cells.max(1) as f64;
    methods.sort_by(|a, b| share(b.1, b.2).total_cmp(&share(a.1, a.2)));
    let sentence = |(name, n_right, n_cells): &(String, usize, usize)| {
        let percent = 100.0 * share(*n_right, *n_cells);
        format!("Right in {n_right} of {n_cells} cells ({percent:.0} %): {name}.")
    };
    methods.iter().map(sentence).collect()
}

/// A line a scene and method. Lines are at most about `width` letters long.
pub fn stability_summary(tables: &StabilityTables, width: usize) -> String {
    let (note, table) = (note(), summary_table(tables, width));
    format!("{}\n\n{table}\n", wrap(&note, width).join("\n"))
}

fn note() -> String {
    let percent = 100.0 * TOLERANCE;
    format!(
        "right: force balance and deflections within {percent} %; missed: contact was missed; energy: more of it than there can be; \
         imbalance, deflection: the worst errors of what came to an end, as shares"
    )
}

fn summary_table(tables: &StabilityTables, width: usize) -> Table {
    let mut table = plain_table(width);
    table.set_header([
        "scene",
        "method",
        "cells",
        "right",
        "inaccurate",
        "missed",
        "energy",
        "not finite",
        "imbalance",
        "deflection",
    ]);
    for row in &tables.summary {
        let worst =
            |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.1e}"));
        table.add_row([
            scene_name(row.scene).to_owned(),
            method_name(row.method, row.solver_iterations),
            row.n_cells.to_string(),
            row.n_right.to_string(),
            row.n_inaccurate.to_string(),
            row.n_missed_contact.to_string(),
            row.n_energy_growth.to_string(),
            row.n_not_finite.to_string(),
            worst(row.worst_force_imbalance),
            worst(row.worst_deflection_error),
        ]);
    }
    align_right(&mut table, 2..10);
    table
}

fn scene_name(scene: StabilityScene) -> &'static str {
    match scene {
        StabilityScene::Rest => "rest",
        StabilityScene::Press => "press",
        StabilityScene::Plunger => "plunger",
    }
}
