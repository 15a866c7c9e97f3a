//! Presses spheres on a patch of rows: bundles of columns, then rows.
//!
//! In doubles, though roots of singles would be 4.6 times as fast: a single's last digit in S² is worth more the larger the sphere.
//! Of 32 spheres that touch all of 64 × 64 taxels singles were wrong by 5e-9 m (radius 45 mm, pressed lightly), 2e-7 m (as deep as
//! its middle) and 6e-7 m (radius 4 m); of 512 × 512 by up to 5e-5 m. `cargo bench --bench precision` measures it again.

use super::lanes::{LANES, largest};
use super::object_press::Pushed;
use super::patch_state::PatchState;
use super::row_patch::{Bundle, RowPatch};
use crate::contact::Below;
use crate::contact::law::{beats, raise, squares_in_front};
use glam::DVec3;

/// Under so few bundles a sphere is small: to know whether it needs more takes as long as the root.
const FEW: usize = 3;

impl Pushed for RowPatch {
    #[inline(always)]
    fn is_near(&self, center: DVec3, reach: f64) -> bool {
        let mut is_near = false;
        for circles in self.circles() {
            is_near |= !circles.near(center.with_z(0.0), reach).is_empty();
        }
        is_near && !is_beside(self, center.z, reach)
    }

    #[inline(always)]
    fn push(&self, state: &mut PatchState, center: DVec3, reach: f64) {
        if is_beside(self, center.z, reach) {
            return;
        }
        let mut under = std::mem::take(&mut state.under);
        under.clear();
        let (mut widest, mut lowest) = (0.0, [f64::INFINITY; LANES]);
        for (look, circles) in self.circles().iter().enumerate() {
            for k in circles.near(center.with_z(0.0), reach) {
                let bundle = look * LANES + k;
                let (share, spare) = Share::of(&self.bundles()[bundle], center, reach);
                if spare > 0.0 {
                    widest = if spare > widest { spare } else { widest };
                    lower(&mut lowest, &share.heights);
                    under.push(((bundle * LANES) as u32, share));
                }
            }
        }
        if !Below::of(&lowest, self.behind()).is_empty() {
            push_through(state, self, &under, center.z, widest.sqrt());
        } else if !under.is_empty() {
            push_rows(state, self, &under, center.z, widest.sqrt());
        }
        state.under = under;
    }
}

/// The lower ones of some heights.
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

/// Whether nothing within reach of a place along the rows is a row.
#[inline(always)]
fn is_beside(patch: &RowPatch, w: f64, reach: f64) -> bool {
    let rows = &patch.lines().positions;
    w + reach <= rows[0] || w - reach >= rows[rows.len() - 1]
}

/// Pushes the rows within a distance of w, metres, of some bundles, which are known by their first columns.
#[inline(always)]
fn push_rows(
    state: &mut PatchState,
    patch: &RowPatch,
    under: &[(u32, Share)],
    w: f64,
    within: f64,
) {
    let n_columns = patch.extrusion().places().len();
    let (first, last) = (under[0].0, under[under.len() - 1].0);
    let columns = first..(last + LANES as u32).min(n_columns as u32);
    let is_small = under.len() <= FEW;
    for row in patch.lines().within(w, within) {
        state.widen(row, &columns);
        let along = patch.lines().positions[row] - w;
        for (start, share) in under {
            let taxels = state.block(row * n_columns + *start as usize);
            share.push(along * along, is_small, taxels);
        }
    }
}

/// The same of a sphere whose middle is behind a substrate.
#[inline(always)]
fn push_through(
    state: &mut PatchState,
    patch: &RowPatch,
    under: &[(u32, Share)],
    w: f64,
    within: f64,
) {
    let n_columns = patch.extrusion().places().len();
    let behind = patch.behind();
    for row in patch.lines().within(w, within) {
        let along = patch.lines().positions[row] - w;
        for (start, share) in under {
            let squares = share.through(along * along, behind);
            let taxels = state.block(row * n_columns + *start as usize);
            if beats(&squares, &share.heights, taxels) {
                raise(&squares, &share.heights, taxels);
                let columns = *start..(start + LANES as u32).min(n_columns as u32);
                state.widen(row, &columns);
            }
        }
    }
}

/// What a sphere is to the columns of a bundle, the same in all rows.
#[derive(Clone, Debug)]
pub(super) struct Share {
    /// S² − b², m².
    squares: [f64; LANES],
    /// h, metres.
    heights: [f64; LANES],
}

impl Share {
    /// Also how far along the rows it pushes any from the front, squared, m²; zero or less if it pushes none.
    #[inline(always)]
    fn of(bundle: &Bundle, center: DVec3, reach: f64) -> (Self, f64) {
        let (mut squares, mut heights, mut spares) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for k in 0..LANES {
            let (du, dv) = (center.x - bundle.u[k], center.y - bundle.v[k]);
            let beside = du * bundle.axis_v[k] - dv * bundle.axis_u[k];
            let height = du * bundle.axis_u[k] + dv * bundle.axis_v[k];
            let square = reach * reach - beside * beside;
            let above = height.max(0.0);
            squares[k] = square;
            heights[k] = height;
            spares[k] = square - above * above;
        }
        (Self { squares, heights }, largest(&spares))
    }

    /// Raises taxels of a row that is so far away along the rows, squared, m².
    #[inline(always)]
    fn push(&self, along2: f64, is_small: bool, taxels: &mut [f64; LANES]) {
        let mut squares = self.squares;
        for square in &mut squares {
            *square -= along2;
        }
        if is_small || beats(&squares, &self.heights, taxels) {
            raise(&squares, &self.heights, taxels);
        }
    }

    /// What is left of the squares so far away, m², with substrates at the height `behind`: nothing where the sphere does not reach through one.
    #[inline(always)]
    fn through(&self, along2: f64, behind: f64) -> [f64; LANES] {
        let mut squares = self.squares;
        for square in &mut squares {
            *square -= along2;
        }
        squares_in_front(&squares, &self.heights, behind)
    }
}
