//! Bernoulli ensemble: independent entries ±1/√n with equal probability.

use super::dense::{Dense, about, by_rows};
use super::ensemble::EnsembleAbout;
use crate::world::ImageShape;
use ndarray::Array1;
use rand::Rng;
use rand_chacha::ChaCha8Rng;

pub(crate) const ABOUT: EnsembleAbout = about("Bernoulli", |ImageShape { ny, nx }, m, seed| {
    let n = ny * nx;
    let sign = |rng: &mut ChaCha8Rng| if rng.r#gen() { 1.0 } else { -1.0 };
    let row = |rng: &mut ChaCha8Rng| Array1::from_shape_simple_fn(n, || sign(rng));
    Box::new(Dense(by_rows(m, n, &seed.named("bernoulli"), row)))
});
