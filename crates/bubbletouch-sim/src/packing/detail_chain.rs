//! Packings of one object at several levels of detail.

use super::pack::{Packing, pack_mesh};
use super::target::Body;
use crate::error::{Error, Result};
use crate::mesh::Surface;
use rayon::prelude::*;

/// Packings of one mesh, ordered from coarse to fine.
///
/// Invariant: there is at least one packing, and the tolerances strictly decrease.
#[derive(Clone, Debug, PartialEq)]
pub struct DetailChain {
    packings: Vec<Packing>,
}

impl DetailChain {
    /// Packs a mesh with spheres for each of several tolerances (metres, in any order; repeated values count once).
    ///
    /// # Errors
    /// If there are no tolerances, or if [`pack_mesh`] fails.
    pub fn pack(surface: &Surface, body: Body, tolerances: &[f64]) -> Result<Self> {
        let mut tolerances = tolerances.to_vec();
        tolerances.sort_by(|a, b| b.total_cmp(a));
        tolerances.dedup();
        let tolerances = tolerances.into_par_iter();
        let packings = tolerances.map(|tolerance| pack_mesh(surface, body, tolerance));
        Self::new(packings.collect::<Result<_>>()?)
    }

    /// Creates a chain from packings of one mesh at different tolerances, in any order.
    ///
    /// # Errors
    /// If there is no packing, or if two packings have equal tolerances.
    pub fn new(mut packings: Vec<Packing>) -> Result<Self> {
        packings.sort_by(|a, b| b.tolerance.total_cmp(&a.tolerance));
        let is_twice = |pair: &[Packing]| pair[0].tolerance == pair[1].tolerance;
        if packings.is_empty() || packings.windows(2).any(is_twice) {
            let tolerances = packings.iter().map(|packing| packing.tolerance);
            let given = format!("tolerances {:?} m", tolerances.collect::<Vec<_>>());
            let allowed = "at least one, each once";
            return Err(Error::input("levels of detail", given, allowed));
        }
        Ok(Self { packings })
    }

    /// Returns the packings, ordered from coarse to fine.
    pub fn packings(&self) -> &[Packing] {
        &self.packings
    }

    /// Returns the packing with the largest tolerance that does not exceed `tolerance` (metres).
    ///
    /// # Errors
    /// If the tolerance of the finest packing exceeds `tolerance`.
    pub fn coarsest_within(&self, tolerance: f64) -> Result<&Packing> {
        let mut packings = self.packings.iter();
        let fitting = packings.find(|packing| packing.tolerance <= tolerance);
        fitting.ok_or_else(|| {
            let finest = self.packings[self.packings.len() - 1].tolerance;
            let allowed = format!("at least {finest} m, the finest level of detail");
            Error::input("tolerance", format!("{tolerance} m"), allowed)
        })
    }
}
