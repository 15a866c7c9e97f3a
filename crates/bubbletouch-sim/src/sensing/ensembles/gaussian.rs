//! Gaussian ensemble: independent entries N(0, 1/n).

use super::dense::{Dense, about, by_rows};
use super::ensemble::EnsembleAbout;
use crate::world::ImageShape;
use ndarray::Array1;
use ndarray_rand::RandomExt;
use rand_distr::StandardNormal;

pub(crate) const ABOUT: EnsembleAbout = about("Gaussian", |ImageShape { ny, nx }, m, seed| {
    let n = ny * nx;
    let row = |rng: &mut _| Array1::random_using(n, StandardNormal, rng);
    Box::new(Dense(by_rows(m, n, &seed.named("gaussian"), row)))
});
