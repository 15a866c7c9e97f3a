//! Individual contact loads on objects at rest.

use super::body::Body;
use super::energy::PairLoad;
use super::free_object::PlacedSkin;
use super::pair::{Kind, Pair};
use super::rigid_contact::Touched;
use crate::contact::Wrench;
use glam::DVec3;

/// Load between one taxel and one part of a free object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TaxelLoad {
    /// Index of the skin in the list of skins that support the objects.
    pub skin: usize,
    /// Index of the taxel in its layout.
    pub taxel: usize,
    /// Index of the object in the list passed to the solver.
    pub object: usize,
    /// Index of the sphere in its object, or number of the part in its mesh ([`MeshFeatures`](crate::mesh::MeshFeatures)).
    pub sphere: usize,
    /// Force of the sphere on the taxel along the taxel's axis, newtons, above 0.
    pub force: f64,
    /// Force of the hard limit at the end of the taxel's stroke, newtons: the part of `force` that the spring does not carry. The force is 0 if the
    /// deflection is smaller than the stroke.
    pub stop: f64,
    /// Whether the contact is grazing: the surface of the sphere at the contact point is nearly parallel to the taxel's axis (`GRAZING`).
    pub is_grazing: bool,
    /// Force and torque of the taxel on the object, in the patch frame, about the origin of the patch.
    pub on_object: Wrench,
}

/// Contact load between one part of a free object and a rigid counterpart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidContact {
    /// Index of the object in the list passed to the solver.
    pub object: usize,
    /// Index of the sphere in its object, or number of the part in its mesh ([`MeshFeatures`](crate::mesh::MeshFeatures)).
    pub sphere: usize,
    /// Rigid counterpart that the sphere touches.
    pub other: Touched,
    /// Contact point in the world, metres.
    pub point: DVec3,
    /// Force on the object in the world, newtons; the opposite force acts on the counterpart.
    pub force: DVec3,
}

impl TaxelLoad {
    pub(super) fn new(
        (skin, taxel): (usize, usize),
        object: usize,
        pair: &Pair,
        load: &PairLoad,
        body: &Body,
        skins: &[PlacedSkin],
    ) -> Self {
        let to_patch = skins[skin].world_from_patch.inverse();
        let center = to_patch.transform_point(body.center) + pair.arm;
        Self {
            skin,
            taxel,
            object,
            sphere: pair.part.1 as usize,
            force: load.force,
            stop: load.stop,
            is_grazing: pair.is_grazing(),
            on_object: Wrench::at(center, pair.push(load.force)),
        }
    }
}

impl RigidContact {
    /// Creates the report of a rigid contact; the function `of_body` maps the index of a body to the index of its object.
    pub(super) fn new(
        pair: &Pair,
        touched: Touched,
        load: &PairLoad,
        body: &Body,
        of_body: impl Fn(usize) -> usize,
    ) -> Self {
        let parts = match &pair.kind {
            Kind::Rigid(touching) => touching.parts,
            _ => None,
        };
        let sphere = parts.map_or(pair.part.1, |[own, _]| own) as usize;
        let counterpart = |number: usize| parts.map_or(number, |[_, other]| other as usize);
        let push = pair.push(load.force);
        let out = push.try_normalize().unwrap_or(DVec3::ZERO);
        let inset = match &pair.kind {
            Kind::Rigid(touching) => touching.inset,
            _ => 0.0,
        };
        Self {
            object: of_body(pair.part.0 as usize),
            sphere,
            other: match touched {
                Touched::Object(slot, sphere) => {
                    Touched::Object(of_body(slot), counterpart(sphere))
                }
                Touched::Obstacle(number, sphere) => Touched::Obstacle(number, counterpart(sphere)),
                plane => plane,
            },
            point: body.center + pair.arm - inset * out,
            force: push,
        }
    }
}
