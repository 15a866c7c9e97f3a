//! Tangential springs between taxels and free objects: input and result of an equilibrium.

use crate::world::Shear;
use glam::{DVec2, DVec3};

/// Tangential spring between a taxel and a free object at the beginning of a time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TangentialSpring {
    /// Index of the taxel in its layout.
    pub taxel: usize,
    /// Index of the object in the scene.
    pub object: usize,
    /// Material point of the object that the taxel touches, metres, in the object's frame.
    pub point: DVec3,
    /// Position of the material point at the beginning of the time step, metres, in the patch frame.
    pub place: DVec3,
    /// Tangential displacement of the spring, metres, along x and y of the taxel's frame.
    pub displacement: DVec2,
    /// Stiffness of the spring and coefficient of friction.
    pub shear: Shear,
    /// Normal force on the taxel, newtons, that the solver uses as its first estimate.
    pub force: f64,
}

/// State of a tangential spring in equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TangentialSpringState {
    /// Index of the skin in the list of skins that support the objects.
    pub skin: usize,
    /// Index of the taxel in its layout.
    pub taxel: usize,
    /// Index of the object in the scene.
    pub object: usize,
    /// Position of the touched material point of the object, metres, in the patch frame.
    pub place: DVec3,
    /// Tangential displacement of the spring, metres, along x and y of the taxel's frame. The force on the object is minus the stiffness times this
    /// displacement.
    pub displacement: DVec2,
    /// Whether the tangential force reached the friction cone during the time step.
    pub has_slipped: bool,
}
