//! Presses of spheres on a patch of rows: first bundles of columns are selected, then rows.
//!
//! Deflections are computed in f64, although f32 roots would be 4.6 times as fast: the rounding of S² in f32 grows with the sphere. For 32 spheres of radius 45
//! mm that touch all of 64 × 64 taxels, the f32 error is 5e-9 m in a light press. Pressed to the sphere's centre, the error is 2e-7 m. The f32 error is 6e-7 m
//! for a radius of 4 m, and up to 5e-5 m for 512 × 512 taxels. `cargo bench --bench precision` repeats the measurement.

use super::lanes::LANES;
use super::object_press::Pushed;
use super::patch_state::PatchState;
use super::row_patch::{RowPatch, SphereOverBundle};
use crate::contact::lanes::SelectedLanes;
use crate::contact::law::{beats, indent};
use crate::contact::object_at::PlacedSphere;
use glam::DVec3;

/// Maximum number of bundles of columns for which a sphere counts as small. For a small sphere, testing whether contact requires more than the present
/// deflection takes as long as the root.
const FEW: usize = 3;

impl Pushed for RowPatch {
    #[inline(always)]
    fn is_near(&self, ball: &PlacedSphere) -> bool {
        let PlacedSphere { center, reach } = *ball;
        let mut is_near = false;
        for circles in &self.circles {
            is_near |= !circles.near(&across_rows(center, reach)).is_empty();
        }
        is_near && !is_beside(self, center.z, reach)
    }

    #[inline(always)]
    fn push(&self, state: &mut PatchState, sphere: &PlacedSphere) {
        let PlacedSphere { center, reach } = *sphere;
        if is_beside(self, center.z, reach) {
            return;
        }
        let mut under = std::mem::take(&mut state.under);
        under.clear();
        let (mut widest, mut lowest) = (0.0, [f64::INFINITY; LANES]);
        for (look, circles) in self.circles.iter().enumerate() {
            for k in circles.near(&across_rows(center, reach)) {
                let bundle = look * LANES + k;
                let (share, spare) = SphereOverBundle::new(&self.bundles[bundle], center, reach);
                if spare > 0.0 {
                    widest = if spare > widest { spare } else { widest };
                    lower(&mut lowest, &share.heights);
                    under.push(((bundle * LANES) as u32, share));
                }
            }
        }
        if !SelectedLanes::below(&lowest, self.behind).is_empty() {
            push_through(state, self, &under, center.z, widest.sqrt());
        } else if !under.is_empty() {
            push_rows(state, self, &under, center.z, widest.sqrt());
        }
        state.under = under;
    }
}

/// Returns the circle of a sphere in the plane perpendicular to the rows, as a sphere with its centre at w = 0.
#[inline(always)]
fn across_rows(center: DVec3, reach: f64) -> PlacedSphere {
    PlacedSphere {
        center: center.with_z(0.0),
        reach,
    }
}

/// Replaces each value of `lowest` by the value in `heights` if the latter is smaller.
#[inline(always)]
fn lower(lowest: &mut [f64; LANES], heights: &[f64; LANES]) {
    for k in 0..LANES {
        lowest[k] = if heights[k] < lowest[k] {
            heights[k]
        } else {
            lowest[k]
        };
    }
}

/// Returns whether no row is within the distance `reach` of the position `w` along the rows, metres.
#[inline(always)]
fn is_beside(patch: &RowPatch, w: f64, reach: f64) -> bool {
    let rows = &patch.lines.positions;
    w + reach <= rows[0] || w - reach >= rows[rows.len() - 1]
}

/// Raises the deflections of the rows within a distance of the position `w`, metres, in the bundles of columns given by their first columns.
#[inline(always)]
fn push_rows(
    state: &mut PatchState,
    patch: &RowPatch,
    under: &[(u32, SphereOverBundle)],
    w: f64,
    within: f64,
) {
    let n_columns = patch.extrusion.places().len();
    let (first, last) = (under[0].0, under[under.len() - 1].0);
    let columns = first..(last + LANES as u32).min(n_columns as u32);
    let is_small = under.len() <= FEW;
    for row in patch.lines.within(w, within) {
        state.widen(row, &columns);
        let along = patch.lines.positions[row] - w;
        for (start, share) in under {
            let taxels = state.block(row * n_columns + *start as usize);
            share.push(along * along, is_small, taxels);
        }
    }
}

/// Raises the deflections of the rows by a sphere whose centre is behind the substrate of a taxel.
#[inline(always)]
fn push_through(
    state: &mut PatchState,
    patch: &RowPatch,
    under: &[(u32, SphereOverBundle)],
    w: f64,
    within: f64,
) {
    let n_columns = patch.extrusion.places().len();
    let behind = patch.behind;
    for row in patch.lines.within(w, within) {
        let along = patch.lines.positions[row] - w;
        for (start, share) in under {
            let squares = share.through(along * along, behind);
            let taxels = state.block(row * n_columns + *start as usize);
            if beats(&squares, &share.heights, taxels) {
                indent(&squares, &share.heights, taxels);
                let columns = *start..(start + LANES as u32).min(n_columns as u32);
                state.widen(row, &columns);
            }
        }
    }
}
