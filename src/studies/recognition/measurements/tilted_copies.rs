//! Tilted copies of training touches, which show objects at tilts that the training touches do not have.

use crate::random::Seed;
use crate::studies::recognition::measurements::measurement_inputs::CopyInputs;
use rand::Rng;
use std::collections::HashMap;

/// Tilted copies of touches: the copied touches, and the tilt of each copy.
#[derive(Clone, Debug)]
pub struct TiltedCopies {
    /// Numbers of the touches that are copied.
    pub touches: Vec<usize>,
    /// Number of tilted copies of each touch in `touches`.
    pub n_copies: usize,
    /// Slope of each copy of each touch along x and y: increase of the reading from one taxel to the next.
    pub slopes: Vec<(f64, f64)>,
    /// Position in `touches` of each copied touch.
    places: HashMap<usize, usize>,
}

impl TiltedCopies {
    /// Draws the tilts of copies of training touches. The touches are given in drawing order and alternate between n classes; each has its own random stream.
    /// `steepest` is the maximum increase of a reading from one taxel to the next.
    pub fn new(
        CopyInputs {
            n_copies,
            n_touches,
            tilt: _,
        }: CopyInputs,
        (train, n_classes): (&[usize], usize),
        steepest: f64,
        seed: &Seed,
    ) -> Self {
        // The order alternates between objects, so that configurations with fewer touches use a prefix.
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

    /// Returns the row numbers of the first `n_copies` tilted copies of the given touches, ordered by copy, then by touch.
    ///
    /// # Panics
    /// If a touch was not copied, or if there are fewer copies.
    pub fn rows(&self, touches: &[usize], n_copies: usize) -> impl Iterator<Item = usize> {
        assert!(n_copies <= self.n_copies, "copies that there are");
        let all = (0..n_copies).flat_map(move |copy| touches.iter().map(move |t| (copy, t)));
        all.map(|(copy, touch)| self.places[touch] * self.n_copies + copy)
    }
}
