//! Approach of a patch with any layout along a line, and presses past first contact.

use super::near_spheres::{PlacedUnion, needed_of_leaf};
use super::path::{ApproachPath, ContactRequest, meeting};
use crate::contact::checks::{check_direction, check_output};
use crate::contact::instructions::{Instructions, for_instructions};
use crate::contact::mesh::skin_mesh::MeshAt;
use crate::contact::mesh::{LeafStops, SearchStack, stop_leaf};
use crate::contact::{Contact, FrictionState, Goal, Workspace};
use crate::error::{Error, Result};
use crate::geometry::{Pose, check_poses};
use crate::objects::{Model, Sphere, SphereUnion};
use crate::world::{Leaf, Node, Patch, Travelling};
use glam::DVec3;
use std::cell::Cell;
use std::sync::OnceLock;

/// Approach of a patch along a direction, for presses to a depth or force past first contact.
///
/// First contact depends on the taxels' spheres and the direction, not on the taxels' axes. The search for first contact therefore uses a copy of the taxels
/// whose axes are the direction and whose strokes are unlimited. The taxel whose copy has the largest deflection touches first.
#[derive(Clone, Debug)]
pub struct Approach<'a> {
    patch: &'a Patch,
    direction: DVec3,
    /// Copy of the taxels with axes along the direction, created on first use; for the direction z the patch itself stores the copy.
    travelling: OnceLock<Travelling>,
}

impl<'a> Approach<'a> {
    /// Creates the approach of a patch along a direction (unit vector, in the patch frame).
    ///
    /// # Errors
    /// If the direction is not a unit vector.
    pub fn new(patch: &'a Patch, direction: DVec3) -> Result<Self> {
        check_direction(direction)?;
        Ok(Self::along(patch, direction))
    }

    /// Creates the approach of a patch along its z axis.
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

    /// Returns the copy of the patch's taxels whose axes are replaced by the direction of travel.
    fn travelling(&self) -> &Travelling {
        if self.direction == DVec3::Z {
            return self.patch.ahead();
        }
        let make = || Travelling::new(self.patch, self.direction);
        self.travelling.get_or_init(make)
    }

    /// Returns the travel of the patch at which a taxel first meets an object, metres; negative if the patch is past this contact. Returns `None` if the path
    /// misses all objects.
    ///
    /// `patch_from_objects` has one pose per object.
    ///
    /// # Errors
    /// If the poses are invalid, as in [`press`](crate::contact::press()).
    pub fn first_contact(
        &self,
        objects: &[Model],
        patch_from_objects: &[Pose],
    ) -> Result<Option<f64>> {
        check_poses("object", objects.len(), patch_from_objects)?;
        Ok(self.meets(objects, patch_from_objects))
    }

    /// Returns the travel at first contact as [`first_contact`](Self::first_contact) does, for poses that have been checked.
    pub(crate) fn meets(&self, objects: &[Model], patch_from_objects: &[Pose]) -> Option<f64> {
        let [_, end] = meeting(self.patch, objects, patch_from_objects, self.direction)?;
        // At this travel the patch is past all objects on its path.
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

    /// Returns the larger of `others` and the largest deflection that an object requires of a taxel whose axis is the direction of travel, metres.
    fn farthest(&self, object: &Model, pose: &Pose, others: f64) -> f64 {
        match object {
            Model::Spheres(union) => self.farthest_sphere(union, pose, others),
            Model::Mesh(mesh) => self.farthest_of_mesh(&MeshAt::new(mesh, pose), others),
        }
    }

    /// Returns the larger of `others` and the largest deflection that a mesh requires of a taxel, metres. The taxels nearest to a low corner of the mesh are
    /// evaluated first, so that most triangles are excluded for the others.
    fn farthest_of_mesh(&self, mesh: &MeshAt, others: f64) -> f64 {
        let (taxels, direction) = (&self.travelling().taxels, self.direction);
        let mut farthest = others;
        let mut stack = SearchStack::new();
        let mut visit = |leaf: &Leaf| {
            let mut stops = LeafStops::lowest_below(-farthest);
            stop_leaf(Instructions::Best, mesh, leaf, &mut stops, &mut stack);
            let heights = stops.heights.iter();
            farthest = heights.fold(farthest, |farthest, height| farthest.max(-height));
        };
        if let Some(leaf) = taxels.leaf_beside(mesh.low_corner(direction), direction) {
            visit(leaf);
        }
        taxels.each_leaf(|node| mesh.is_near(node), visit);
        farthest
    }

    /// Returns the larger of `others` and the largest deflection that a sphere union requires of a taxel, metres. The cluster with the largest bound is
    /// evaluated first, then those whose bound exceeds the deflection found.
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
        let mut farthest = self.farthest_of(&placed, placed.cluster(first), others);
        for (cluster, ball) in placed.clusters() {
            if self.most(&ball) > farthest && travelling.is_near(ball.center, ball.radius) {
                farthest = self.farthest_of(&placed, placed.cluster(cluster), farthest);
            }
        }
        farthest
    }

    fn farthest_of(&self, placed: &PlacedUnion, numbers: &[u32], others: f64) -> f64 {
        farthest_of_each(Instructions::Best, self, placed, numbers, others)
    }

    /// Returns an upper bound of the deflection, metres, by a ball in the patch frame, for taxels whose axes are the direction of travel.
    #[inline(always)]
    fn most(&self, ball: &Sphere) -> f64 {
        self.travelling().front + ball.radius - ball.center.dot(self.direction)
    }

    /// Returns an upper bound of the deflections, metres, that a ball requires of the taxels in a tree node. All taxels are parallel, so the bound uses the
    /// distance from their axes.
    #[inline(always)]
    fn most_of(&self, node: &Node, ball: &Sphere) -> f64 {
        let room = node.margin(ball.center, ball.radius);
        match room >= 0.0 {
            true => room.sqrt() + node.front(self.direction) - ball.center.dot(self.direction),
            false => f64::NEG_INFINITY,
        }
    }

    /// Presses the patch to a depth (metres, zero or positive) past first contact and records the contacts in the workspace. Returns `None`, with zero deflections,
    /// if the path misses all objects.
    ///
    /// A part of an object that pushes a taxel continues to push this taxel even from behind the substrate. No object can therefore pass through the skin.
    ///
    /// # Errors
    /// If the depth is negative or not finite, or the poses are invalid, as in [`press`](crate::contact::press()).
    pub fn press_to_depth(
        &self,
        objects: &[Model],
        patch_from_objects: &[Pose],
        depth: f64,
        workspace: &mut Workspace,
    ) -> Result<Option<Contact>> {
        let motion = (depth, DVec3::ZERO);
        self.press_and_slide(objects, patch_from_objects, motion, None, workspace)
    }

    /// Presses the patch to a depth and then slides it along a straight line (metres, in the patch frame). With friction, the objects drag the taxels
    /// sideways. The friction is zero at the start of the path; `friction` then contains the forces at the end of the path.
    ///
    /// # Errors
    /// If the depth is negative, a number is not finite, or the poses are invalid, as in [`press`](crate::contact::press()). If the friction belongs to a
    /// patch with another number of taxels.
    pub fn press_and_slide(
        &self,
        objects: &[Model],
        patch_from_objects: &[Pose],
        (depth, slide): (f64, DVec3),
        friction: Option<&mut FrictionState>,
        workspace: &mut Workspace,
    ) -> Result<Option<Contact>> {
        check_poses("object", objects.len(), patch_from_objects)?;
        Goal::Depth(depth).check()?;
        if !slide.is_finite() {
            return Err(Error::input(
                "slide",
                format!("{slide} m"),
                "finite numbers",
            ));
        }
        if let Some(friction) = &friction {
            check_output(friction.force3().len(), self.patch.n_taxels())?;
        }
        let first = self.meets(objects, patch_from_objects);
        let travels = first.map(|first| [first, first + depth]);
        let mut path = self.path(objects, patch_from_objects, workspace);
        Ok(path.press_and_slide(travels, slide, friction))
    }

    /// Computes the deflections from one travel to another without recording contacts; returns `None` if `travels` is `None`. Taxels whose axes are parallel to
    /// the direction need no steps, because their deflection follows from the travel past their contact.
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

    /// Records the contacts after the patch, whose taxels are all parallel to the direction, has travelled a distance, metres. Unlike
    /// [`press_to_depth`](Self::press_to_depth), the function needs no first contact and no steps. Returns `None` if the patch is curved.
    ///
    /// # Errors
    /// If the travel is not finite, or the poses are invalid, as in [`press`](crate::contact::press()).
    pub fn contacts_at_travel(
        &self,
        objects: &[Model],
        patch_from_objects: &[Pose],
        travel: f64,
        workspace: &mut Workspace,
    ) -> Result<Option<Contact>> {
        check_poses("object", objects.len(), patch_from_objects)?;
        Goal::Travel(travel).check()?;
        let travelling = self.travelling();
        let mut path = self.path(objects, patch_from_objects, workspace);
        let is_flat = travelling.is_flat;
        Ok(is_flat.then(|| path.press_through_with_contacts(&travelling.taxels, travel)))
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
    /// Returns the larger of `others` and the largest deflection that any of the listed spheres requires of a taxel, metres.
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
