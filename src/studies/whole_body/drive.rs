//! Motion of an object over a robot's skin, and the search for its first contact.

use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::objects::SphereUnion;
use crate::studies::whole_body::plan::Aim;
use crate::whole_body::{BodyContact, BodyState, SphereClusters, WholeBody};
use crate::world::Oscillation;
use glam::DVec3;

/// Duration of a time step that is long enough for a damped taxel without contact to return to its rest position, seconds. The value is longer than any
/// relaxation.
pub(super) const FORGOTTEN: f64 = 1e9;
/// Distance that the object moves between two tests for contact in the search for the first contact, metres. Bisection then refines the contact to
/// `SEARCH_END`.
const SEARCH_STEP: f64 = 1e-3;
/// Width of the bisection interval at which the search for the first contact ends, metres.
const SEARCH_END: f64 = 1e-7;
/// Distance between the target and the point at which the search for the first contact starts, metres. The size of the object is added to it.
const SEARCH_START: f64 = 0.05;

/// Robot that is covered with skin, in a given posture, with the poses of its patches and links.
pub(super) struct Posture<'a> {
    pub body: &'a WholeBody,
    /// Pose of each patch in the world, `world_from_patch`.
    pub patches: Vec<Pose>,
    /// Pose of each link in the world, `world_from_link`.
    pub links: Vec<Pose>,
}

/// Motion of an object over the skin, in the frame of a robot link.
#[derive(Clone, Copy)]
pub(super) struct Path {
    /// Pose of the link in the world, `world_from_link`.
    pub world_from_link: Pose,
    /// Motion of the object in the frame of the link.
    pub motion: Oscillation,
}

impl Path {
    /// Returns the pose `world_from_object` at a time, seconds.
    pub fn at(&self, time: f64) -> Pose {
        self.world_from_link.compose(&self.motion.pose_at(time))
    }

    /// Returns the path with its start shifted by the vector `by`, metres, in the frame of the link.
    pub fn shifted(&self, by: DVec3) -> Self {
        let start = self.motion.start;
        self.starting_at(Pose::new(start.rotation, start.translation + by))
    }

    /// Returns a copy of the path with a different initial pose of the object, `link_from_object`.
    pub fn starting_at(&self, start: Pose) -> Self {
        Self {
            motion: Oscillation {
                start,
                ..self.motion
            },
            ..*self
        }
    }
}

/// Object that moves along a path over the skin of a robot.
pub(super) struct Drive<'a> {
    pub body: &'a WholeBody,
    pub state: BodyState,
    pub object: [SphereClusters; 1],
    pub path: Path,
}

impl<'a> Drive<'a> {
    pub fn new(posture: &Posture<'a>, object: &SphereUnion, aim: &Aim) -> Self {
        let mut state = BodyState::at_rest(posture.body);
        state.place(posture.body, &posture.patches);
        Self {
            body: posture.body,
            state,
            object: [SphereClusters::new(object)],
            path: Path {
                world_from_link: posture.links[aim.link],
                motion: aim.motion,
            },
        }
    }

    /// Presses the object against the undeformed skin at the start of a path.
    pub fn probe(&mut self, path: Path) -> BodyContact {
        let pose = [path.at(0.0)];
        self.state.press(self.body, &self.object, &pose, FORGOTTEN)
    }

    /// Returns the numbers of the taxels that the last press touched, and their deflections in metres.
    pub fn touched(&self) -> impl Iterator<Item = (usize, f64)> {
        self.state.touched(self.body)
    }

    /// Moves the start of the path in the direction of the unit vector `from`, away from the skin. At the new start, the object is `depth` metres past the
    /// first contact.
    pub fn approach(&mut self, from: DVec3, depth: f64) -> Result<()> {
        let reach = self.object[0].ball().radius + self.object[0].ball().center.length();
        let path = self.path;
        let mut is_touched = |away: f64| self.probe(path.shifted(away * from)).n_touched > 0;
        let mut outside = reach + SEARCH_START;
        while !is_touched(outside - SEARCH_STEP) {
            outside -= SEARCH_STEP;
            if outside < -reach {
                let allowed = "a place and a direction from which the object meets the skin";
                return Err(Error::input("approach", "no contact", allowed));
            }
        }
        let mut inside = outside - SEARCH_STEP;
        while outside - inside > SEARCH_END {
            let middle = 0.5 * (outside + inside);
            match is_touched(middle) {
                true => inside = middle,
                false => outside = middle,
            }
        }
        self.path = path.shifted((inside - depth) * from);
        Ok(())
    }
}
