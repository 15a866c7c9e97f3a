//! Common interface of sets of touches: pressed objects, human touches, or recorded frames.

use crate::learning::data::split::Side;
use crate::report::pictures::snapshots::Snapshots;
use crate::studies::prelude::*;
use crate::studies::recognition::frames::{Frames, TouchToRead};
use crate::studies::recognition::plan::KeepTogether;
use crate::studies::recognition::touches::touch_labels;
use bubbletouch_sim::frame_coding::most_bytes;
use ndarray::Array1;
use std::collections::BTreeMap;

/// Identity of a recording by the contents of its files. Files may move to another folder, or have other names.
#[derive(Clone, Debug)]
pub struct RecordedContent {
    /// SHA-256 hash of each file, by its key.
    pub hashes: BTreeMap<String, String>,
    /// Text that is equal exactly if all keys and the contents of all files are equal.
    pub identity: String,
}

/// Set of touches of several classes, ordered by class. A class is an object, a kind of human touch, or a label of a recording.
pub trait TouchSet: Sync {
    /// Returns the name and the number of touches of every class, in the order of the labels.
    fn classes(&self) -> Vec<(&str, usize)>;

    /// Returns the name of every class, in the order of the labels.
    fn class_names(&self) -> Vec<&str> {
        self.classes().into_iter().map(|(name, _)| name).collect()
    }

    /// Returns the name of every touch: its number, or its position in the recording, without spaces.
    fn touch_names(&self) -> Vec<String> {
        let numbers = 0..self.labels().len();
        numbers.map(|number| number.to_string()).collect()
    }

    /// Returns the class label of every touch.
    fn labels(&self) -> Array1<usize> {
        touch_labels(&self.classes())
    }

    /// Returns the group number of every touch; splits never divide the touches of a group. By default, each touch is its own group.
    ///
    /// # Errors
    /// If an axis is spread uniformly and has no distance.
    fn group_keys(&self, _together: &KeepTogether) -> Result<Array1<usize>> {
        Ok((0..self.labels().len()).collect())
    }

    /// Returns the pose of every touch, or an empty list if the touches have no poses.
    fn poses(&self) -> Vec<&Touch> {
        Vec::new()
    }

    /// Returns the group number of every touch; `None` if the data do not define groups.
    fn own_groups(&self) -> Option<Array1<usize>> {
        None
    }

    /// Returns the names of the groups by their numbers; empty if the numbers are the names.
    fn group_names(&self) -> &[String] {
        &[]
    }

    /// Returns the side (training or test) of every touch in a split if the data define a test set or splits, otherwise `None`.
    ///
    /// # Errors
    /// If the data define fewer splits.
    fn given_sides(&self, _split: usize) -> Result<Option<&[Side]>> {
        Ok(None)
    }

    /// Returns the contents of the files of a recording; `None` for simulated touches.
    fn recorded_content(&self) -> Option<&RecordedContent> {
        None
    }

    /// Returns the number of masked taxels (with too many missing readings) and the total number of taxels of a recorded skin; zeros for simulated touches.
    fn n_masked(&self) -> (usize, usize) {
        let absent = self.absent();
        (absent.iter().filter(|&&is| is).count(), absent.len())
    }

    /// Returns whether each taxel of a recorded skin is absent, that is, masked; empty for simulated touches.
    fn absent(&self) -> &[bool] {
        &[]
    }

    /// Computes data that all touches need, using all threads. Without this call, the first touches would compute the data one after the other.
    fn prepare(&self) {}

    /// Simulates all touches on an array with the given number of frames per touch; the result does not depend on the number of threads.
    fn simulate(&self, on: (&TaxelArray, usize), progress: &dyn Progress) -> Frames;

    /// Returns the mean size of an encoded frame on an array with the given number of frames per touch, bytes. The default is the largest possible size.
    fn frame_bytes(&self, (array, _): (&TaxelArray, usize)) -> f64 {
        most_bytes(array.n_values()) as f64
    }

    /// Returns the random seed, the timing and the preceding touch of each touch in a trial. All random numbers are derived from `seed`. Pressed objects are
    /// read at a speed (m/s, 0 at rest), each touch after another randomly drawn touch.
    fn to_read(&self, speed: f64, n_frames: usize, seed: &Seed) -> Vec<TouchToRead>;

    /// Returns the sample touches that the pictures of the study show, given at least one part of the study: its plan and its groups of configurations.
    ///
    /// # Errors
    /// If a picture cannot be made.
    fn samples(&self, parts: &[(&Plan, &[MeasurementGroup])]) -> Result<Samples>;

    /// Returns the number of touches that are deeper past first contact than the stroke of the taxels, metres.
    fn n_deeper_than(&self, _stroke: f64) -> usize {
        0
    }

    /// Returns pairs of the name and the value of each touch setting, for the report.
    fn settings(&self) -> Vec<(String, String)>;
}

/// Sample touches that the pictures of a study show.
#[derive(Clone, Debug)]
pub struct Samples {
    /// Frames of the touches that the sample picture shows.
    pub shown: Snapshots,
    /// Picture of the first touch of every object; `None` for human touches.
    pub each: Option<Snapshots>,
}
