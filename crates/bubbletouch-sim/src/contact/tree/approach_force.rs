//! A patch of any layout moved along a line until it feels a force.

use super::approach::Approach;
use super::path::{ApproachPath, meeting};
use crate::contact::force_goal::{FORCE_ACCURACY, unreachable_force};
use crate::contact::root_search::{Sample, crossing};
use crate::contact::spring_load::sample;
use crate::contact::{Contact, Workspace};
use crate::error::Result;
use crate::geometry::Pose;
use crate::objects::Model;
use crate::text::in_range::positive;

impl Approach<'_> {
    /// Goes on until the springs carry `force` newtons together, Σ k δ: to within 1e-12 of it, or to the last bit of the travel.
    ///
    /// `patch_from_objects`: where the objects are before, one an object. `None` where the way misses all of them (the workspace then
    /// holds the last press on it). Taxels of a curved skin come and go along the way: the first travel with this force that steps of
    /// half a stroke find is named. Where the force jumps past it (an edge that comes upon a taxel from the side), the
    /// upper side of the jump is. What pushes a taxel goes on pushing it behind the substrate: nothing passes through the skin.
    ///
    /// # Errors
    /// A force that is not a positive number; one that is not reached on the way past the objects: the text says the largest one and
    /// its travel.
    ///
    /// # Panics
    /// If there are not as many poses as objects.
    pub fn press_to_force(
        &self,
        objects: &[Model],
        patch_from_objects: &[Pose],
        force: f64,
        workspace: &mut Workspace,
    ) -> Result<Option<Contact>> {
        positive("touch force", force, "N")?;
        workspace.hold([]);
        let mut path = self.path(objects, patch_from_objects, workspace);
        let pressed = path.go(force);
        workspace.hold([]);
        pressed
    }
}

impl ApproachPath<'_> {
    /// Goes on until the force is felt.
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

    /// Two travels, with less than the force at the first and not less at the second; `None` if nothing is touched.
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

    /// Σ k δ in N, and its slope over the travel in N/m.
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
