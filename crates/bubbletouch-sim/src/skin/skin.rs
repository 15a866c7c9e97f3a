//! Patches and bodies of a skin, and the relations between them.

use super::parts::{Body, RigidObject, SkinPatch};
use crate::error::{Error, Result};
use crate::objects::Model;
use crate::world::Patch;
use std::ops::Range;
use std::sync::Arc;

/// Patches of skin and bodies that may touch them.
///
/// If several bodies deflect a taxel, the largest deflection counts. Several threads may read one skin at the same time, each with its own
/// [`SkinReading`](super::SkinReading).
///
/// ```
/// use bubbletouch_sim::geometry::Pose;
/// use bubbletouch_sim::objects::{Sphere, SphereUnion};
/// use bubbletouch_sim::skin::{Pressed, ReadOptions, Skin, SkinPoses, SkinReading, SkinRelations};
/// use bubbletouch_sim::world::{Grid, Patch, Taxel};
/// use glam::DVec3;
///
/// // Two pads that face each other, and a ball of 20 mm between them.
/// let taxel = Taxel { radius: 1e-3, stiffness: 200.0, damping: 0.0, stroke: 3e-3 };
/// let pad = Patch::grid(Grid { nx: 8, ny: 8, pitch: 2e-3 }, taxel)?;
/// let ball = SphereUnion::new(vec![Sphere { center: DVec3::ZERO, radius: 0.02 }])?;
/// let skin = Skin::new(vec![pad.clone(), pad], vec![ball.into()], SkinRelations::default())?;
///
/// // The pads are 1 mm too close: the ball deflects each by half a millimetre.
/// let at = |z: f64| Pose::from_translation(z * DVec3::Z);
/// let turned = Pose::new(glam::DQuat::from_rotation_x(std::f64::consts::PI), 20.5e-3 * DVec3::Z);
/// let poses = SkinPoses { patches: &[at(-20.5e-3), turned], bodies: &[at(0.0)] };
/// let mut reading = SkinReading::default();
/// skin.read(poses, Pressed::AtPoses, ReadOptions::default(), None, &mut reading)?;
/// let [below, above] = [0, 1].map(|patch| reading.wrenches[patch].force.z);
/// assert!(below < 0.0 && (below - above).abs() < 1e-9);
///
/// // A gripper that reports 3 N: each pad travels until its taxels carry this force.
/// let pressed = Pressed::ToForces { forces: &[3.0, 3.0], directions: None };
/// skin.read(poses, pressed, ReadOptions::default(), None, &mut reading)?;
/// assert!(reading.residuals.iter().all(|newtons| newtons.abs() < 1e-9));
/// # Ok::<(), bubbletouch_sim::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Skin {
    pub(super) parts: Vec<SkinPatch>,
    pub(super) bodies: Vec<Body>,
    /// Objects of each patch, with the bodies that can touch the patch.
    pub(super) objects: Vec<Arc<[RigidObject]>>,
    /// Bodies that cannot touch each patch.
    pub(super) excluded: Vec<Vec<usize>>,
    /// Contact models of all bodies in one sequence, as presses with shear springs need them.
    pub(super) models: Vec<Model>,
    /// Rigid body that carries each patch.
    pub(super) carriers: Vec<usize>,
}

/// Relations between the patches and the bodies of a skin.
#[derive(Clone, Debug, Default)]
pub struct SkinRelations {
    /// Index of the rigid object to which each body belongs, from 0; `None` if each body is an object. Requested forces act between patches and objects, so the
    /// bodies of an object press a patch together.
    pub objects: Option<Vec<usize>>,
    /// Index of the rigid body that carries each patch, from 0; `None` if each patch has its own.
    pub carriers: Option<Vec<usize>>,
    /// Bodies that never press each patch, shape (n_patches, any number); `None` if each body can touch each patch.
    pub excluded: Option<Vec<Vec<usize>>>,
}

impl Skin {
    /// Creates a skin from its patches and the contact models of the bodies.
    ///
    /// # Errors
    /// If there is no patch, an index is missing or out of its range, or the indices of objects skip a number.
    pub fn new(patches: Vec<Patch>, bodies: Vec<Model>, relations: SkinRelations) -> Result<Self> {
        if patches.is_empty() {
            return Err(Error::input("patches", "none", "at least one Patch"));
        }
        let (n_patches, n_bodies) = (patches.len(), bodies.len());
        let SkinRelations {
            objects,
            carriers,
            excluded,
        } = relations;
        let carriers = carriers.unwrap_or_else(|| (0..n_patches).collect());
        let excluded = excluded.unwrap_or_else(|| vec![Vec::new(); n_patches]);
        let objects = objects.unwrap_or_else(|| (0..n_bodies).collect());
        for (place, n, n_needed, owners) in [
            ("carriers", carriers.len(), n_patches, "patches"),
            ("excluded", excluded.len(), n_patches, "patches"),
            ("objects", objects.len(), n_bodies, "bodies"),
        ] {
            if n != n_needed {
                let allowed = format!("one for each of {n_needed} {owners}");
                return Err(Error::input(place, format!("{n} indices"), allowed));
            }
        }
        if let Some(body) = excluded.iter().flatten().find(|body| **body >= n_bodies) {
            let allowed = format!("a body below {n_bodies}");
            return Err(Error::input("excluded", body, allowed));
        }
        let objects: Arc<[RigidObject]> = rigid_objects(&bodies, objects)?.into();
        let of_patch = |excluded: &Vec<usize>| match excluded.is_empty() {
            true => objects.clone(),
            false => objects.iter().map(|it| it.without(excluded)).collect(),
        };
        let mut first = 0;
        let parts = patches.into_iter().map(|patch| {
            let part = SkinPatch::new(patch, first);
            first = part.taxels().end;
            part
        });
        Ok(Self {
            parts: parts.collect(),
            objects: excluded.iter().map(of_patch).collect(),
            excluded,
            models: bodies.clone(),
            bodies: bodies.into_iter().map(Body::new).collect(),
            carriers,
        })
    }

    /// Returns the patches.
    pub fn patches(&self) -> impl ExactSizeIterator<Item = &Patch> {
        self.parts.iter().map(|part| &part.patch)
    }

    /// Returns the indices of each patch's taxels in a frame of the skin.
    pub fn ranges(&self) -> impl ExactSizeIterator<Item = Range<usize>> {
        self.parts.iter().map(SkinPatch::taxels)
    }

    /// Returns the number of taxels of all patches.
    pub fn n_taxels(&self) -> usize {
        self.parts.last().map_or(0, |part| part.taxels().end)
    }

    /// Returns the number of bodies.
    pub fn n_bodies(&self) -> usize {
        self.bodies.len()
    }

    /// Returns the number of rigid objects.
    pub fn n_objects(&self) -> usize {
        self.objects[0].len()
    }

    /// Returns the number of rigid bodies that carry patches.
    pub fn n_carriers(&self) -> usize {
        self.carriers.iter().max().map_or(0, |last| last + 1)
    }
}

/// Groups bodies into rigid objects by the index of the object of each body.
fn rigid_objects(bodies: &[Model], of_bodies: Vec<usize>) -> Result<Vec<RigidObject>> {
    let n_objects = of_bodies.iter().max().map_or(0, |last| last + 1);
    let missing = |object: &usize| !of_bodies.contains(object);
    if let Some(object) = (0..n_objects.min(bodies.len() + 1)).find(missing) {
        let given = format!("no body of object {object}");
        return Err(Error::input(
            "objects",
            given,
            "indices from 0 without a gap",
        ));
    }
    let mut grouped: Vec<RigidObject> = Vec::new();
    grouped.resize_with(n_objects, RigidObject::default);
    for (number, (body, object)) in bodies.iter().zip(of_bodies).enumerate() {
        grouped[object].members.push(number);
        grouped[object].models.push(body.clone());
    }
    Ok(grouped)
}
