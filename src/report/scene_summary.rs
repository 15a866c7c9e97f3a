//! What came of a scene, as tables for people.

use crate::scene::{Held, Movement, ScenePlan, Summary};
use crate::table::short_number;
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
    let mut header = vec![
        "patch",
        "taxels",
        "deepest (mm)",
        "most force (N)",
        "most touched",
        "saturated",
        "grazing",
    ];
    if plan.patches.iter().any(|patch| patch.shears.is_some()) {
        header.extend(["most friction (N)", "most sticking", "most slipping"]);
    }
    let mut table = table(&header, &[0]);
    for (patch, peaks) in plan.patches.iter().zip(&summary.patches) {
        let mut row = vec![
            patch.skin.name().to_owned(),
            patch.skin.n_taxels().to_string(),
            short_number(1e3 * peaks.deflection),
            short_number(peaks.force),
            peaks.n_touched.to_string(),
            peaks.n_saturated.to_string(),
            peaks.n_grazing.to_string(),
        ];
        if patch.shears.is_some() {
            row.push(short_number(peaks.shear));
            row.push(peaks.n_sticking.to_string());
            row.push(peaks.n_slipping.to_string());
        }
        table.add_row(row);
    }
    table
}

fn objects(plan: &ScenePlan, summary: &Summary) -> Table {
    let mut table = table(&["object", "parts", "at the end"], &[0, 1, 2]);
    let all = plan.objects.iter().zip(&plan.models);
    let counts = summary.n_unsettled.iter().zip(&summary.n_off);
    let ends = summary.objects.iter().zip(counts);
    for ((object, model), (held, (n_unsettled, n_off))) in all.zip(ends) {
        let parts = match model.spheres() {
            Some(union) if union.n_spheres() == 1 => "1 sphere".to_owned(),
            Some(union) => format!("{} spheres", union.n_spheres()),
            None => format!("{} triangles", model.n_triangles()),
        };
        let mut end = ending(&object.movement, held);
        if *n_unsettled > 0 {
            end += &format!("; not at rest in {n_unsettled} frames");
        }
        if *n_off > 0 {
            end += &format!("; not with the force wanted in {n_off} frames");
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
        Held::Pressed {
            travel,
            force,
            wanted,
        } => format!(
            "pressed {} mm, with {} of {} N",
            short_number(1e3 * travel),
            short_number(*force),
            short_number(*wanted)
        ),
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

/// A table without lines; numbers, which is all but the columns of texts, end at the right.
pub(super) fn table(header: &[&str], texts: &[usize]) -> Table {
    let mut table = Table::new();
    table.load_preset(NOTHING).set_header(header);
    for (number, column) in table.column_iter_mut().enumerate() {
        if !texts.contains(&number) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table
}
