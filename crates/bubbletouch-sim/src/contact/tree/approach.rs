//! A skin of any shape moved along a line past first contact.

use super::near_spheres::{PlacedUnion, needed_of_leaf};
use super::path::{ApproachPath, ContactRequest, meeting};
use crate::contact::instructions::{Instructions, for_instructions};
use crate::contact::mesh::skin_mesh::MeshAt;
use crate::contact::{Contact, FrictionState, Workspace};
use crate::error::Result;
use crate::geometry::Pose;
use crate::objects::{Model, Sphere, SphereUnion};
use crate::world::{Node, Patch, Travelling};
use glam::DVec3;
use std::cell::Cell;
use std::sync::OnceLock;

/// The way of a patch along a direction.
///
/// A taxel first meets what its sphere meets on the way, wherever its own axis points: so first contact is found by taxels at the same
/// places whose axes are the direction and whose strokes do not end, and the one that is pushed farthest in was met first.
#[derive(Clone, Debug)]
pub struct Approach<'a> {
    patch: &'a Patch,
    direction: DVec3,
    /// Made when it is asked for; that along z is the patch's.
    travelling: OnceLock<Travelling>,
}

impl<'a> Approach<'a> {
    /// Of a patch along a direction (unit, in the patch frame).
    ///
    /// # Errors
    /// A direction whose length is not one.
    pub fn new(patch: &'a Patch, direction: DVec3) -> Result<Self> {
        ApproachPath::check(direction)?;
        Ok(Self::along(patch, direction))
    }

    /// Of a patch along its z.
    pub(crate) fn ahead(patch: &'a Patch) -> Self {
        Self::along(patch, DVec3::Z)
    }

    fn along(patch: &'a Patch, direction: DVec3) -> Self {
        Self {
            patch,
            direction,
            travelling: OnceLock::new(),
        }
    }

    /// The taxels as they travel.
    fn travelling(&self) -> &Travelling {
        if self.direction == DVec3::Z {
            return self.patch.ahead();
        }
        let make = || Travelling::new(self.patch, self.direction);
        self.travelling.get_or_init(make)
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
        // There everything is past that is on the path.
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
                self.travelling().taxels.each_near(center, radius, |taxel| {
                    let stop = mesh.stop(taxel);
                    farthest = stop.map_or(farthest, |stop| farthest.max(-stop.height));
                });
            }
        }
        farthest
    }

    /// The same of spheres: first those of the cluster that may push farthest, then of those that may push farther than these do.
    fn farthest_sphere(&self, union: &SphereUnion, pose: &Pose, others: f64) -> f64 {
        let (placed, travelling) = (PlacedUnion::new(union, pose), &self.travelling().taxels);
        let mut foremost = (others, None);
        for (cluster, ball) in placed.clusters() {
            let most = self.most(&ball);
            if most > foremost.0 && travelling.is_near(ball.center, ball.radius) {
                foremost = (most, Some(cluster));
            }
        }
        let Some(first) = foremost.1 else {
            return others;
        };
        let mut farthest = self.farthest_of(&placed, placed.of(first), others);
        for (cluster, ball) in placed.clusters() {
            if self.most(&ball) > farthest && travelling.is_near(ball.center, ball.radius) {
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
        self.travelling().front + ball.radius - ball.center.dot(self.direction)
    }

    /// The same of the taxels of a node: all that the ball meets are ahead of it, so that its way from their stretches is its way from their axes.
    #[inline(always)]
    fn most_of(&self, node: &Node, ball: &Sphere) -> f64 {
        let room = node.room(ball.center, ball.radius);
        match room >= 0.0 {
            true => room.sqrt() + node.front(self.direction) - ball.center.dot(self.direction),
            false => f64::NEG_INFINITY,
        }
    }

    /// Presses to a depth (metres, positive) past first contact; `None` (and zero deflections) where the way misses all objects. The
    /// workspace then says what touches what.
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
        workspace: &mut Workspace,
    ) -> Option<Contact> {
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
        friction: Option<&mut FrictionState>,
        workspace: &mut Workspace,
    ) -> Option<Contact> {
        let first = self.first_contact(objects, patch_from_objects);
        let travels = first.map(|first| [first, first + depth]);
        let mut path = self.path(objects, patch_from_objects, workspace);
        path.press_and_slide(travels, slide, friction)
    }

    /// The deflections alone, from one travel to another; `None` of none. Those of taxels along the direction need no steps: each is pushed in as far
    /// as it goes past what it met.
    pub(crate) fn deflect(
        &self,
        objects: &[Model],
        patch_from_objects: &[Pose],
        travels: Option<[f64; 2]>,
        workspace: &mut Workspace,
    ) -> Option<Contact> {
        let mut path = self.path(objects, patch_from_objects, workspace);
        path.contacts = ContactRequest::None;
        match travels {
            Some([_, travel]) if self.travelling().is_flat => {
                Some(path.press_through(&self.travelling().taxels, travel))
            }
            _ => path.press_and_slide(travels, DVec3::ZERO, None),
        }
    }

    pub(crate) fn path<'w>(
        &'w self,
        objects: &'w [Model],
        patch_from_objects: &'w [Pose],
        workspace: &'w mut Workspace,
    ) -> ApproachPath<'w> {
        ApproachPath {
            patch: self.patch,
            objects,
            patch_from_objects,
            direction: self.direction,
            contacts: ContactRequest::AtEnd,
            workspace,
        }
    }
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
        approach.travelling().taxels.each_leaf(
            |node| approach.most_of(node, &sphere) > farthest.get(),
            |leaf| {
                let needed = needed_of_leaf(leaf, &sphere);
                farthest.set(needed.into_iter().fold(farthest.get(), f64::max));
            },
        );
    }
    farthest.get()
}
