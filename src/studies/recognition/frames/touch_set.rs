//! What a recognition study asks of its touches: of pressed objects, of human touches, or of recorded frames.

use crate::engine::progress::Progress;
use crate::error::Result;
use crate::learning::data::split::Side;
use crate::random::Seed;
use crate::report::pictures::snapshots::Snapshots;
use crate::studies::recognition::frames::kept::Frames;
use crate::studies::recognition::frames::reading::TouchToRead;
use crate::studies::recognition::plan::group::Group;
use crate::studies::recognition::plan::pose_groups::KeepTogether;
use crate::studies::recognition::plan::study_plan::Plan;
use crate::studies::recognition::plan::taxel_array::TaxelArray;
use crate::studies::recognition::touches::drawn_touches::touch_labels;
use crate::world::Touch;
use ndarray::Array1;

/// Touches of several classes: objects, kinds of touch, or what a recording calls them. They follow each other class by class.
pub trait TouchSet: Sync {
    /// Name of every class, by its label, and how many touches it has.
    fn classes(&self) -> Vec<(&str, usize)>;

    /// Name of every class, by its label.
    fn class_names(&self) -> Vec<&str> {
        self.classes().into_iter().map(|(name, _)| name).collect()
    }

    /// Label of every touch.
    fn labels(&self) -> Array1<usize> {
        touch_labels(&self.classes())
    }

    /// Group of every touch, for splits that keep groups together: its own, where touches share nothing.
    ///
    /// # Errors
    /// An axis that is spread uniformly, without a distance.
    fn group_keys(&self, _together: &KeepTogether) -> Result<Array1<usize>> {
        Ok((0..self.labels().len()).collect())
    }

    /// Where and how every touch is made; of none that is not placed.
    fn poses(&self) -> Vec<&Touch> {
        Vec::new()
    }

    /// Group of every touch, where they are what they are and no key says what stays together.
    fn own_groups(&self) -> Option<Array1<usize>> {
        None
    }

    /// On which side of every split each touch is, where a test set is given.
    fn given_sides(&self) -> Option<&[Side]> {
        None
    }

    /// Taxels without readings, and all taxels.
    fn n_masked(&self) -> (usize, usize) {
        (0, 0)
    }

    /// Makes what all touches need on all threads now; the first touches would make it one after the other.
    fn prepare(&self) {}

    /// Makes all touches on an array, F frames each; the same bytes at any number of threads.
    fn simulate(&self, on: (&TaxelArray, usize), progress: &dyn Progress) -> Frames;

    /// How each touch is read in a trial, F frames each, whose randomness is drawn from `seed`: pressed objects at a speed (m/s, 0 at rest), each after
    /// another touch that is drawn at random.
    fn to_read(&self, speed: f64, n_frames: usize, seed: &Seed) -> Vec<TouchToRead>;

    /// A few touches for the eye.
    ///
    /// # Errors
    /// What is shown cannot be made.
    fn samples(&self, plan: &Plan, groups: &[Group]) -> Result<Samples>;

    /// How many of them go deeper (metres past first contact) than a stroke.
    fn n_deeper_than(&self, _stroke: f64) -> usize {
        0
    }

    /// What a report says about them: name and value.
    fn settings(&self) -> Vec<(String, String)>;
}

/// First touches of a study's objects.
#[derive(Clone, Debug)]
pub struct Samples {
    /// What its picture shows.
    pub shown: Snapshots,
    /// One touch of each object; none where touches are of a hand.
    pub each: Option<Snapshots>,
}
