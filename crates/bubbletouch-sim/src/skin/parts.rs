//! Patches and bodies of a skin, and the press of a patch under a body at its pose.

use super::assigned_loads::LoadRange;
use super::point_loads::is_flat;
use crate::contact::{Press, Until, Workspace, Wrench};
use crate::geometry::{Aabb, Pose};
use crate::objects::Model;
use crate::world::{Patch, Taxel, Taxels};
use std::borrow::Cow;
use std::ops::Range;

/// Patch of a skin, with a ball that contains all its taxels.
#[derive(Clone, Debug)]
pub(super) struct SkinPatch {
    pub patch: Patch,
    /// Index of the patch's first taxel in a frame of the skin.
    pub first: usize,
    /// Whether all taxels point along z.
    pub is_flat: bool,
    /// Whether the patch is a flat grid of equal taxels along z.
    pub is_even: bool,
    /// Range within which contacts act on the patch; `reach` is also the default of the largest travel of a press to a force.
    pub range: LoadRange,
    /// Largest stroke of a taxel, metres.
    pub stroke: f64,
    /// The same taxels with a stroke that is larger by `reach`.
    deep: Patch,
}

/// Body that may touch the skin.
#[derive(Clone, Debug)]
pub(super) struct Body {
    /// Contact model in the body's frame.
    pub model: Model,
    bounds: Aabb,
}

/// Bodies that move together as one rigid object.
#[derive(Clone, Debug, Default)]
pub(super) struct RigidObject {
    /// Indices of the bodies.
    pub members: Vec<usize>,
    /// Contact models of the bodies, in the order of `members`.
    pub models: Vec<Model>,
}

impl RigidObject {
    /// Returns the object without some of its bodies.
    pub fn without(&self, excluded: &[usize]) -> Self {
        let all = self.members.iter().zip(&self.models);
        let kept = all.filter(|(member, _)| !excluded.contains(member));
        let (members, models) = kept.map(|(member, model)| (*member, model.clone())).unzip();
        Self { members, models }
    }
}

impl Body {
    /// Prepares a contact model for presses.
    pub fn new(model: Model) -> Self {
        model.prepare();
        Self {
            bounds: model.bounds(),
            model,
        }
    }
}

impl SkinPatch {
    /// Creates the part of a skin whose first taxel has the index `first` in a frame.
    pub fn new(patch: Patch, first: usize) -> Self {
        let (layout, taxels) = (patch.layout(), patch.taxels().all());
        let stroke = taxels.iter().map(|taxel| taxel.stroke).fold(0.0, f64::max);
        let centers = layout.centers();
        let is_level = centers.iter().all(|center| center.z == centers[0].z);
        let is_flat = is_flat(&patch);
        let range = LoadRange::new(&patch);
        Self {
            first,
            deep: deepened(&patch, range.reach),
            is_flat,
            is_even: is_flat
                && is_level
                && layout.as_grid().is_some()
                && matches!(patch.taxels(), Taxels::Equal(_)),
            range,
            stroke,
            patch,
        }
    }

    /// Returns the indices of the patch's taxels in a frame of the skin.
    pub fn taxels(&self) -> Range<usize> {
        self.first..self.first + self.patch.n_taxels()
    }

    /// Returns whether a body may be closer to the patch than `margin`, metres. The test uses the bounding box of the body in its own frame and the ball
    /// around the patch.
    pub fn is_near(&self, body: &Body, patch_from_body: &Pose, margin: f64) -> bool {
        let ball = self.range.ball.placed(&patch_from_body.inverse());
        let reach = ball.radius + margin;
        body.bounds.distance_squared(ball.center) <= reach * reach
    }

    /// Returns the patch with a stroke that is larger by `reach`, metres.
    pub fn deep(&self, reach: f64) -> Cow<'_, Patch> {
        if reach == self.range.reach {
            Cow::Borrowed(&self.deep)
        } else {
            Cow::Owned(deepened(&self.patch, reach))
        }
    }

    /// Replaces each deflection of a frame by the deflection under one body at its pose if the latter is larger.
    pub fn press(
        &self,
        body: &Body,
        patch_from_body: Pose,
        frame: &mut [f64],
        workspace: &mut Workspace,
    ) {
        let model = std::slice::from_ref(&body.model);
        Press::new(&self.patch, model, &[patch_from_body], Until::Pose)
            .run(workspace)
            .expect("checked poses");
        take_maximum(frame, workspace.deflections());
    }

    /// Returns the sum of the forces of the taxels along their axes, newtons, for their deflections, metres.
    pub fn total_force(&self, deflections: &[f64]) -> f64 {
        match self.patch.taxels() {
            Taxels::Equal(taxel) => taxel.stiffness * deflections.iter().sum::<f64>(),
            Taxels::Each(taxels) => {
                let pairs = taxels.iter().zip(deflections);
                pairs.map(|(taxel, d)| taxel.stiffness * d).sum()
            }
        }
    }

    /// Returns a wrench with the force and the torque of the normal forces on the patch added, in its frame about its origin.
    pub fn with_normal_forces(&self, wrench: Wrench, deflections: &[f64]) -> Wrench {
        let (layout, taxels) = (self.patch.layout(), self.patch.taxels());
        let places = layout.centers().iter().zip(layout.axes());
        let touched = deflections.iter().zip(places).enumerate();
        let touched = touched.filter(|(_, (deflection, _))| **deflection > 0.0);
        touched.fold(wrench, |sum, (index, (deflection, (center, axis)))| {
            let force = -(taxels.at(index).stiffness * deflection) * *axis;
            sum + Wrench::at(*center, force)
        })
    }
}

/// Returns a patch with a stroke that is larger by `reach`, metres.
fn deepened(patch: &Patch, reach: f64) -> Patch {
    let deeper = |taxel: &Taxel| Taxel {
        stroke: taxel.stroke + reach,
        ..*taxel
    };
    let taxels = match patch.taxels() {
        Taxels::Equal(taxel) => Taxels::Equal(deeper(taxel)),
        Taxels::Each(taxels) => Taxels::Each(taxels.iter().map(deeper).collect()),
    };
    Patch::new(patch.name(), patch.layout().clone(), taxels).expect("a larger stroke is valid")
}

/// Replaces each deflection of a frame by the given one, if that is larger.
pub(super) fn take_maximum(frame: &mut [f64], deflections: &[f64]) {
    for (taxel, deflection) in frame.iter_mut().zip(deflections) {
        *taxel = taxel.max(*deflection);
    }
}
