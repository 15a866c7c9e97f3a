//! Patches and bodies of a skin, and the press of a patch under a body at its pose.

use bubbletouch::contact::{Workspace, Wrench, press_at_pose};
use bubbletouch::geometry::{Aabb, Pose};
use bubbletouch::objects::Model;
use bubbletouch::world::{self, Taxels};
use glam::DVec3;
use std::borrow::Cow;

/// Patch of a skin, with a ball that contains all its taxels.
pub struct SkinPatch {
    /// Patch of the Rust library.
    pub patch: world::Patch,
    /// Index of the patch's first taxel in a frame of the skin.
    pub first: usize,
    /// Whether the patch is a flat grid of equal taxels along z.
    pub is_even: bool,
    /// Default of the largest travel of a press to a force: the largest stroke plus the largest diameter of a taxel, metres.
    pub reach: f64,
    /// Largest stroke of a taxel, metres.
    pub stroke: f64,
    /// Centre and radius of a ball around all taxels, in the patch frame, metres.
    ball: (DVec3, f64),
    /// Largest distance, metres, of a contact from the axis of the nearest taxel at which it acts on the patch: the largest spacing.
    /// If larger, contacts beside the skin act on it; if smaller, contacts on the rim do not.
    margin: f64,
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
        let radius = taxels.iter().map(|taxel| taxel.radius).fold(0.0, f64::max);
        let stroke = taxels.iter().map(|taxel| taxel.stroke).fold(0.0, f64::max);
        let centers = layout.centers();
        let (min, max) = centers.iter().fold(
            (DVec3::INFINITY, DVec3::NEG_INFINITY),
            |(min, max), center| (min.min(*center), max.max(*center)),
        );
        let is_flat = min.z == max.z && layout.axes().iter().all(|axis| *axis == DVec3::Z);
        let reach = stroke + 2.0 * radius;
        Self {
            first,
            margin: radius.max(largest_spacing(&patch)),
            deep: deepened(&patch, reach),
            is_even: is_flat
                && layout.as_grid().is_some()
                && matches!(patch.taxels(), Taxels::Equal(_)),
            reach,
            stroke,
            ball: (0.5 * (min + max), 0.5 * (max - min).length() + radius),
            patch,
        }
    }

    /// Returns whether a body may be closer to the patch than `margin`, metres. The test uses the bounding box of the body in its own frame and the ball
    /// around the patch.
    pub fn is_near(&self, body: &Body, patch_from_body: &Pose, margin: f64) -> bool {
        let (center, radius) = self.ball;
        let center = patch_from_body.inverse().transform_point(center);
        let nearest = center.clamp(body.bounds.min, body.bounds.max);
        let reach = radius + margin;
        center.distance_squared(nearest) <= reach * reach
    }

    /// Returns the distance of a point from the nearest taxel, metres, and whether a contact there acts on the patch: it faces the taxel, with at least the
    /// cosine `facing` between `direction` and the taxel's axis, and is within the margin beside the taxels. It is at most `reach` before the taxel; points of
    /// deep contacts are up to twice as far behind it.
    pub fn place(
        &self,
        point: DVec3,
        direction: DVec3,
        facing: f64,
        reach: Option<f64>,
    ) -> (f64, bool) {
        let layout = self.patch.layout();
        let squares = layout
            .centers()
            .iter()
            .map(|center| center.distance_squared(point));
        let nearest = squares.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        let (taxel, square) = nearest.expect("a patch has taxels");
        let (axis, offset) = (layout.axes()[taxel], point - layout.centers()[taxel]);
        let height = offset.dot(axis);
        let beside = (square - height * height).max(0.0).sqrt();
        let reach = reach.unwrap_or(0.0).max(self.reach);
        let acts = direction.dot(axis) >= facing * direction.length()
            && beside <= self.margin * (1.0 + 1e-9)
            && (-2.0 * reach..=reach).contains(&height);
        (square.sqrt(), acts)
    }

    /// Returns the diameter of the ball around all taxels, metres.
    pub fn size(&self) -> f64 {
        2.0 * self.ball.1
    }

    /// Returns the patch with a stroke that is larger by `reach`, metres.
    pub fn deep(&self, reach: f64) -> Cow<'_, world::Patch> {
        if reach == self.reach {
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
        press_at_pose(&self.patch, model, &[patch_from_body], workspace);
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
    pub fn add_wrench(&self, deflections: &[f64], wrench: &mut [f64]) {
        let (layout, taxels) = (self.patch.layout(), self.patch.taxels());
        let places = layout.centers().iter().zip(layout.axes());
        let touched = deflections.iter().zip(places).enumerate();
        for (index, (deflection, (center, axis))) in touched.filter(|(_, (d, _))| **d > 0.0) {
            let force = -(taxels.at(index).stiffness * deflection) * *axis;
            let Wrench { force, torque } = Wrench::at(*center, force);
            let six = force.to_array().into_iter().chain(torque.to_array());
            for (sum, term) in wrench.iter_mut().zip(six) {
                *sum += term;
            }
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

/// Returns the largest distance between a taxel and its nearest neighbour, metres; 0 for a single taxel.
fn largest_spacing(patch: &world::Patch) -> f64 {
    let centers = patch.layout().centers();
    if let Some(grid) = patch.layout().as_grid() {
        return if centers.len() > 1 { grid.pitch } else { 0.0 };
    }
    let nearest = centers.iter().enumerate().map(|(taxel, center)| {
        let others = centers
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != taxel);
        others
            .map(|(_, other)| center.distance_squared(*other))
            .fold(f64::INFINITY, f64::min)
    });
    let largest = nearest
        .filter(|square| square.is_finite())
        .fold(0.0, f64::max);
    largest.sqrt()
}

/// Replaces each deflection of a frame by the given one, if that is larger.
pub fn take_maximum(frame: &mut [f64], deflections: &[f64]) {
    for (taxel, deflection) in frame.iter_mut().zip(deflections) {
        *taxel = taxel.max(*deflection);
    }
}
