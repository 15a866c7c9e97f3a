//! The folder of a study of stability, and what it prints at its end.

use super::stability_map::{draw_stability_maps, method_name};
use crate::error::Result;
use crate::report::folder::Folder;
use crate::report::terminal::{align_right, plain_table};
use crate::study::stability::table::StabilityTables;
use crate::study::stability::{StabilityScene, TOLERANCE};
use std::path::{Path, PathBuf};

/// Writes tables and maps into `dir` (created if missing); returns the paths, tables first.
///
/// Everything is drawn before the first file is written, and each file is whole or not there.
pub fn write_stability(dir: &Path, tables: &StabilityTables) -> Result<Vec<PathBuf>> {
    let mut folder = Folder::new(dir);
    folder.add_table("stability.csv", &tables.stability)?;
    folder.add_table("stability_summary.csv", &tables.summary)?;
    folder.add_table("timing.csv", &tables.timing)?;
    for (name, title, drawing) in draw_stability_maps(tables) {
        folder.add_chart(&name, &title, &drawing)?;
    }
    folder.write()
}

/// A line a scene and method. Lines are at most about `width` letters long.
pub fn stability_summary(tables: &StabilityTables, width: usize) -> String {
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
    format!(
        "right: force balance and deflections within {} %; missed: contact was missed; energy: more of it than there can be;\n\
         imbalance, deflection: the worst errors of what came to an end, as shares\n\n{table}\n",
        100.0 * TOLERANCE
    )
}

fn scene_name(scene: StabilityScene) -> &'static str {
    match scene {
        StabilityScene::Rest => "rest",
        StabilityScene::Press => "press",
        StabilityScene::Plunger => "plunger",
    }
}
