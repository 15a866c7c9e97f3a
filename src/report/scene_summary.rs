//! Summary of a scene as text tables.

use crate::geometry::rpy_from_rotation;
use crate::report::terminal::rows_text;
use crate::scene::{Carrier, Movement, PoseControl, ScenePlan, Summary};
use crate::table::short_number;
use crate::world::Motion;
use glam::DVec3;

/// Returns the summary of a scene as text: a table of patches with their largest values, and a table of objects with their final states.
pub fn scene_table(plan: &ScenePlan, summary: &Summary) -> String {
    let mut text = format!("{}\n", patches(plan, summary));
    for patch in &plan.patches {
        let n_left_out = patch.skin.layout().n_left_out();
        if n_left_out > 0 {
            let name = patch.skin.name();
            text += &format!(
                "Patch {name}: {n_left_out} taxels left out, whose axes would meet the mesh again.\n"
            );
        }
    }
    if !plan.objects.is_empty() {
        text += &format!("\n{}\n", objects(plan, summary));
    }
    text
}

fn patches(plan: &ScenePlan, summary: &Summary) -> String {
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
    let patches = plan.patches.iter().zip(&summary.patches);
    let rows = patches.map(|(patch, peaks)| {
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
        row
    });
    rows_text(&header, &[0], rows)
}

fn objects(plan: &ScenePlan, summary: &Summary) -> String {
    let all = plan.objects.iter().zip(&plan.models);
    let rows = all.zip(&summary.objects).map(|((object, model), summary)| {
        let parts = match model.spheres() {
            Some(union) if union.n_spheres() == 1 => "1 sphere".to_owned(),
            Some(union) => format!("{} spheres", union.n_spheres()),
            None => format!("{} triangles", model.n_triangles()),
        };
        let mut end = ending(&object.movement, &summary.held);
        if matches!(object.movement, Movement::Free { .. }) {
            let position = triple(1e3 * summary.pose.translation);
            let angles = triple(rpy_from_rotation(summary.pose.rotation).map(f64::to_degrees));
            end += &format!("; last at {position} mm, rotated by {angles}°");
        }
        if summary.n_unsettled > 0 {
            end += &format!("; not at rest in {} frames", summary.n_unsettled);
        }
        if summary.imbalance > 0.0 {
            let share = short_number(summary.imbalance);
            end += &format!("; at most {share} of its weight not balanced");
        }
        if summary.n_off > 0 {
            end += &format!("; not with the force wanted in {} frames", summary.n_off);
        }
        vec![object.name.clone(), parts, end]
    });
    rows_text(&["object", "parts", "at the end"], &[0, 1, 2], rows)
}

/// Returns the final state of an object as text.
fn ending(movement: &Movement, held: &PoseControl) -> String {
    match held {
        PoseControl::Imposed => match movement {
            Movement::Imposed {
                carrier: Carrier::Link { .. },
                ..
            } => "where its robot carries it".to_owned(),
            Movement::Imposed {
                motion: Motion::Fixed(_),
                ..
            } => "fixed".to_owned(),
            _ => "where its motion says".to_owned(),
        },
        PoseControl::Pressed {
            travel,
            force,
            wanted,
        } => format!(
            "pressed {} mm, with {} of {} N",
            short_number(1e3 * travel),
            short_number(*force),
            short_number(*wanted)
        ),
        PoseControl::AtRest => "at rest".to_owned(),
        PoseControl::NotConverged => "not at rest".to_owned(),
        PoseControl::Escaped { time, direction } => {
            let towards = triple(*direction);
            format!("escaped at {} s towards {towards}", short_number(*time))
        }
    }
}

/// Returns three numbers as text, such as `(1.00, 0.00, -2.50)`.
fn triple(numbers: DVec3) -> String {
    // Adding 0 makes a negative zero positive.
    let [x, y, z] = numbers
        .to_array()
        .map(|number| format!("{:.2}", (1e2 * number).round() / 1e2 + 0.0));
    format!("({x}, {y}, {z})")
}
