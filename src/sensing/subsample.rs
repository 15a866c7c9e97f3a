//! Some taxels, drawn without replacement.

use crate::random::Seed;
use rand::seq::SliceRandom;

/// The first m of a random order of all n taxels.
pub(super) fn taxels(m: usize, n: usize, stream: &Seed) -> Vec<usize> {
    let mut order = permutation(n, stream);
    order.truncate(m);
    order
}

/// 0 … n − 1 in random order; every order is equally likely.
pub(super) fn permutation(n: usize, stream: &Seed) -> Vec<usize> {
    let mut order: Vec<usize> = (0..n).collect();
    order.shuffle(&mut stream.rng());
    order
}
