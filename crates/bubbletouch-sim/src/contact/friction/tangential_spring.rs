//! Tangential springs between taxels and free objects: input and result of an equilibrium.

use crate::world::Shear;
use glam::{DVec2, DVec3};

/// Tangential spring between a taxel and a free object at the beginning of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TangentialSpring {
    /// Number of the taxel in its layout.
    pub taxel: usize,
    /// Number of the object.
    pub object: usize,
    /// Material point of the object that the taxel touches, metres, in the object's frame.
    pub point: DVec3,
    /// Place of this point at the beginning of the step, metres, in the patch frame.
    pub place: DVec3,
    /// Tangential displacement u, metres, along x and y of the taxel's [frame](crate::world::Layout::frame).
    pub displacement: DVec2,
    /// Stiffness and coefficient of friction.
    pub shear: Shear,
    /// Normal force on the taxel, newtons; the solver starts from it.
    pub force: f64,
}

/// State of a tangential spring in equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TangentialSpringState {
    /// Number of the skin in the list of the [`Ground`](crate::contact::equilibrium::Ground).
    pub skin: usize,
    /// Number of the taxel in its layout.
    pub taxel: usize,
    /// Number of the object.
    pub object: usize,
    /// Place of the material point of the object, metres, in the patch frame.
    pub place: DVec3,
    /// Tangential displacement u, metres, along x and y of the taxel's frame; the force on the object is −k_t u.
    pub displacement: DVec2,
    /// Whether the tangential force reached the friction cone during the step.
    pub has_slipped: bool,
}
