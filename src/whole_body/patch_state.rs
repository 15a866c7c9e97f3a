//! One patch from step to step: which of its taxels are deflected, and how far.

use super::SphereClusters;
use super::body_patch::{BodyPatch, Surface};
use super::row_patch::RowPatch;
use crate::contact::{Relaxation, relaxation_factor, saturation_limit};
use crate::geometry::Pose;
use crate::objects::Sphere;
use glam::{DMat3, DVec3, Vec3Swizzles};
use multiversion::multiversion;
use std::ops::Range;

/// What relaxes and is deflected by less is at rest, metres; a ten-thousandth of what the finest skins tell apart.
pub const AT_REST: f64 = 1e-9;

/// A patch in memory: 8 bytes a taxel, and as much again for those that are deflected.
#[derive(Clone, Debug, Default)]
pub(super) struct PatchState {
    /// n_taxels, metres.
    deflections: Vec<f64>,
    /// Of each row the columns beside which all are at rest; empty where the row is.
    spans: Vec<Range<u32>>,
    /// The rows that are not at rest.
    active: Vec<u32>,
    /// The deflected taxels by number, and by how much, metres.
    touched: Vec<(u32, f64)>,
    /// The same before the last step; of damped taxels only, whose force depends on it.
    before: Vec<(u32, f64)>,
    n_saturated: usize,
    scratch: Scratch,
}

/// What a sphere is to each column of a run, the same in all rows.
#[derive(Clone, Debug, Default)]
struct Scratch {
    /// S² − b², m²; negative behind the substrate.
    shares: Vec<f64>,
    /// h, metres.
    heights: Vec<f64>,
}

impl PatchState {
    pub fn at_rest(patch: &BodyPatch) -> Self {
        let n_columns = match patch.surface() {
            Surface::Rows(rows) => rows.extrusion().places().len(),
            Surface::Dome(_) => 0,
        };
        Self {
            deflections: vec![0.0; patch.n_taxels()],
            spans: vec![0..0; patch.n_rows()],
            scratch: Scratch {
                shares: vec![0.0; n_columns],
                heights: vec![0.0; n_columns],
            },
            ..Self::default()
        }
    }

    /// Whether no taxel is deflected.
    pub fn is_at_rest(&self) -> bool {
        self.active.is_empty()
    }

    /// The deflected taxels, ascending, and their deflections, metres.
    pub fn touched(&self) -> &[(u32, f64)] {
        &self.touched
    }

    /// How many taxels are at their stroke and would be pushed further.
    pub fn n_saturated(&self) -> usize {
        self.n_saturated
    }

    /// Bytes that it holds.
    pub fn n_bytes(&self) -> usize {
        size_of::<Self>()
            + size_of_val(&self.deflections[..])
            + size_of_val(&self.spans[..])
            + size_of_val(&self.scratch.shares[..])
            + size_of_val(&self.scratch.heights[..])
            + self.active.capacity() * size_of::<u32>()
            + (self.touched.capacity() + self.before.capacity()) * size_of::<(u32, f64)>()
    }

    /// n_taxels deflections, metres.
    pub fn deflections(&self) -> &[f64] {
        &self.deflections
    }

    /// Relaxes what is deflected for `dt` seconds, then pushes by objects at poses in the patch frame.
    pub fn step<'a>(
        &mut self,
        patch: &BodyPatch,
        objects: impl Iterator<Item = (&'a SphereClusters, Pose)>,
        dt: f64,
    ) {
        if patch.taxel().damping > 0.0 {
            std::mem::swap(&mut self.touched, &mut self.before);
        }
        self.relax(patch, relaxation_factor(patch.taxel(), dt));
        for (object, pose) in objects {
            match patch.surface() {
                Surface::Rows(rows) => push_by_object(self, rows, object, &pose),
                Surface::Dome(dome) => dome.push(self, object, &pose),
            }
        }
        self.read(patch);
    }

    /// The deflected taxels, ascending, and the forces, newtons, that took them there in the last step, which was of `dt` seconds.
    pub fn forces(&self, patch: &BodyPatch, dt: f64) -> impl Iterator<Item = (u32, f64)> {
        let relaxation = Relaxation::of(patch.taxel(), dt);
        let mut before = self.before.iter().copied().peekable();
        self.touched.iter().map(move |&(taxel, deflection)| {
            while before.next_if(|&(earlier, _)| earlier < taxel).is_some() {}
            let was = before.next_if(|&(earlier, _)| earlier == taxel);
            let was = was.map_or(0.0, |(_, deflection)| deflection);
            (taxel, relaxation.force(was, deflection))
        })
    }

    /// Pushes taxels of a row, `columns` of it, as far as `needed` says of each, in metres.
    #[inline(always)]
    pub fn push_row(
        &mut self,
        row: usize,
        first: usize,
        columns: Range<usize>,
        needed: impl Fn(usize) -> f64,
    ) {
        let span = columns.start as u32..columns.end as u32;
        widen(&mut self.spans[row], &span, row as u32, &mut self.active);
        let taxels = &mut self.deflections[first + columns.start..first + columns.end];
        for (deflection, column) in taxels.iter_mut().zip(columns) {
            *deflection = deflection.max(needed(column));
        }
    }

    fn relax(&mut self, patch: &BodyPatch, left: f64) {
        let (spans, deflections) = (&mut self.spans, &mut self.deflections);
        self.active.retain(|&row| {
            let span = &mut spans[row as usize];
            let first = patch.row_start(row) as usize;
            let taxels = &mut deflections[first + span.start as usize..first + span.end as usize];
            let mut is_active = false;
            for deflection in taxels {
                let relaxed = *deflection * left;
                *deflection = if relaxed < AT_REST { 0.0 } else { relaxed };
                is_active |= *deflection > 0.0;
            }
            if !is_active {
                *span = 0..0;
            }
            is_active
        });
    }

    /// Stops what is pushed too far, and lists what is deflected.
    fn read(&mut self, patch: &BodyPatch) {
        let stroke = patch.taxel().stroke;
        let limit = saturation_limit(stroke);
        self.active.sort_unstable();
        self.touched.clear();
        self.n_saturated = 0;
        for &row in &self.active {
            let Range { start, end } = self.spans[row as usize];
            let first = patch.row_start(row);
            let numbers = first + start..first + end;
            let taxels = &mut self.deflections[numbers.start as usize..numbers.end as usize];
            for (number, deflection) in numbers.zip(taxels) {
                if *deflection > 0.0 {
                    self.n_saturated += usize::from(*deflection > limit);
                    *deflection = deflection.min(stroke);
                    self.touched.push((number, *deflection));
                }
            }
        }
    }
}

/// Pushes a patch by one object; the same bits with and without vector instructions, as nothing is fused.
///
/// In doubles, though roots of singles would be 4.6 times as fast: a single's last digit in S² is worth more the larger the sphere.
/// Of 32 spheres that touch all of 64 × 64 taxels singles were wrong by 5e-9 m (radius 45 mm, pressed lightly), 2e-7 m (as deep as
/// its middle) and 6e-7 m (radius 4 m); of 512 × 512 by up to 5e-5 m.
#[multiversion(targets("x86_64+avx2+fma"))]
fn push_by_object(
    state: &mut PatchState,
    patch: &RowPatch,
    object: &SphereClusters,
    patch_from_object: &Pose,
) {
    let uvw = patch.extrusion().uvw_from_patch();
    let rotation = uvw * DMat3::from_quat(patch_from_object.rotation);
    let translation = uvw * patch_from_object.translation;
    let rho = patch.taxel().radius;
    let rows = &patch.lines().positions;
    let (first, last) = (rows[0], rows[rows.len() - 1]);
    let is_beside = |w: f64, reach: f64| w + reach <= first || w - reach >= last;
    for (ball, spheres) in object.each() {
        let (center, reach) = (rotation * ball.center + translation, ball.radius + rho);
        if is_beside(center.z, reach) || !patch.is_near(center.xy(), reach) {
            continue;
        }
        for Sphere { center, radius } in spheres {
            let (center, reach) = (rotation * center + translation, radius + rho);
            if !is_beside(center.z, reach) {
                patch.each_run_near(center.xy(), reach, |run| {
                    push_columns(state, patch, center, reach, run);
                });
            }
        }
    }
}

/// Pushes a run of columns by a sphere (u, v, w; S), metres.
#[inline(always)]
fn push_columns(
    state: &mut PatchState,
    patch: &RowPatch,
    center: DVec3,
    reach: f64,
    run: Range<usize>,
) {
    state.scratch.lay(patch, center, reach, run.clone());
    let Some((covered, widest)) = state.scratch.covered(run.len()) else {
        return;
    };
    let n_columns = patch.extrusion().places().len();
    let shares = &state.scratch.shares[covered.clone()];
    let heights = &state.scratch.heights[covered.clone()];
    let start = run.start + covered.start;
    let span = start as u32..(run.start + covered.end) as u32;
    for row in patch.lines().within(center.z, widest) {
        widen(&mut state.spans[row], &span, row as u32, &mut state.active);
        let along = patch.lines().positions[row] - center.z;
        let along2 = along * along;
        let taxels = &mut state.deflections[row * n_columns + start..][..covered.len()];
        for ((deflection, share), height) in taxels.iter_mut().zip(shares).zip(heights) {
            let q = share - along2;
            let needed = if q > 0.0 { q.sqrt() - height } else { 0.0 };
            *deflection = deflection.max(needed);
        }
    }
}

impl Scratch {
    /// Computes what a sphere (u, v, w; S) is to the columns of a run.
    #[inline(always)]
    fn lay(&mut self, patch: &RowPatch, center: DVec3, reach: f64, run: Range<usize>) {
        let taxel = patch.taxel();
        let behind = -taxel.stroke - taxel.radius;
        let columns = patch.extrusion().places()[run.clone()].iter();
        let columns = columns.zip(&patch.extrusion().axes()[run]);
        let results = self.shares.iter_mut().zip(&mut self.heights);
        for ((share, height), (place, axis)) in results.zip(columns) {
            let (du, dv) = (center.x - place.x, center.y - place.y);
            let beside = du * axis.y - dv * axis.x;
            *height = du * axis.x + dv * axis.y;
            let is_behind = *height < behind;
            *share = if is_behind {
                -1.0
            } else {
                reach * reach - beside * beside
            };
        }
    }

    /// Which of the first n columns are pushed where the sphere is nearest, and how far along the rows it pushes any, metres.
    #[inline(always)]
    fn covered(&self, n: usize) -> Option<(Range<usize>, f64)> {
        let (mut covered, mut most) = (n..0, 0.0_f64);
        let columns = self.shares[..n].iter().zip(&self.heights);
        for (column, (share, height)) in columns.enumerate() {
            let above = height.max(0.0);
            let spare = share - above * above;
            if spare > 0.0 {
                covered = covered.start.min(column)..column + 1;
                most = most.max(spare);
            }
        }
        (!covered.is_empty()).then(|| (covered, most.sqrt()))
    }
}

/// Makes a row's span hold another one, and the row active.
#[inline(always)]
fn widen(span: &mut Range<u32>, by: &Range<u32>, row: u32, active: &mut Vec<u32>) {
    if span.start >= span.end {
        active.push(row);
        *span = by.clone();
    } else {
        *span = span.start.min(by.start)..span.end.max(by.end);
    }
}
