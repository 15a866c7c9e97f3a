//! A skin of any shape moved along a line past first contact.

use super::instructions::{Instructions, for_instructions};
use super::near_spheres::{PlacedUnion, needed_of_leaf};
use super::skin_mesh::MeshAt;
use super::way::{Way, meeting};
use super::{FrictionState, NormalForce, SkinContact, SkinWorkspace, press_skin};
use crate::error::Result;
use crate::geometry::Pose;
use crate::objects::{Model, Sphere, SphereUnion};
use crate::world::{Layout, Node, SkinPatch, Taxel, TaxelTree, Taxels};
use glam::DVec3;
use std::cell::Cell;

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

    /// The patch.
    pub fn patch(&self) -> &'a SkinPatch {
        self.patch
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
            Model::Spheres(union) => farthest = self.farthest_sphere(union, pose, others),
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

    /// The same of spheres: first those of the cluster that may push farthest, then of those that may push farther than these do.
    fn farthest_sphere(&self, union: &SphereUnion, pose: &Pose, others: f64) -> f64 {
        let placed = PlacedUnion::new(union, pose);
        let mut foremost = (others, None);
        for (cluster, ball) in placed.clusters() {
            let most = self.most(&ball);
            if most > foremost.0 && self.travelling.is_near(ball.center, ball.radius) {
                foremost = (most, Some(cluster));
            }
        }
        let Some(first) = foremost.1 else {
            return others;
        };
        let mut farthest = self.farthest_of(&placed, placed.of(first), others);
        for (cluster, ball) in placed.clusters() {
            if self.most(&ball) > farthest && self.travelling.is_near(ball.center, ball.radius) {
                farthest = self.farthest_of(&placed, placed.of(cluster), farthest);
            }
        }
        farthest
    }

    fn farthest_of(&self, placed: &PlacedUnion, numbers: &[u32], others: f64) -> f64 {
        farthest_of_each(Instructions::Best, self, placed, numbers, others)
    }

    /// How far a ball (in the patch frame) can push a taxel as they travel, at most, metres.
    #[inline(always)]
    fn most(&self, ball: &Sphere) -> f64 {
        self.front + ball.radius - ball.center.dot(self.direction)
    }

    /// The same of the taxels of a node: all that the ball meets are ahead of it, so that its way from their stretches is its way from their axes.
    #[inline(always)]
    fn most_of(&self, node: &Node, ball: &Sphere) -> f64 {
        let room = node.room(ball.center, ball.radius);
        let (least, largest) = (
            node.bounds.min * self.direction,
            node.bounds.max * self.direction,
        );
        let front = least.max(largest).element_sum();
        match room >= 0.0 {
            true => room.sqrt() + front - ball.center.dot(self.direction),
            false => f64::NEG_INFINITY,
        }
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
        let motion = (depth, DVec3::ZERO);
        self.press_and_slide(objects, patch_from_objects, motion, None, workspace)
    }

    /// Presses to a depth and then slides along a straight line (metres, in the patch frame), dragging the tips of the taxels if there is
    /// friction, which begins at rest; its forces are those at the end.
    ///
    /// # Panics
    /// If there are not as many poses as objects, or the friction is another patch's.
    pub fn press_and_slide(
        &self,
        objects: &[Model],
        patch_from_objects: &[Pose],
        (depth, slide): (f64, DVec3),
        mut friction: Option<&mut FrictionState>,
        workspace: &mut SkinWorkspace,
    ) -> Option<SkinTouch> {
        workspace.hold([]);
        if let Some(friction) = &mut friction {
            friction.step(self.patch, &[], &[], NormalForce::Springs);
        }
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
        let n_steps = |length| match friction {
            Some(_) => way.n_friction_steps(length),
            None => way.n_steps(length),
        };
        let travel = first + depth;
        let pressed = parts(depth, n_steps(depth)).map(|part| (first + part) * self.direction);
        let length = slide.length();
        let n_slides = if length > 0.0 { n_steps(length) } else { 0 };
        let slid = parts(1.0, n_slides).map(|part| travel * self.direction + part * slide);
        let mut counts = SkinContact::default();
        for (number, place) in pressed.chain(slid).enumerate() {
            if number > 0 {
                way.workspace.hold_touched();
            }
            counts = way.press_at(place);
            if let Some(friction) = &mut friction {
                let (contacts, poses) = (way.workspace.contacts(), &way.workspace.poses);
                friction.step(self.patch, contacts, poses, NormalForce::Springs);
            }
        }
        workspace.hold([]);
        Some(SkinTouch { travel, counts })
    }
}

/// The ends of so many equal parts of a length; the last is the length.
fn parts(length: f64, n: usize) -> impl Iterator<Item = f64> {
    (1..=n).map(move |number| match number == n {
        true => length,
        false => length * number as f64 / n as f64,
    })
}

for_instructions! {
    /// How far some spheres push the taxels of an approach, if that is more than others do.
    fn farthest_of_each(
        approach: &Approach,
        placed: &PlacedUnion,
        numbers: &[u32],
        others: f64,
    ) -> f64 = farthest_by_leaves
}

#[inline(always)]
fn farthest_by_leaves(
    approach: &Approach,
    placed: &PlacedUnion,
    numbers: &[u32],
    others: f64,
) -> f64 {
    let farthest = Cell::new(others);
    for &number in numbers {
        let sphere = placed.at(number);
        if approach.most(&sphere) <= farthest.get() {
            continue;
        }
        approach.travelling.each_leaf(
            |node| approach.most_of(node, &sphere) > farthest.get(),
            |leaf| {
                let [needed, _] = needed_of_leaf(leaf, &sphere);
                farthest.set(needed.into_iter().fold(farthest.get(), f64::max));
            },
        );
    }
    farthest.get()
}
