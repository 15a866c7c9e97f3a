//! Bodies of any size for the ladders: equal sleeves of ten patches, far from each other.

use crate::error::Result;
use crate::geometry::Pose;
use crate::whole_body::{BodyPatch, WholeBody};
use crate::world::{Extrusion, Taxel};
use glam::{DQuat, DVec3};
use std::f64::consts::TAU;

/// A sleeve: how many patches of `side` metres are around it and along it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sleeve {
    pub n_around: usize,
    pub n_along: usize,
    pub side: f64,
}

/// From sleeve to sleeve, metres.
const APART: f64 = 1.0;

impl Sleeve {
    /// Patches of 100 × 100 taxels, or smaller ones of a body that has fewer taxels than one sleeve of those.
    pub fn of_body(n_taxels: usize, (n_around, n_along): (usize, usize), pitch: f64) -> Self {
        let a_patch = (n_taxels as f64 / (n_around * n_along) as f64).min(1e4);
        Self {
            n_around,
            n_along,
            side: pitch * a_patch.sqrt().round(),
        }
    }

    /// Of the rest centres, metres.
    pub fn radius(&self) -> f64 {
        self.n_around as f64 * self.side / TAU
    }

    /// Sleeves about z in rows of twenty, the first at the origin, the last with patches missing: about `n_taxels` in all.
    pub fn body(
        &self,
        n_taxels: usize,
        taxel: Taxel,
        pitch: f64,
    ) -> Result<(WholeBody, Vec<Pose>)> {
        let part = Extrusion::cylinder(
            self.radius(),
            self.side - pitch,
            (self.side - pitch) / self.radius(),
            pitch,
        )?;
        let n_patches = (n_taxels as f64 / part.n_taxels() as f64).round().max(1.0) as usize;
        let patches = (0..n_patches)
            .map(|number| BodyPatch::new(format!("patch {number}"), part.clone(), taxel));
        let poses = (0..n_patches).map(|number| self.pose(number)).collect();
        Ok((WholeBody::new(patches.collect::<Result<_>>()?)?, poses))
    }

    fn pose(&self, number: usize) -> Pose {
        let a_sleeve = self.n_around * self.n_along;
        let (sleeve, place) = (number / a_sleeve, number % a_sleeve);
        let (row, column) = ((sleeve / 20) as f64, (sleeve % 20) as f64);
        let turn = TAU * (place % self.n_around) as f64 / self.n_around as f64;
        let ring = (place / self.n_around) as f64;
        let height = (ring - 0.5 * (self.n_along - 1) as f64) * self.side;
        Pose::new(
            DQuat::from_rotation_z(turn),
            DVec3::new(APART * row, APART * column, height),
        )
    }
}
