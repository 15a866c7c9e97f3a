//! Approach of a patch with any layout along a line to a given force.

use super::approach::Approach;
use super::path::{ApproachPath, meeting};
use crate::contact::force_goal::{FORCE_ACCURACY, unreachable_force};
use crate::contact::root_search::{Sample, crossing};
use crate::contact::spring_load::sample;
use crate::contact::{Contact, Goal, Workspace};
use crate::error::Result;
use crate::geometry::{Pose, check_poses};
use crate::objects::Model;

impl Approach<'_> {
    /// Presses the patch until the sum of all spring forces equals `force` newtons. The relative error is at most 1e-12, or what rounding of the travel
    /// causes.
    ///
    /// `patch_from_objects` contains the objects' poses before the motion, one per object. Returns `None` if the path misses all objects; the workspace
    /// then contains the last press on the path. On a curved skin several travels can have this force; the first travel found by steps of half a stroke is
    /// returned. The total force can jump past `force` if an edge meets a taxel from the side. The side of the jump with the larger force is then returned.
    /// A part of an object that pushes a taxel continues to push this taxel even from behind the substrate. No object can therefore pass through the skin.
    ///
    /// # Errors
    /// If `force` is not a positive number or is not reached on the path past the objects. The message contains the largest force and its travel. If the
    /// poses are invalid, as in [`press`](crate::contact::press()).
    pub fn press_to_force(
        &self,
        objects: &[Model],
        patch_from_objects: &[Pose],
        force: f64,
        workspace: &mut Workspace,
    ) -> Result<Option<Contact>> {
        check_poses("object", objects.len(), patch_from_objects)?;
        Goal::Force(force).check()?;
        self.to_force(objects, patch_from_objects, force, workspace)
    }

    /// Presses the patch as [`press_to_force`](Self::press_to_force) does, with numbers that have been checked.
    pub(crate) fn to_force(
        &self,
        objects: &[Model],
        patch_from_objects: &[Pose],
        force: f64,
        workspace: &mut Workspace,
    ) -> Result<Option<Contact>> {
        workspace.hold([]);
        let mut path = self.path(objects, patch_from_objects, workspace);
        let pressed = path.go(force);
        workspace.hold([]);
        pressed
    }
}

impl ApproachPath<'_> {
    /// Increases the travel until the springs carry `force` newtons; returns `None` if the path misses all objects.
    fn go(&mut self, force: f64) -> Result<Option<Contact>> {
        let ends = meeting(
            self.patch,
            self.objects,
            self.patch_from_objects,
            self.direction,
        );
        let Some(ends) = ends else {
            self.press(0.0);
            return Ok(None);
        };
        let Some([low, high]) = self.bracket(ends, force)? else {
            return Ok(None);
        };
        let travel = crossing([low, high], (force, FORCE_ACCURACY * force), |travel| {
            self.sample(travel)
        });
        Ok(Some(Contact {
            travel,
            ..self.press(travel)
        }))
    }

    /// Returns two travels, metres, between which the springs reach `force`: smaller at the first, not smaller at the second. Returns `None` if nothing is
    /// touched.
    fn bracket(&mut self, [start, end]: [f64; 2], force: f64) -> Result<Option<[f64; 2]>> {
        let mut largest = (0.0, start);
        let n_steps = self.patch.n_steps(end - start);
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
        self.press(travel);
        sample(
            self.patch,
            self.workspace.contacts(),
            -self.direction,
            |_| true,
        )
    }
}
