//! What came of a scene, as tables for people.

use super::axis::short_number;
use crate::scene::{Held, Movement, ScenePlan, Summary};
use crate::world::Motion;
use comfy_table::{CellAlignment, Table, presets::NOTHING};

/// One table of patches with their peaks over all frames, one of objects with what holds them at the end.
pub fn scene_table(plan: &ScenePlan, summary: &Summary) -> String {
    let mut text = format!("{}\n", patches(plan, summary));
    if !plan.objects.is_empty() {
        text += &format!("\n{}\n", objects(plan, summary));
    }
    text
}

fn patches(plan: &ScenePlan, summary: &Summary) -> Table {
    let mut table = table([
        "patch",
        "taxels",
        "deepest (mm)",
        "most force (N)",
        "most touched",
        "saturated",
        "grazing",
    ]);
    for (patch, peaks) in plan.patches.iter().zip(&summary.patches) {
        table.add_row([
            patch.skin.name().to_owned(),
            patch.skin.n_taxels().to_string(),
            short_number(1e3 * peaks.deflection),
            short_number(peaks.force),
            peaks.n_touched.to_string(),
            peaks.n_saturated.to_string(),
            peaks.n_grazing.to_string(),
        ]);
    }
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

fn objects(plan: &ScenePlan, summary: &Summary) -> Table {
    let mut table = table(["object", "parts", "at the end"]);
    let all = plan.objects.iter().zip(&plan.models);
    let ends = summary.objects.iter().zip(&summary.n_unsettled);
    for ((object, model), (held, n_unsettled)) in all.zip(ends) {
        let parts = match model.spheres() {
            Some(union) if union.n_spheres() == 1 => "1 sphere".to_owned(),
            Some(union) => format!("{} spheres", union.n_spheres()),
            None => format!("{} triangles", model.n_triangles()),
        };
        let mut end = ending(&object.movement, held);
        if *n_unsettled > 0 {
            end += &format!("; not at rest in {n_unsettled} frames");
        }
        table.add_row([object.name.clone(), parts, end]);
    }
    table
}

/// What holds an object, in words.
fn ending(movement: &Movement, held: &Held) -> String {
    match held {
        Held::Imposed => match movement {
            Movement::Imposed(Motion::Fixed(_)) => "fixed".to_owned(),
            _ => "where its motion says".to_owned(),
        },
        Held::AtRest => "at rest".to_owned(),
        Held::Unsettled => "not at rest".to_owned(),
        Held::Escaped { time, direction } => {
            let [x, y, z] = direction.to_array().map(|number| format!("{number:.2}"));
            format!(
                "escaped at {} s towards ({x}, {y}, {z})",
                short_number(*time)
            )
        }
    }
}

fn table<const N: usize>(header: [&str; N]) -> Table {
    let mut table = Table::new();
    table.load_preset(NOTHING);
    table.set_header(header);
    table
}
