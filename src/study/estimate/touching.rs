//! What it takes to make touches.

use crate::study::touch_set::TouchSet;
use crate::world::Patch;

/// Seconds to bring one sphere to the patch and decide whether it reaches the skin.
pub(in crate::study) const PLACE_SPHERE_S: f64 = 5e-9;
/// The same for one triangle of a mesh: most are never looked at.
pub(in crate::study) const PLACE_TRIANGLE_S: f64 = 2.5e-8;
/// What each frame after the first of a touch takes to be made, as a share of the first (measured).
const LATER_FRAME: f64 = 0.25;
/// Seconds to clear, count and store one taxel.
const CLEAR_TAXEL_S: f64 = 4.5e-9;

/// Processor-seconds to make all touches on an array, so many frames each.
pub(in crate::study) fn touch_s(
    patch: &Patch,
    touched: &dyn TouchSet,
    n_touches: usize,
    n_frames: usize,
) -> f64 {
    let clear_s = CLEAR_TAXEL_S * (n_touches * patch.grid.n_taxels()) as f64;
    let n_placed = 1.0 + LATER_FRAME * (n_frames as f64 - 1.0);
    n_placed * touched.place_s() + n_frames as f64 * clear_s
}
