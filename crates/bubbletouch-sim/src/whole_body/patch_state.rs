//! State of one patch, carried from step to step: the deflected taxels and their deflections.

use super::body_patch::BodyPatch;
use super::lanes::LANES;
use super::row_patch::SphereOverBundle;
use crate::contact::object_at::ClusterSearch;
use crate::contact::{Relaxation, relaxation_factor, saturation_limit};
use std::ops::Range;

/// Deflection below which a relaxing taxel counts as undeflected, metres: a ten-thousandth of the resolution of the finest skins.
pub const AT_REST: f64 = 1e-9;

/// Deflections of one patch: 8 bytes per taxel, and 8 more per deflected taxel.
///
/// Relaxing taxels remain deflected for many steps, far from the objects. Each row therefore has its own range, unlike the one rectangle of a press of a grid
/// (`GridValues`), and a step takes the time of the deflected taxels.
#[derive(Clone, Debug, Default)]
pub(super) struct PatchState {
    /// Deflections, metres, shape (n_taxels,), padded so that the last row also consists of whole blocks.
    deflections: Vec<f64>,
    n_taxels: usize,
    /// Range of columns in each row outside of which all taxels are undeflected; empty if the whole row is undeflected.
    spans: Vec<Range<u32>>,
    /// Indices of the rows with deflected taxels.
    active: Vec<u32>,
    /// Deflected taxels as pairs of index and deflection (metres).
    touched: Vec<(u32, f64)>,
    /// Deflected taxels before the last step, stored only with dampers, whose forces depend on them.
    before: Vec<(u32, f64)>,
    n_saturated: usize,
    /// Number of spheres for which rows, rings or tiles of taxels were evaluated in the last time step.
    pub n_evaluated: usize,
    /// Number of spheres near the patch that were excluded without evaluating rows, rings or tiles of taxels.
    pub n_rejected: usize,
    /// Scratch memory of the search for the spheres near the patch.
    pub clusters: ClusterSearch,
    /// Scratch memory for one sphere: the bundles of columns near it, with the index of each bundle's first column.
    pub under: Vec<(u32, SphereOverBundle)>,
}

impl PatchState {
    pub fn at_rest(patch: &BodyPatch) -> Self {
        Self {
            deflections: vec![0.0; patch.n_taxels() + LANES - 1],
            n_taxels: patch.n_taxels(),
            spans: vec![0..0; patch.n_rows()],
            ..Self::default()
        }
    }

    /// Returns whether no taxel is deflected.
    pub fn is_at_rest(&self) -> bool {
        self.active.is_empty()
    }

    /// Returns the deflected taxels, ascending, as pairs of index and deflection (metres).
    pub fn touched(&self) -> &[(u32, f64)] {
        &self.touched
    }

    /// Returns the number of saturated taxels, which an object pushes beyond the end of their stroke.
    pub fn n_saturated(&self) -> usize {
        self.n_saturated
    }

    /// Returns the memory that the state uses in bytes.
    pub fn n_bytes(&self) -> usize {
        size_of::<Self>()
            + size_of_val(&self.deflections[..])
            + size_of_val(&self.spans[..])
            + self.clusters.n_bytes()
            + self.under.capacity() * size_of::<(u32, SphereOverBundle)>()
            + self.active.capacity() * size_of::<u32>()
            + (self.touched.capacity() + self.before.capacity()) * size_of::<(u32, f64)>()
    }

    /// Returns the deflections of the patch, metres, shape (n_taxels,).
    pub fn deflections(&self) -> &[f64] {
        &self.deflections[..self.n_taxels]
    }

    /// Begins a time step by relaxing the deflected taxels for `dt` seconds.
    pub fn begin_step(&mut self, patch: &BodyPatch, dt: f64) {
        (self.n_evaluated, self.n_rejected) = (0, 0);
        if patch.taxel().damping > 0.0 {
            std::mem::swap(&mut self.touched, &mut self.before);
        }
        self.relax(patch, relaxation_factor(patch.taxel(), dt));
    }

    /// Returns the deflected taxels, ascending, with the forces on them in the last time step, newtons; `dt` is its duration in seconds.
    pub fn forces(&self, patch: &BodyPatch, dt: f64) -> impl Iterator<Item = (u32, f64)> {
        let relaxation = Relaxation::new(patch.taxel(), dt);
        let mut before = self.before.iter().copied().peekable();
        self.touched.iter().map(move |&(taxel, deflection)| {
            while before.next_if(|&(earlier, _)| earlier < taxel).is_some() {}
            let was = before.next_if(|&(earlier, _)| earlier == taxel);
            let was = was.map_or(0.0, |(_, deflection)| deflection);
            (taxel, relaxation.force(was, deflection))
        })
    }

    /// Raises the deflections in the `columns` of a row to the values that `needed` returns, metres.
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

    /// Extends the range of deflected columns of a row to contain `columns`, and marks the row as active.
    #[inline(always)]
    pub fn widen(&mut self, row: usize, columns: &Range<u32>) {
        widen(&mut self.spans[row], columns, row as u32, &mut self.active);
    }

    /// Returns a block of deflections; beyond the row's end the block contains taxels of the next row.
    #[inline(always)]
    pub fn block(&mut self, first: usize) -> &mut [f64; LANES] {
        let block = self.deflections[first..].first_chunk_mut();
        block.expect("a block's more is kept behind the last taxel")
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

    /// Ends a time step: limits deflections to the stroke and lists the deflected taxels.
    pub fn end_step(&mut self, patch: &BodyPatch) {
        let stroke = patch.taxel().stroke;
        self.active.sort_unstable();
        self.touched.clear();
        self.n_saturated = 0;
        for &row in &self.active {
            let Range { start, end } = self.spans[row as usize];
            let first = patch.row_start(row);
            let numbers = first + start..first + end;
            let taxels = &mut self.deflections[numbers.start as usize..numbers.end as usize];
            self.n_saturated += read_row(taxels, numbers.start, stroke, &mut self.touched);
        }
    }
}

/// Limits the deflections of consecutive taxels to the stroke, appends the deflected taxels to `touched`, and returns the number of saturated taxels.
///
/// A separate function keeps its few values in registers; inlined, it takes a sixth longer.
#[inline(never)]
fn read_row(taxels: &mut [f64], first: u32, stroke: f64, touched: &mut Vec<(u32, f64)>) -> usize {
    let limit = saturation_limit(stroke);
    let mut n_saturated = 0;
    touched.reserve(taxels.len());
    for (number, deflection) in (first..).zip(taxels) {
        if *deflection > 0.0 {
            n_saturated += usize::from(*deflection > limit);
            *deflection = deflection.min(stroke);
            touched.push((number, *deflection));
        }
    }
    n_saturated
}

/// Extends `span`, the range of deflected columns of a row, to contain another range, and marks the row as active.
#[inline(always)]
fn widen(span: &mut Range<u32>, by: &Range<u32>, row: u32, active: &mut Vec<u32>) {
    if span.start >= span.end {
        active.push(row);
        *span = by.clone();
    } else {
        *span = span.start.min(by.start)..span.end.max(by.end);
    }
}
