//! What carries objects at rest, one force after the other.

use super::body::Body;
use super::energy::PairLoad;
use super::free_object::PlacedSkin;
use super::pair::Pair;
use super::rigid_contact::Touched;
use crate::contact::Wrench;
use glam::DVec3;

/// What one taxel carries of one sphere of an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TaxelLoad {
    /// The skin's number in the list that objects were put to rest on.
    pub skin: usize,
    /// The taxel's number in its layout.
    pub taxel: usize,
    /// The object's number.
    pub object: usize,
    /// The sphere's number.
    pub sphere: usize,
    /// What the sphere puts on the taxel along its axis, newtons, above 0.
    pub force: f64,
    /// The part of that force which the spring at its stroke does not carry, newtons: its share in the reaction of the stop, the
    /// multiplier of δ ≤ s in the balance; 0 before the stroke.
    pub stop: f64,
    /// Whether the sphere's flank is as good as parallel to the axis: see [`GRAZING`](crate::contact::GRAZING).
    pub is_grazing: bool,
    /// What the taxel puts on the object, in the patch frame: force n_c / (n_c·n).
    pub on_object: Wrench,
}

/// What something rigid carries of one sphere of an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// The object's number.
    pub object: usize,
    /// The sphere's number.
    pub sphere: usize,
    /// What it touches.
    pub other: Touched,
    /// Where, in the world, metres.
    pub point: DVec3,
    /// On the object, newtons, in the world; the opposite on what it touches.
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

impl Touch {
    /// `of_body`: the number of the object that is behind a place among bodies.
    pub(super) fn new(
        pair: &Pair,
        touched: Touched,
        load: &PairLoad,
        body: &Body,
        of_body: impl Fn(usize) -> usize,
    ) -> Self {
        let sphere = pair.part.1 as usize;
        let push = pair.push(load.force);
        let out = push.try_normalize().unwrap_or(DVec3::ZERO);
        Self {
            object: of_body(pair.part.0 as usize),
            sphere,
            other: match touched {
                Touched::Object(slot, sphere) => Touched::Object(of_body(slot), sphere),
                rigid => rigid,
            },
            point: body.center + pair.arm - body.object.spheres[sphere].radius * out,
            force: push,
        }
    }
}
