//! Patches and bodies of a skin, and the press of a patch under a body at its pose.

use bubbletouch::contact::{LoadRange, Press, Until, Workspace, Wrench, is_flat};
use bubbletouch::geometry::{Aabb, Pose};
use bubbletouch::objects::Model;
use bubbletouch::world::{self, Taxels};
use std::borrow::Cow;

/// Patch of a skin, with a ball that contains all its taxels.
pub struct SkinPatch {
    /// Patch of the Rust library.
    pub patch: world::Patch,
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
    deep: world::Patch,
}

/// Body that may touch the skin.
pub struct Body {
    /// Contact model in the body's frame.
    pub model: Model,
    bounds: Aabb,
}

/// Bodies that move together as one rigid object.
#[derive(Default)]
pub struct RigidObject {
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
    pub fn new(patch: world::Patch, first: usize) -> Self {
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

    /// Returns whether a body may be closer to the patch than `margin`, metres. The test uses the bounding box of the body in its own frame and the ball
    /// around the patch.
    pub fn is_near(&self, body: &Body, patch_from_body: &Pose, margin: f64) -> bool {
        let (center, radius) = self.range.ball;
        let center = patch_from_body.inverse().transform_point(center);
        let nearest = center.clamp(body.bounds.min, body.bounds.max);
        let reach = radius + margin;
        center.distance_squared(nearest) <= reach * reach
    }

    /// Returns the patch with a stroke that is larger by `reach`, metres.
    pub fn deep(&self, reach: f64) -> Cow<'_, world::Patch> {
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

    /// Adds the force and the torque of the normal forces on the patch, in its frame about its origin, N and N·m, to `wrench`.
    pub fn add_normal_forces(&self, deflections: &[f64], wrench: &mut [f64]) {
        let (layout, taxels) = (self.patch.layout(), self.patch.taxels());
        let places = layout.centers().iter().zip(layout.axes());
        let touched = deflections.iter().zip(places).enumerate();
        for (index, (deflection, (center, axis))) in touched.filter(|(_, (d, _))| **d > 0.0) {
            let force = -(taxels.at(index).stiffness * deflection) * *axis;
            add_wrench(wrench, Wrench::at(*center, force));
        }
    }

    /// Returns the numbers of touched taxels and of taxels at their stroke.
    pub fn count(&self, deflections: &[f64]) -> [i64; 2] {
        let mut counts = [0, 0];
        for (index, deflection) in deflections.iter().enumerate() {
            if *deflection > 0.0 {
                counts[0] += 1;
                counts[1] += i64::from(*deflection >= self.patch.taxels().at(index).stroke);
            }
        }
        counts
    }
}

/// Returns a patch with a stroke that is larger by `reach`, metres.
fn deepened(patch: &world::Patch, reach: f64) -> world::Patch {
    let deeper = |taxel: &world::Taxel| world::Taxel {
        stroke: taxel.stroke + reach,
        ..*taxel
    };
    let taxels = match patch.taxels() {
        Taxels::Equal(taxel) => Taxels::Equal(deeper(taxel)),
        Taxels::Each(taxels) => Taxels::Each(taxels.iter().map(deeper).collect()),
    };
    world::Patch::new(patch.name(), patch.layout().clone(), taxels)
        .expect("a larger stroke is valid")
}

/// Adds a wrench to a row of six numbers: force, N, and torque, N·m.
pub fn add_wrench(row: &mut [f64], Wrench { force, torque }: Wrench) {
    let six = force.to_array().into_iter().chain(torque.to_array());
    row.iter_mut().zip(six).for_each(|(sum, term)| *sum += term);
}

/// Replaces each deflection of a frame by the given one, if that is larger.
pub fn take_maximum(frame: &mut [f64], deflections: &[f64]) {
    for (taxel, deflection) in frame.iter_mut().zip(deflections) {
        *taxel = taxel.max(*deflection);
    }
}
