//! Presses spheres on a patch of rows: bundles of columns, then rows.
//!
//! In doubles, though roots of singles would be 4.6 times as fast: a single's last digit in S² is worth more the larger the sphere.
//! Of 32 spheres that touch all of 64 × 64 taxels singles were wrong by 5e-9 m (radius 45 mm, pressed lightly), 2e-7 m (as deep as
//! its middle) and 6e-7 m (radius 4 m); of 512 × 512 by up to 5e-5 m. `cargo bench --bench precision` measures it again.

use super::lanes::{LANES, View, largest};
use super::object_press::Pushed;
use super::patch_state::PatchState;
use super::row_patch::{Bundle, RowPatch};
use crate::contact::{beats, raise};
use crate::geometry::Pose;
use glam::{DMat3, DVec3};

/// Under so few bundles a sphere is small: to know whether it needs more takes as long as the root.
const FEW: usize = 3;

impl Pushed for RowPatch {
    #[inline(always)]
    fn view(&self, patch_from_object: &Pose) -> View {
        let uvw = self.extrusion().uvw_from_patch();
        View::new(
            uvw * DMat3::from_quat(patch_from_object.rotation),
            uvw * patch_from_object.translation,
            self.taxel().radius,
            self.ball_in_uvw(),
        )
    }

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
        let behind = self.behind();
        let mut under = std::mem::take(&mut state.under);
        under.clear();
        let mut widest = 0.0;
        for (look, circles) in self.circles().iter().enumerate() {
            for k in circles.near(center.with_z(0.0), reach) {
                let bundle = look * LANES + k;
                let (share, spare) = Share::of(&self.bundles()[bundle], center, reach, behind);
                if spare > 0.0 {
                    widest = if spare > widest { spare } else { widest };
                    under.push(((bundle * LANES) as u32, share));
                }
            }
        }
        if !under.is_empty() {
            push_rows(state, self, &under, center.z, widest.sqrt());
        }
        state.under = under;
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
            share.push(along * along, is_small, patch.behind(), taxels);
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
    /// Whether the sphere's middle is behind a substrate.
    is_behind: bool,
}

impl Share {
    /// Also how far along the rows it pushes any, squared, m²; zero or less if it pushes none.
    #[inline(always)]
    fn of(bundle: &Bundle, center: DVec3, reach: f64, behind: f64) -> (Self, f64) {
        let (mut squares, mut heights, mut spares) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        let mut n_behind = 0;
        for k in 0..LANES {
            let (du, dv) = (center.x - bundle.u[k], center.y - bundle.v[k]);
            let beside = du * bundle.axis_v[k] - dv * bundle.axis_u[k];
            let height = du * bundle.axis_u[k] + dv * bundle.axis_v[k];
            let square = reach * reach - beside * beside;
            // Above the skin, or behind the substrate; one of them is zero.
            let (above, gap) = (height.max(0.0), (behind - height).max(0.0));
            squares[k] = square;
            heights[k] = height;
            n_behind += u32::from(height < behind);
            spares[k] = square - above * above - gap * gap;
        }
        let share = Self {
            squares,
            heights,
            is_behind: n_behind > 0,
        };
        (share, largest(&spares))
    }

    /// Raises taxels of a row that is so far away along the rows, squared, m²; their substrates are at height `behind`.
    #[inline(always)]
    fn push(&self, along2: f64, is_small: bool, behind: f64, taxels: &mut [f64; LANES]) {
        let mut squares = self.squares;
        for square in &mut squares {
            *square -= along2;
        }
        if self.is_behind {
            self.push_through(squares, behind, taxels);
            return;
        }
        if is_small || beats(&squares, &self.heights, taxels) {
            raise(&squares, &self.heights, taxels);
        }
    }

    /// The same where the sphere's middle is behind a substrate, by itself: what is rare is not to slow down what is not.
    #[cold]
    #[inline(never)]
    fn push_through(&self, mut squares: [f64; LANES], behind: f64, taxels: &mut [f64; LANES]) {
        for (square, height) in squares.iter_mut().zip(&self.heights) {
            let gap = (behind - height).max(0.0);
            *square = if *square <= gap * gap { -1.0 } else { *square };
        }
        raise(&squares, &self.heights, taxels);
    }
}
