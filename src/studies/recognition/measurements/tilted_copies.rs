//! Training touches once more, with their objects tilted: what an object looks like in tilts that were never learned.

use crate::random::Seed;
use crate::studies::recognition::measurements::measurement_inputs::CopyInputs;
use rand::Rng;
use std::collections::HashMap;

/// The touches that are copied and how each copy is tilted.
#[derive(Clone, Debug)]
pub struct TiltedCopies {
    /// The touches, by number.
    pub touches: Vec<usize>,
    /// Copies of each.
    pub n_copies: usize,
    /// Of each touch and copy: by how much a reading rises from a taxel to the next along x and y.
    pub slopes: Vec<(f64, f64)>,
    /// The place of each touch in the list.
    places: HashMap<usize, usize>,
}

impl TiltedCopies {
    /// Copies training touches (in drawing order, one of each of n classes in turn). `steepest` is the largest rise from a taxel to the next; each touch
    /// has a stream of its own.
    pub fn of(
        CopyInputs {
            n_copies,
            n_touches,
            tilt: _,
        }: CopyInputs,
        (train, n_classes): (&[usize], usize),
        steepest: f64,
        seed: &Seed,
    ) -> Self {
        // One of each object in turn: the first ones are what a cell with fewer learns from.
        let n_touches = n_touches.map_or(train.len(), |n| n * n_classes);
        let touches = train[..n_touches.min(train.len())].to_vec();
        let mut slopes = Vec::with_capacity(touches.len() * n_copies);
        for &touch in &touches {
            let mut rng = seed.numbered(touch as u64).rng();
            let mut slope = || steepest * rng.gen_range(-1.0..=1.0);
            slopes.extend((0..n_copies).map(|_| (slope(), slope())));
        }
        let places = touches.iter().copied().zip(0..).collect();
        Self {
            touches,
            n_copies,
            slopes,
            places,
        }
    }

    /// Where in all copies the first `n_copies` of some touches are: the first copy of each, then the second of each.
    ///
    /// # Panics
    /// A touch that was not copied, or more copies than there are.
    pub fn rows(&self, touches: &[usize], n_copies: usize) -> impl Iterator<Item = usize> {
        assert!(n_copies <= self.n_copies, "copies that there are");
        let all = (0..n_copies).flat_map(move |copy| touches.iter().map(move |t| (copy, t)));
        all.map(|(copy, touch)| self.places[touch] * self.n_copies + copy)
    }
}
