//! Path of a patch along a line past objects, divided into steps.

use super::press;
use crate::contact::{Contact, FrictionState, NormalForce, Workspace};
use crate::geometry::Pose;
use crate::objects::Model;
use crate::world::{EvenGrid, Patch, Taxel, TaxelTree};
use glam::DVec3;

/// Length of a step along the path, relative to the shortest stroke of a taxel. If larger, a short peak of the force may be missed, and small spheres may
/// pass through; if smaller, presses are wasted.
const STEP: f64 = 0.5;
/// Length of a step with friction, relative to the smallest radius of a taxel. If larger, taxels that come into contact within a step are dragged too little.
/// If smaller, more presses change the shear by at most one per cent.
const FRICTION_STEP: f64 = 0.25;
/// Maximum number of steps along a path. If strokes are far shorter than the path, the steps become longer.
const MAX_STEPS: f64 = 4096.0;

/// Path of a patch along a direction (unit vector, in the patch frame), with the poses of the objects before the motion.
pub(crate) struct ApproachPath<'a> {
    pub patch: &'a Patch,
    pub objects: &'a [Model],
    pub patch_from_objects: &'a [Pose],
    pub direction: DVec3,
    pub contacts: ContactRequest,
    pub workspace: &'a mut Workspace,
}

/// Selection whether a press along a path records contacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ContactRequest {
    /// Contacts are recorded at the end of the path.
    AtEnd,
    /// No contacts are recorded.
    None,
}

impl Patch {
    /// Returns the number of steps for a part of the path with this `length`, metres.
    pub fn n_steps(&self, length: f64) -> usize {
        let step = STEP * self.least(|taxel| taxel.stroke);
        (length / step).ceil().clamp(1.0, MAX_STEPS) as usize
    }

    fn least(&self, of: fn(&Taxel) -> f64) -> f64 {
        let values = self.taxels().all().iter().map(of);
        values.fold(f64::INFINITY, f64::min)
    }
}

impl ApproachPath<'_> {
    /// Returns the number of steps with friction for a part of the path with this `length`, metres.
    pub fn n_friction_steps(&self, length: f64) -> usize {
        let step = FRICTION_STEP * self.patch.least(|taxel| taxel.radius);
        // Rounding of the length must not add a step.
        let n_steps = (length / step * (1.0 - 1e-9)).ceil();
        let n_steps = n_steps.clamp(1.0, MAX_STEPS) as usize;
        n_steps.max(self.patch.n_steps(length))
    }

    /// Presses the patch after a `travel` along the path, metres.
    pub fn press(&mut self, travel: f64) -> Contact {
        self.press_at(travel * self.direction)
    }

    /// Presses after the patch has moved by a vector (metres, in the patch frame), computed as the opposite motion of the objects.
    pub fn press_at(&mut self, moved: DVec3) -> Contact {
        self.at(moved, press::deflect_with_contacts)
    }

    /// Presses a flat patch along its axis from the front, using taxels whose axes are the direction of travel.
    pub fn press_through(&mut self, taxels: &TaxelTree, travel: f64) -> Contact {
        let contact = self.at(
            travel * self.direction,
            |patch, objects, poses, workspace| {
                press::push_tree(
                    (taxels, None),
                    patch.n_taxels(),
                    (objects, poses),
                    workspace,
                );
                press::stop(patch, workspace)
            },
        );
        Contact { travel, ..contact }
    }

    /// Presses a flat patch along its axis from the front as [`press_through`](Self::press_through) does, and records the contacts.
    pub fn press_through_with_contacts(&mut self, taxels: &TaxelTree, travel: f64) -> Contact {
        let is_along_z = self.direction == DVec3::Z;
        let press =
            |patch: &Patch, objects: &[Model], poses: &[Pose], workspace: &mut Workspace| {
                let along_axis = patch.even_grid().filter(|_| is_along_z);
                let endless = along_axis.map(|grid| EvenGrid {
                    behind: f64::NEG_INFINITY,
                    ..*grid
                });
                let (n_taxels, placed) = (patch.n_taxels(), (objects, poses));
                press::push_tree((taxels, endless.as_ref()), n_taxels, placed, workspace);
                press::meet(patch, objects, poses, workspace)
            };
        let contact = self.at(travel * self.direction, press);
        Contact { travel, ..contact }
    }

    fn at(
        &mut self,
        moved: DVec3,
        press: impl FnOnce(&Patch, &[Model], &[Pose], &mut Workspace) -> Contact,
    ) -> Contact {
        let mut poses = std::mem::take(&mut self.workspace.poses);
        poses.clear();
        let back = -moved;
        poses.extend(self.patch_from_objects.iter().map(|pose| Pose {
            translation: pose.translation + back,
            ..*pose
        }));
        let counts = press(self.patch, self.objects, &poses, self.workspace);
        self.workspace.poses = poses;
        counts
    }

    /// Presses the patch from one travel to another and then slides it along a straight line; `None` if the patch meets nothing.
    pub fn press_and_slide(
        &mut self,
        travels: Option<[f64; 2]>,
        slide: DVec3,
        mut friction: Option<&mut FrictionState>,
    ) -> Option<Contact> {
        self.workspace.hold([]);
        if let Some(friction) = &mut friction {
            friction.step(self.patch, &[], &[], NormalForce::Springs);
        }
        let Some([first, travel]) = travels else {
            press::deflect(self.patch, &[], &[], self.workspace);
            return None;
        };
        let n_steps = |length| match friction {
            Some(_) => self.n_friction_steps(length),
            None => self.patch.n_steps(length),
        };
        let direction = self.direction;
        let depth = travel - first;
        let pressed = parts([first, travel], n_steps(depth)).map(|part| part * direction);
        let length = slide.length();
        let n_slides = if length > 0.0 { n_steps(length) } else { 0 };
        let slid = parts([0.0, 1.0], n_slides).map(|part| travel * direction + part * slide);
        let mut contact = Contact::default();
        let mut places = pressed.chain(slid).peekable();
        while let Some(place) = places.next() {
            let is_last = places.peek().is_none();
            let are_asked = is_last && self.contacts == ContactRequest::AtEnd;
            contact = match are_asked || friction.is_some() {
                true => self.press_at(place),
                false => self.at(place, press::deflect),
            };
            if !is_last {
                self.workspace.hold_touched();
            }
            if let Some(friction) = &mut friction {
                let (contacts, poses) = (self.workspace.contacts(), &self.workspace.poses);
                friction.step(self.patch, contacts, poses, NormalForce::Springs);
            }
        }
        self.workspace.hold([]);
        Some(Contact { travel, ..contact })
    }
}

/// Returns the ends of `n` equal parts of an interval; the end of the last part is exactly the interval's end.
fn parts([start, end]: [f64; 2], n: usize) -> impl Iterator<Item = f64> {
    (1..=n).map(move |number| match number == n {
        true => end,
        false => start + (end - start) * number as f64 / n as f64,
    })
}

/// Returns the travels between which the bounding ball of the moving patch meets the bounding balls of objects; `None` if none meet.
pub(crate) fn meeting(
    patch: &Patch,
    objects: &[Model],
    patch_from_objects: &[Pose],
    direction: DVec3,
) -> Option<[f64; 2]> {
    let tree = patch.tree();
    let around = tree.bounds()?;
    let center = around.center();
    let radius = 0.5 * around.size().length() + tree.largest_radius();
    let pairs = objects.iter().zip(patch_from_objects);
    let meetings = pairs.filter_map(|(object, pose)| {
        let bounds = object.bounds();
        let away = pose.transform_point(bounds.center()) - center;
        let reach = radius + 0.5 * bounds.size().length();
        let ahead = away.dot(direction);
        let half2 = reach * reach - away.cross(direction).length_squared();
        (half2 > 0.0).then(|| [ahead - half2.sqrt(), ahead + half2.sqrt()])
    });
    meetings.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
}
