//! A skin of any shape moved along a line past first contact.

use super::skin_mesh::MeshAt;
use super::skin_press::needed_anywhere;
use super::way::{Way, meeting};
use super::{SkinContact, SkinWorkspace, press_skin};
use crate::error::Result;
use crate::geometry::Pose;
use crate::objects::Model;
use crate::world::{Layout, PlacedTaxel, SkinPatch, Taxel, TaxelTree, Taxels};
use glam::{DMat3, DVec3};

/// A stroke that nothing ends, metres.
const ENDLESS: f64 = 1e6;

/// What rounding may take from the most that a sphere can push, metres: far above 1e-16 of a way, far below what leaves spheres to look at.
const ROUNDING: f64 = 1e-9;

/// The way of a patch along a direction.
///
/// A taxel first meets what its sphere meets on the way, wherever its own axis points: so first contact is found by taxels at the same
/// places whose axes are the direction and whose strokes do not end, and the one that is pushed farthest in was met first.
#[derive(Clone, Debug)]
pub struct Approach<'a> {
    patch: &'a SkinPatch,
    direction: DVec3,
    /// The taxels as they travel.
    travelling: TaxelTree,
    /// How far the foremost of them is along the direction, its radius included, metres.
    front: f64,
}

/// Where a skin is on its way; its deflections and contacts are in the [`SkinWorkspace`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkinTouch {
    /// How far the patch went along the direction from where it was, metres; negative if it had to go back.
    pub travel: f64,
    /// What it touches there.
    pub counts: SkinContact,
}

impl<'a> Approach<'a> {
    /// Of a patch along a direction (unit, in the patch frame); about a microsecond a taxel.
    ///
    /// # Errors
    /// A direction whose length is not one.
    pub fn new(patch: &'a SkinPatch, direction: DVec3) -> Result<Self> {
        Way::check(direction)?;
        let n_taxels = patch.n_taxels();
        let taxels = (0..n_taxels).map(|number| Taxel {
            stroke: ENDLESS,
            ..*patch.taxels().at(number)
        });
        let taxels: Vec<Taxel> = taxels.collect();
        let layout = Layout::new(patch.layout().centers().to_vec(), vec![direction; n_taxels])?;
        let places = layout.centers().iter().zip(&taxels);
        let fronts = places.map(|(center, taxel)| center.dot(direction) + taxel.radius);
        Ok(Self {
            patch,
            direction,
            front: fronts.fold(f64::NEG_INFINITY, f64::max),
            travelling: TaxelTree::new(&layout, &Taxels::Each(taxels)),
        })
    }

    /// How far the patch goes until a taxel meets an object, metres, negative if it is past that; `None` where the way misses all of them.
    ///
    /// `patch_from_objects`: where the objects are, one an object.
    ///
    /// # Panics
    /// If there are not as many poses as objects.
    pub fn first_contact(&self, objects: &[Model], patch_from_objects: &[Pose]) -> Option<f64> {
        assert_eq!(
            objects.len(),
            patch_from_objects.len(),
            "one pose an object"
        );
        let [_, end] = meeting(self.patch, objects, patch_from_objects, self.direction)?;
        // There everything is past that is on the way.
        let mut farthest = 0.0;
        for (object, pose) in objects.iter().zip(patch_from_objects) {
            let pose = Pose {
                translation: pose.translation - end * self.direction,
                ..*pose
            };
            farthest = self.farthest(object, &pose, farthest);
        }
        (farthest > 0.0).then_some(end - farthest)
    }

    /// How far an object pushes the taxels as they travel, metres, if that is more than others do.
    fn farthest(&self, object: &Model, pose: &Pose, others: f64) -> f64 {
        let mut farthest = others;
        match object {
            Model::Spheres(union) => {
                let rotation = DMat3::from_quat(pose.rotation);
                for sphere in union.spheres() {
                    let center = rotation * sphere.center + pose.translation;
                    // Most of an object is behind what was met first.
                    let most = self.front + sphere.radius - center.dot(self.direction);
                    if most + ROUNDING < farthest {
                        continue;
                    }
                    let needed =
                        |taxel: &PlacedTaxel| needed_anywhere(taxel, center, sphere.radius).0;
                    self.travelling.each_near(center, sphere.radius, |taxel| {
                        farthest = farthest.max(needed(taxel));
                    });
                }
            }
            Model::Mesh(mesh) => {
                let mesh = MeshAt::new(mesh, pose);
                let (center, radius) = mesh.ball();
                self.travelling.each_near(center, radius, |taxel| {
                    let stop = mesh.stop(taxel);
                    farthest = stop.map_or(farthest, |stop| farthest.max(-stop.height));
                });
            }
        }
        farthest
    }

    /// Presses to a depth (metres, positive) past first contact; `None` (and zero deflections) where the way misses all objects.
    ///
    /// What pushes a taxel goes on pushing it behind the substrate: nothing passes through the skin.
    ///
    /// # Panics
    /// If there are not as many poses as objects.
    pub fn press_to_depth(
        &self,
        objects: &[Model],
        patch_from_objects: &[Pose],
        depth: f64,
        workspace: &mut SkinWorkspace,
    ) -> Option<SkinTouch> {
        workspace.hold([]);
        let Some(first) = self.first_contact(objects, patch_from_objects) else {
            press_skin(self.patch, &[], &[], workspace);
            return None;
        };
        let mut way = Way {
            patch: self.patch,
            objects,
            patch_from_objects,
            direction: self.direction,
            workspace,
        };
        let n_steps = way.n_steps(depth);
        for step in 1..n_steps {
            way.press(first + depth * step as f64 / n_steps as f64);
            way.workspace.hold_touched();
        }
        let travel = first + depth;
        let counts = way.press(travel);
        workspace.hold([]);
        Some(SkinTouch { travel, counts })
    }
}
