//! Sample pictures of human touches as film strips.

use crate::contact::Workspace;
use crate::error::{Error, Result};
use crate::inputs::units::millimetres;
use crate::report::pictures::snapshots::Snapshots;
use crate::signal::Quantity;
use crate::studies::recognition::frames::human_touches::{HumanTouches, record_touch};
use crate::studies::recognition::frames::samples::named_samples;
use crate::studies::recognition::frames::touch_set::{Samples, TouchSet};
use crate::studies::recognition::plan::study_plan::Plan;
use crate::studies::recognition::plan::taxel_array::TaxelArray;
use ndarray::Array2;
use rayon::prelude::*;

/// Number of frames in a film strip; a film strip is one row of the picture.
const N_FRAMES: usize = 4;

/// Number of touches of each kind that are compared; the picture shows the touch with the largest force. If only one touch were considered, a flat hand could
/// be represented by a touch of one fingertip.
const N_LOOKED_AT: usize = 10;

/// Returns film strips of the kinds of touch that the study lists for its picture; of all kinds if it lists none. Each strip shows the strongest of the first
/// touches of its kind at four times, evenly spaced between its first and its last contact. The study's finest array is used, without noise.
///
/// # Errors
/// If the study has no configurations, lists an unknown kind of touch, or has an invalid skin.
pub fn human_samples(plan: &Plan, touches: &HumanTouches) -> Result<Samples> {
    let n_taxels = |array: &&TaxelArray| array.n_taxels();
    // In a tie, the first array.
    let array = plan.arrays.iter().rev().max_by_key(n_taxels);
    let no_cells = || Error::input("study", "no configurations", "at least one value an axis");
    let array = array.ok_or_else(no_cells)?;
    let grid = array.grid();
    let skin = touches.spec.skin(array)?;
    let interval = touches.spec.interval();
    let mut frames = Vec::new();
    let chosen = named_samples(plan, &touches.class_names())?;
    for label in chosen.unwrap_or_else(|| (0..touches.spec.kinds.len()).collect()) {
        let first = touches.with_label(label).par_iter().take(N_LOOKED_AT);
        let recorded = first.map_init(Workspace::new, |room, touch| {
            let mut rows = Array2::zeros((touches.spec.n_frames(), grid.n_taxels()));
            record_touch(&skin, touch, interval, rows.view_mut(), room);
            rows
        });
        let recorded = recorded.collect::<Vec<_>>().into_iter();
        let firmest = recorded.max_by(|a, b| a.sum().total_cmp(&b.sum()));
        let Some(rows) = firmest else { continue };
        let is_touched = |frame: &usize| rows.row(*frame).iter().any(|&d| d > 0.0);
        let touched: Vec<usize> = (0..rows.nrows()).filter(is_touched).collect();
        let (Some(&first), Some(&last)) = (touched.first(), touched.last()) else {
            continue;
        };
        for part in 0..N_FRAMES {
            let frame = first + (part * (last - first) + N_FRAMES / 2) / (N_FRAMES - 1);
            let seconds = (frame - first) as f64 * interval;
            let name = format!("{} {seconds:.2} s", touches.spec.kinds[label].name());
            let row = rows.row(frame).mapv(f64::from);
            let frame = row.into_shape_with_order((grid.ny, grid.nx));
            let frame = frame.expect("one value a taxel");
            frames.push((name, frame));
        }
    }
    let pitch_mm = millimetres(grid.pitch);
    let shown = Snapshots {
        frames,
        pitch_mm,
        quantity: Quantity::Deflection,
        caption: format!(
            "One touch of each kind by a hand on {} × {} taxels at {pitch_mm} mm around a forearm (x around it, y along it), no noise",
            grid.nx, grid.ny
        ),
    };
    Ok(Samples { shown, each: None })
}
