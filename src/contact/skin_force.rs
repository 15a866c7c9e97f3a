//! A skin of any shape moved along a line until it feels a force.

use super::crossing::{Sample, crossing};
use super::press_force::{ACCURACY, check_force, too_much};
use super::spring_load::spring_load;
use super::{SkinContact, SkinWorkspace, deflect_skin, press_skin};
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::objects::Model;
use crate::world::{SkinPatch, Taxel};
use glam::DVec3;

/// Where a skin feels the force that it was moved for; its deflections and contacts are in the [`SkinWorkspace`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkinPress {
    /// How far the patch went along the direction from where it was, metres, not negative.
    pub travel: f64,
    /// Σ k δ there, N.
    pub force: f64,
    /// What it touches there.
    pub counts: SkinContact,
}

/// At most so many steps a way: of strokes far shorter than the way they become longer.
const MOST_STEPS: f64 = 4096.0;

/// Moves a patch along a direction (unit, in the patch frame) until its springs carry `force` newtons together, Σ k δ: to within
/// 1e-12 of it, or to the last bit of the travel.
///
/// `patch_from_objects`: where the objects are before, one an object. `None` where the way misses all of them (the workspace then
/// holds the last press on it). Taxels of a curved skin come and go along the way: the first travel with this force that steps of
/// half a stroke find is named. Where the force jumps past it (an edge that comes upon a taxel from the side), the
/// upper side of the jump is. What pushes a taxel goes on pushing it behind the substrate: nothing passes through the skin.
///
/// # Errors
/// A force that is not a positive number; a direction whose length is not one; a patch that carries the force where it is; a force
/// that is not reached on the way past the objects: the text says the largest one and its travel.
///
/// # Panics
/// If there are not as many poses as objects.
pub fn press_skin_to_force(
    patch: &SkinPatch,
    objects: &[Model],
    patch_from_objects: &[Pose],
    direction: DVec3,
    force: f64,
    workspace: &mut SkinWorkspace,
) -> Result<Option<SkinPress>> {
    check_force(force)?;
    Way::check(direction)?;
    workspace.hold([]);
    let mut way = Way {
        patch,
        objects,
        patch_from_objects,
        direction,
        workspace,
    };
    let pressed = way.go(force);
    workspace.hold([]);
    pressed
}

/// A patch on its way along a line past objects.
pub(super) struct Way<'a> {
    pub patch: &'a SkinPatch,
    pub objects: &'a [Model],
    pub patch_from_objects: &'a [Pose],
    pub direction: DVec3,
    pub workspace: &'a mut SkinWorkspace,
}

impl Way<'_> {
    /// Steps in which the way is looked at are this part of the shortest stroke. Larger: a short peak of the force may be jumped
    /// over, and small spheres may pass through; smaller: more presses in vain.
    pub const STEP: f64 = 0.5;

    /// An error unless a direction's length is one.
    pub fn check(direction: DVec3) -> Result<()> {
        match direction.is_finite() && (direction.length() - 1.0).abs() < 1e-9 {
            true => Ok(()),
            false => Err(Error::input(
                "touch direction",
                direction,
                "a vector of length one",
            )),
        }
    }

    /// Goes on until the force is felt.
    fn go(&mut self, force: f64) -> Result<Option<SkinPress>> {
        let Some([start, end]) = self.ends().filter(|[_, end]| *end > 0.0) else {
            self.press(0.0);
            return Ok(None);
        };
        let Some([low, high]) = self.bracket([start.max(0.0), end], force)? else {
            return Ok(None);
        };
        let travel = crossing(low, high, ACCURACY * force, |travel| {
            let Sample { value, slope } = self.sample(travel);
            let value = value - force;
            Sample { value, slope }
        });
        let counts = self.press(travel);
        Ok(Some(SkinPress {
            travel,
            force: self.sample_of_last().value,
            counts,
        }))
    }

    /// The travels between which the balls around patch and objects meet; `None` if none does.
    pub fn ends(&self) -> Option<[f64; 2]> {
        let tree = self.patch.tree();
        let around = tree.bounds()?;
        let center = around.center();
        let radius = 0.5 * around.size().length() + tree.largest_radius();
        let pairs = self.objects.iter().zip(self.patch_from_objects);
        let meetings = pairs.filter_map(|(object, pose)| {
            let bounds = object.bounds();
            let away = pose.transform_point(bounds.center()) - center;
            let reach = radius + 0.5 * bounds.size().length();
            let ahead = away.dot(self.direction);
            let half2 = reach * reach - away.cross(self.direction).length_squared();
            (half2 > 0.0).then(|| [ahead - half2.sqrt(), ahead + half2.sqrt()])
        });
        meetings.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }

    /// Two travels, with less than the force at the first and not less at the second; `None` if nothing is touched.
    fn bracket(&mut self, [start, end]: [f64; 2], force: f64) -> Result<Option<[f64; 2]>> {
        let mut largest = (self.sample(start).value, start);
        self.workspace.hold_touched();
        if largest.0 >= force {
            return Err(Error::input(
                "touch force",
                format!("{force} N"),
                format!("more than the {:.6} N where the patch is", largest.0),
            ));
        }
        let strokes = (0..self.patch.n_taxels()).map(|t| self.patch.taxels().at(t).stroke);
        let step = Self::STEP * strokes.fold(f64::INFINITY, f64::min);
        let n_steps = ((end - start) / step).ceil().clamp(1.0, MOST_STEPS) as usize;
        let mut low = start;
        for k in 1..=n_steps {
            let high = start + (end - start) * (k as f64 / n_steps as f64);
            let carried = self.sample(high).value;
            if carried >= force {
                return Ok(Some([low, high]));
            }
            if carried > largest.0 {
                largest = (carried, high);
            }
            low = high;
            self.workspace.hold_touched();
        }
        if largest.0 == 0.0 {
            return Ok(None);
        }
        let where_to = format!("the patch has gone {:.3} mm", 1e3 * largest.1);
        Err(too_much(force, largest.0, &where_to))
    }

    /// Presses after a travel.
    pub fn press(&mut self, travel: f64) -> SkinContact {
        self.after(travel, |way, poses| {
            press_skin(way.patch, way.objects, poses, way.workspace)
        })
    }

    /// The deflections alone after a travel.
    pub fn deflect(&mut self, travel: f64) {
        self.after(travel, |way, poses| {
            deflect_skin(way.patch, way.objects, poses, way.workspace);
        })
    }

    /// Does something with the objects' poses after a travel. The patch's travel is the objects' the other way.
    fn after<T>(&mut self, travel: f64, act: impl FnOnce(&mut Self, &[Pose]) -> T) -> T {
        let mut poses = std::mem::take(&mut self.workspace.poses);
        poses.clear();
        let back = -travel * self.direction;
        poses.extend(self.patch_from_objects.iter().map(|pose| Pose {
            translation: pose.translation + back,
            ..*pose
        }));
        let done = act(self, &poses);
        self.workspace.poses = poses;
        done
    }

    fn sample(&mut self, travel: f64) -> Sample {
        self.press(travel);
        self.sample_of_last()
    }

    /// Σ k δ in N, and its slope over the travel in N/m.
    fn sample_of_last(&self) -> Sample {
        let contacts = self.workspace.contacts();
        let slopes = contacts.iter().map(|contact| {
            let taxel: &Taxel = self.patch.taxels().at(contact.taxel);
            let rises = -contact.gradient().dot(self.direction);
            match contact.is_saturated(taxel) {
                true => 0.0,
                false => taxel.stiffness * rises,
            }
        });
        Sample {
            slope: slopes.sum(),
            value: spring_load(self.patch, contacts).spring_force,
        }
    }
}
