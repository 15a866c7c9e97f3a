//! Press of a patch with any layout: at its pose, or along a line, divided into steps.

use super::first_contact::first_contact;
use super::press;
use crate::contact::force_goal::{FORCE_ACCURACY, unreachable_force};
use crate::contact::root_search::{Sample, crossing};
use crate::contact::spring_load::sample;
use crate::contact::{Contact, FrictionState, NormalForce, Press, Record, Until, Workspace};
use crate::error::Result;
use crate::geometry::Pose;
use crate::objects::Sphere;
use crate::world::{Patch, Taxel, Travelling};
use glam::DVec3;
use std::borrow::Cow;

/// Length of a step along the path, relative to the shortest stroke of a taxel. If larger, a short peak of the force may be missed, and small spheres may
/// pass through; if smaller, presses are wasted.
const STEP: f64 = 0.5;
/// Length of a step with friction, relative to the smallest radius of a taxel. If larger, taxels that come into contact within a step are dragged too little.
/// If smaller, more presses change the shear by at most one per cent.
const FRICTION_STEP: f64 = 0.25;
/// Maximum number of steps along a path. If strokes are far shorter than the path, the steps become longer.
const MAX_STEPS: f64 = 4096.0;

/// Press of a patch along a direction, with the scratch memory of its steps.
pub(crate) struct Path<'a> {
    press: &'a Press<'a>,
    workspace: &'a mut Workspace,
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

impl<'a> Path<'a> {
    /// Creates the path of a press whose numbers have been checked.
    pub fn new(press: &'a Press, workspace: &'a mut Workspace) -> Self {
        Self { press, workspace }
    }

    /// Presses the patch until the condition of the press is met. Returns `None` if the path misses all objects.
    pub fn run(&mut self) -> Result<Option<Contact>> {
        let Press { until, record, .. } = *self.press;
        match until {
            Until::Pose => return Ok(Some(self.at(DVec3::ZERO, record))),
            Until::Force(force) => return self.until_force(force),
            Until::Depth(_) | Until::Travel(_) => {}
        }
        let travelling = self.travelling();
        if let (Until::Travel(travel), true) = (until, travelling.is_flat) {
            return Ok(Some(self.through(&travelling, travel)));
        }
        let travels = self.travels()?;
        Ok(match travels {
            Some([_, travel]) if travelling.is_flat => Some(self.through(&travelling, travel)),
            _ => self.steps(travels, DVec3::ZERO, None),
        })
    }

    /// Returns the copy of the patch's taxels whose axes are replaced by the direction of travel.
    fn travelling(&self) -> Cow<'a, Travelling> {
        match self.press.along == DVec3::Z {
            true => Cow::Borrowed(self.press.patch.ahead()),
            false => Cow::Owned(Travelling::new(self.press.patch, self.press.along)),
        }
    }

    /// Returns the travels at first contact and at the end of the path, metres. Returns `None` if no taxel is touched.
    pub fn travels(&mut self) -> Result<Option<[f64; 2]>> {
        let until = match self.press.until {
            Until::Pose => return Ok(Some([0.0; 2])),
            Until::Force(force) => match self.until_force(force)? {
                Some(contact) => Until::Travel(contact.travel),
                None => return Ok(None),
            },
            until => until,
        };
        let first = first_contact(self.press, &self.travelling(), self.workspace);
        let travels = first.map(|first| [first, until.limit(first)]);
        let is_ahead = |[first, end]: &[f64; 2]| first < end || matches!(until, Until::Depth(_));
        Ok(travels.filter(is_ahead))
    }

    /// Returns the number of steps with friction for a part of the path with this `length`, metres.
    pub fn n_friction_steps(&self, length: f64) -> usize {
        let step = FRICTION_STEP * self.press.patch.least(|taxel| taxel.radius);
        // Rounding of the length must not add a step.
        let n_steps = (length / step * (1.0 - 1e-9)).ceil();
        let n_steps = n_steps.clamp(1.0, MAX_STEPS) as usize;
        n_steps.max(self.press.patch.n_steps(length))
    }

    /// Presses after the patch has moved by a vector (metres, in the patch frame), computed as the opposite motion of the objects.
    fn at(&mut self, moved: DVec3, record: Record) -> Contact {
        let Press { patch, objects, .. } = *self.press;
        let poses = self.moved_poses(moved);
        let contact = press::press(patch, (objects, &poses), record, self.workspace);
        self.workspace.poses = poses;
        contact
    }

    /// Presses a flat patch along its axis from the front, using taxels whose axes are the direction of travel.
    fn through(&mut self, travelling: &Travelling, travel: f64) -> Contact {
        let Press {
            patch,
            objects,
            along,
            record,
            ..
        } = *self.press;
        let poses = self.moved_poses(travel * along);
        let placed = (objects, &poses[..]);
        press::push_tree(&travelling.taxels, patch.n_taxels(), placed, self.workspace);
        let contact = press::limit(patch, placed, record, self.workspace);
        self.workspace.poses = poses;
        Contact { travel, ..contact }
    }

    /// Returns the poses of the objects after the patch has moved by a vector, metres, in memory of the workspace.
    fn moved_poses(&mut self, moved: DVec3) -> Vec<Pose> {
        let mut poses = std::mem::take(&mut self.workspace.poses);
        poses.clear();
        poses.extend(self.press.poses.iter().map(|pose| Pose {
            translation: pose.translation - moved,
            ..*pose
        }));
        poses
    }

    /// Presses the patch from one travel to another and then slides it along a straight line; `None` if the patch meets nothing.
    pub fn steps(
        &mut self,
        travels: Option<[f64; 2]>,
        slide: DVec3,
        mut friction: Option<&mut FrictionState>,
    ) -> Option<Contact> {
        let Press {
            patch,
            along,
            record,
            ..
        } = *self.press;
        self.workspace.hold([]);
        if let Some(friction) = &mut friction {
            friction.step(patch, &[], &[], NormalForce::Springs);
        }
        let Some([first, travel]) = travels else {
            press::press(patch, (&[], &[]), record, self.workspace);
            return None;
        };
        let n_steps = |length| match friction {
            Some(_) => self.n_friction_steps(length),
            None => patch.n_steps(length),
        };
        let depth = travel - first;
        let pressed = parts([first, travel], n_steps(depth)).map(|part| part * along);
        let length = slide.length();
        let n_slides = if length > 0.0 { n_steps(length) } else { 0 };
        let slid = parts([0.0, 1.0], n_slides).map(|part| travel * along + part * slide);
        let mut contact = Contact::default();
        let mut places = pressed.chain(slid).peekable();
        while let Some(place) = places.next() {
            let is_last = places.peek().is_none();
            let record = match is_last || friction.is_some() {
                true => record,
                false => Record::Deflections,
            };
            contact = self.at(place, record);
            if !is_last {
                self.workspace.hold_touched();
            }
            if let Some(friction) = &mut friction {
                let (contacts, poses) = (self.workspace.contacts(), &self.workspace.poses);
                friction.step(patch, contacts, poses, NormalForce::Springs);
            }
        }
        self.workspace.hold([]);
        Some(Contact { travel, ..contact })
    }

    /// Increases the travel until the springs carry `force` newtons, and records the contacts; returns `None` if the path misses all objects.
    fn until_force(&mut self, force: f64) -> Result<Option<Contact>> {
        self.workspace.hold([]);
        let travel = self.travel_to_force(force);
        let contact = travel.map(|travel| {
            let contact = self.at(travel.unwrap_or(0.0) * self.press.along, Record::Contacts);
            travel.map(|travel| Contact { travel, ..contact })
        });
        self.workspace.hold([]);
        contact
    }

    fn travel_to_force(&mut self, force: f64) -> Result<Option<f64>> {
        let Some(ends) = meeting(self.press) else {
            return Ok(None);
        };
        let bracket = self.bracket(ends, force)?;
        Ok(bracket.map(|bracket| {
            let tolerance = FORCE_ACCURACY * force;
            crossing(bracket, (force, tolerance), |travel| self.sample(travel))
        }))
    }

    /// Returns two travels, metres, between which the springs reach `force`: smaller at the first, not smaller at the second. Returns `None` if nothing is
    /// touched.
    fn bracket(&mut self, [start, end]: [f64; 2], force: f64) -> Result<Option<[f64; 2]>> {
        let mut largest = (0.0, start);
        let n_steps = self.press.patch.n_steps(end - start);
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
        Err(unreachable_force(force, largest.0, &where_to))
    }

    /// Returns the total spring force at a travel, N, and its derivative with respect to the travel, N/m.
    fn sample(&mut self, travel: f64) -> Sample {
        let Press { patch, along, .. } = *self.press;
        self.at(travel * along, Record::Contacts);
        sample(patch, self.workspace.contacts(), -along, |_| true)
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
pub(super) fn meeting(press: &Press) -> Option<[f64; 2]> {
    let ball = press.patch.tree().ball()?;
    let pairs = press.objects.iter().zip(press.poses);
    let meetings = pairs.filter_map(|(object, pose)| {
        let met = Sphere::around(&object.bounds()).placed(pose);
        let (away, reach) = (met.center - ball.center, ball.radius + met.radius);
        let ahead = away.dot(press.along);
        let half2 = reach * reach - away.cross(press.along).length_squared();
        (half2 > 0.0).then(|| [ahead - half2.sqrt(), ahead + half2.sqrt()])
    });
    meetings.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
}
