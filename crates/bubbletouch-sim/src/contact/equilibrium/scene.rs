//! Free objects during the search for equilibrium, and the parameters of their energy.

use super::body::Body;
use super::free_object::Ground;
use super::loads::{Multipliers, Smoothness};
use super::shear_springs::Spring;
use super::symmetric::norm;

/// Bodies and ground of a search for equilibrium, with the parameters of the energy.
#[derive(Clone)]
pub(super) struct Scene<'a> {
    pub bodies: Vec<Body<'a>>,
    pub ground: &'a Ground<'a>,
    pub multipliers: Multipliers,
    pub smoothness: Smoothness,
    pub springs: Vec<Spring>,
}

impl Scene<'_> {
    /// Returns the largest ratio, over all bodies, between the norm of a body's energy gradient and the body's weight.
    pub fn slope(&self, gradient: &[f64]) -> f64 {
        let each = self.bodies.iter().zip(gradient.chunks(6));
        each.map(|(body, part)| norm(part) / body.weight.length())
            .fold(0.0, f64::max)
    }
}
