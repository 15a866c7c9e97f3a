//! One patch from step to step: which of its taxels are deflected, and how far.

use super::body_patch::BodyPatch;
use super::lanes::LANES;
use super::row_patch::SphereOverBundle;
use crate::contact::{Relaxation, relaxation_factor, saturation_limit};
use std::ops::Range;

/// What relaxes and is deflected by less is at rest, metres; a ten-thousandth of what the finest skins tell apart.
pub const AT_REST: f64 = 1e-9;

/// A patch in memory: 8 bytes a taxel, and as much again for those that are deflected.
#[derive(Clone, Debug, Default)]
pub(super) struct PatchState {
    /// n_taxels, metres, and a block's more, so that the last row has all of its blocks too.
    deflections: Vec<f64>,
    n_taxels: usize,
    /// Of each row the columns beside which all are at rest; empty where the row is.
    spans: Vec<Range<u32>>,
    /// The rows that are not at rest.
    active: Vec<u32>,
    /// The deflected taxels by number, and by how much, metres.
    touched: Vec<(u32, f64)>,
    /// The same before the last step; of damped taxels only, whose force depends on it.
    before: Vec<(u32, f64)>,
    n_saturated: usize,
    /// Spheres for which rows, rings or tiles were looked at in the last step.
    pub n_evaluated: usize,
    /// Spheres of the objects near the patch that were left out before that.
    pub n_rejected: usize,
    /// Scratch of a search: of each cluster of an object, below zero if one of its spheres may touch.
    pub gaps: Vec<f64>,
    /// Scratch of a sphere: the bundles under it, by their first columns.
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
            + self.gaps.capacity() * size_of::<f64>()
            + self.under.capacity() * size_of::<(u32, SphereOverBundle)>()
            + self.active.capacity() * size_of::<u32>()
            + (self.touched.capacity() + self.before.capacity()) * size_of::<(u32, f64)>()
    }

    /// n_taxels deflections, metres.
    pub fn deflections(&self) -> &[f64] {
        &self.deflections[..self.n_taxels]
    }

    /// Relaxes the deflected taxels for `dt` seconds: a step begins.
    pub fn begin_step(&mut self, patch: &BodyPatch, dt: f64) {
        (self.n_evaluated, self.n_rejected) = (0, 0);
        if patch.taxel().damping > 0.0 {
            std::mem::swap(&mut self.touched, &mut self.before);
        }
        self.relax(patch, relaxation_factor(patch.taxel(), dt));
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

    /// Makes a row's span hold some columns, and the row active.
    #[inline(always)]
    pub fn widen(&mut self, row: usize, columns: &Range<u32>) {
        widen(&mut self.spans[row], columns, row as u32, &mut self.active);
    }

    /// A block of taxels; behind the last of its row come taxels of the next one.
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

    /// Stops taxels at their stroke, and lists those that are deflected: a step ends.
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

/// Stops taxels with consecutive numbers at their stroke, lists those that are deflected, and counts those that are stopped.
///
/// (A function by itself: among others compilers keep its few values in memory, which takes a sixth longer.)
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
