//! Subsample ensemble: a random subset of taxels, drawn without replacement.

use super::ensemble::{EnsembleAbout, Operator};
use crate::random::Seed;
use crate::world::ImageShape;
use ndarray::{Array2, ArrayView2, ArrayViewMut2};
use rand::seq::SliceRandom;

pub(crate) const ABOUT: EnsembleAbout =
    EnsembleAbout::new("subsample", |ImageShape { ny, nx }, m, seed| {
        Box::new(Taxels(random_taxels(ny * nx, m, seed)))
    });

/// Index of the taxel that each measurement reads.
#[derive(Debug)]
pub(crate) struct Taxels(pub(crate) Vec<usize>);

impl Operator for Taxels {
    fn measure(&self, frames: ArrayView2<f64>, mut out: ArrayViewMut2<f64>) {
        for (frame, mut row) in frames.outer_iter().zip(out.outer_iter_mut()) {
            row.iter_mut()
                .zip(&self.0)
                .for_each(|(y, &i)| *y = frame[i]);
        }
    }

    fn each_entry(&self, visit: &mut dyn FnMut(usize, usize, f64)) {
        let picked = self.0.iter().enumerate();
        picked.for_each(|(measurement, &taxel)| visit(measurement, taxel, 1.0));
    }

    fn taxels(&self) -> Option<&[usize]> {
        Some(&self.0)
    }

    fn known_gram(&self) -> Option<Array2<f64>> {
        Some(Array2::eye(self.0.len()))
    }
}

/// Returns m of n taxels, drawn without replacement from the stream of the ensemble `subsample`.
pub(crate) fn random_taxels(n: usize, m: usize, seed: &Seed) -> Vec<usize> {
    let mut order = permutation(n, &seed.named("subsample"));
    order.truncate(m);
    order
}

/// Returns the numbers 0 … n − 1 in random order; every order is equally probable.
pub(crate) fn permutation(n: usize, stream: &Seed) -> Vec<usize> {
    let mut order: Vec<usize> = (0..n).collect();
    order.shuffle(&mut stream.rng());
    order
}
