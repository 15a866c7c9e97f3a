//! Simulation of one touch: an array is pressed on an object and slides along it.

use crate::contact::{Approach, Contact, FrictionState, Workspace, press_to_depth};
use crate::geometry::Pose;
use crate::objects::Model;
use crate::studies::recognition::plan::sensed::Sensed;
use crate::studies::recognition::plan::taxel_array::TaxelArray;
use crate::world::Shears;
use bubbletouch_sim::frame_coding::round_to_single;
use glam::{DVec2, DVec3};

/// Memory that a thread reuses for every touch that it simulates.
#[derive(Debug, Default)]
pub struct ArrayWorkspace {
    press: Workspace,
    /// Friction state of the array's taxels; `None` if the array has no friction.
    friction: Option<FrictionState>,
}

impl ArrayWorkspace {
    /// Returns the force vector on each taxel in the last touch, newtons; empty if the array does not read shear forces.
    pub fn shear_forces(&self) -> &[DVec3] {
        let friction = self.friction.as_ref();
        friction.map_or(&[], FrictionState::force3)
    }
}

/// Array that is prepared for touches of one object.
pub struct ArrayPress<'a> {
    array: &'a TaxelArray,
    object: [Model; 1],
}

impl TaxelArray {
    /// Prepares the array for touches of one object.
    pub fn press<'a>(&'a self, object: &Model) -> ArrayPress<'a> {
        ArrayPress {
            array: self,
            object: [object.clone()],
        }
    }
}

/// Reason why a press of a study cannot fail.
const CHECKED: &str = "the plan has checked poses and depths";

impl ArrayPress<'_> {
    /// Presses the array by a distance past first contact, metres, and then slides it along the object. Only the first part of this path is simulated; `part`
    /// is its fraction of the whole path. Returns `None` if the path misses the object.
    ///
    /// # Panics
    /// If a number of the pose or of the depth is not finite; the plan of a study has checked them.
    pub fn touch(
        &self,
        pose: Pose,
        (depth, part): (f64, f64),
        workspace: &mut ArrayWorkspace,
    ) -> Option<Contact> {
        let (patch, slide) = (self.array.patch(), self.array.slide());
        let way = part * (depth + slide.length());
        let ArrayWorkspace { press, friction } = workspace;
        if let Sensed::Shear(shear) = *self.array.sensed() {
            let at_rest = || FrictionState::at_rest(patch, Shears::Equal(shear));
            friction.get_or_insert_with(|| at_rest().expect("checked shear springs"));
        } else if slide == DVec2::ZERO {
            return press_to_depth(patch, &self.object, &[pose], way, press).expect(CHECKED);
        }
        let slid = (way - depth).max(0.0) * slide.normalize_or_zero();
        let motion = (way.min(depth), slid.extend(0.0));
        let approach = Approach::new(patch, DVec3::Z).expect("an axis has length one");
        let pressed =
            approach.press_and_slide(&self.object, &[pose], motion, friction.as_mut(), press);
        pressed.expect(CHECKED)
    }

    /// Returns the pose of the object, in the patch frame, at the end of a touch that starts at `pose`.
    pub fn end(&self, mut pose: Pose, contact: Option<Contact>) -> Pose {
        if let Some(contact) = contact {
            pose.translation -= self.array.slide().extend(contact.travel);
        }
        pose
    }

    /// Returns the number of values that are read per frame of a touch: deflections and shear forces of all taxels.
    pub fn n_values(&self) -> usize {
        self.array.n_values()
    }

    /// Writes the readings of the last touch in f32: [`n_values`](TaxelArray::n_values) deflections in metres, then the shear forces (if read) in newtons.
    pub fn write_values(&self, workspace: &ArrayWorkspace, out: &mut [f32]) {
        let (deflections, shear) = out.split_at_mut(self.array.patch().n_taxels());
        round_to_single(workspace.press.deflections(), deflections);
        if let Some(forces) = &workspace.friction {
            forces.write_lateral(shear);
        }
    }
}
