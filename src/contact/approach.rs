//! A skin of any shape moved along a line past first contact.

use super::skin_force::Way;
use super::{SkinContact, SkinWorkspace, press_skin};
use crate::error::Result;
use crate::geometry::Pose;
use crate::objects::Model;
use crate::world::{Layout, SkinPatch, Taxel, Taxels};
use glam::DVec3;

/// A stroke that nothing ends, metres.
const ENDLESS: f64 = 1e6;

/// The way of a patch along a direction.
///
/// A taxel first meets what its sphere meets on the way, wherever its own axis points: so first contact is found by taxels at the same
/// places whose axes are the direction and whose strokes do not end, and the one that is pushed farthest in was met first.
#[derive(Clone, Debug)]
pub struct Approach<'a> {
    patch: &'a SkinPatch,
    direction: DVec3,
    /// The taxels as they travel.
    travelling: SkinPatch,
    /// The shortest stroke, metres.
    stroke: f64,
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
        let strokes = (0..n_taxels).map(|number| patch.taxels().at(number).stroke);
        Ok(Self {
            patch,
            direction,
            travelling: SkinPatch::new(patch.name(), layout, Taxels::Each(taxels))?,
            stroke: strokes.fold(f64::INFINITY, f64::min),
        })
    }

    /// How far the patch goes until a taxel meets an object, metres, negative if it is past that; `None` where the way misses all of them.
    ///
    /// `patch_from_objects`: where the objects are, one an object. The deflections in the workspace are then of no use.
    ///
    /// # Panics
    /// If there are not as many poses as objects.
    pub fn first_contact(
        &self,
        objects: &[Model],
        patch_from_objects: &[Pose],
        workspace: &mut SkinWorkspace,
    ) -> Option<f64> {
        let mut way = self.way(objects, patch_from_objects, workspace);
        // There everything is past that is on the way.
        let [_, end] = way.ends()?;
        way.patch = &self.travelling;
        way.deflect(end);
        let deflections = workspace.deflections().iter();
        let farthest = deflections.fold(0.0, |a: f64, &b| a.max(b));
        (farthest > 0.0).then_some(end - farthest)
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
        let first = self.first_contact(objects, patch_from_objects, workspace);
        let Some(first) = first else {
            press_skin(self.patch, &[], &[], workspace);
            return None;
        };
        let mut way = self.way(objects, patch_from_objects, workspace);
        let n_steps = (depth / self.stroke / Way::STEP).ceil() as usize;
        for step in 1..n_steps {
            way.press(first + depth * step as f64 / n_steps as f64);
            way.workspace.hold_touched();
        }
        let travel = first + depth;
        let counts = way.press(travel);
        workspace.hold([]);
        Some(SkinTouch { travel, counts })
    }

    fn way<'b>(
        &'b self,
        objects: &'b [Model],
        patch_from_objects: &'b [Pose],
        workspace: &'b mut SkinWorkspace,
    ) -> Way<'b> {
        Way {
            patch: self.patch,
            objects,
            patch_from_objects,
            direction: self.direction,
            workspace,
        }
    }
}
