//! A study of speed against accuracy as it is written.

use crate::files::FilePath;
use crate::recognition::ClassifierKind;
use crate::sensing::Ensemble;
use crate::study::spec::{ObjectsSpec, SkinSpec, TouchesSpec};
use crate::study_file::study_file;
use serde::{Deserialize, Serialize};

study_file! {
pub struct SpeedAccuracyStudySpec {
    /// What is touched: sets of solids, or closed meshes.
    pub objects: ObjectsSpec,
    /// What touches in the part on contact; the other parts take its stroke, and their own pitches.
    pub skin: SkinSpec,
    /// How it touches.
    pub touches: TouchesSpec,
    /// What is swept.
    pub speed_accuracy: SpeedAccuracySpec,
} }

/// `[speed_accuracy]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpeedAccuracySpec {
    /// How far spheres may be from an object's surface, mm: a level of detail each.
    pub tolerances_mm: Vec<f64>,
    /// Part: contact.
    pub contact: Option<ContactSpec>,
    /// Part: recognition.
    pub recognition: Option<RecognitionSweepSpec>,
}

/// `[speed_accuracy.contact]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactSpec {
    /// Objects, at most, spread evenly over the study's.
    pub objects: usize,
    /// Touches of each.
    pub touches: usize,
    /// Objects and touches of each by methods that step through time, which are slow.
    pub stepped_objects: usize,
    /// See `stepped_objects`.
    pub stepped_touches: usize,
    /// Time steps of those methods, ms.
    pub dt_ms: Vec<f64>,
    /// A table that other programs wrote (`benches/peers/contact.py`), beside the study's file; left out where it is not.
    pub peers: Option<FilePath>,
    /// Closed meshes that are touched beside the study's objects.
    pub scans: Option<ScansSpec>,
}

/// `[speed_accuracy.contact.scans]`: rows and points of their own in the part on contact, and in no other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScansSpec {
    /// A folder of PLY, OBJ or STL meshes in metres; left out, and said so, where it is not. `--objects` names another.
    pub meshes: FilePath,
    /// Those of the folder that are touched: file names without ending. (To pack a mesh takes from seconds to a minute.)
    pub names: Vec<String>,
}

/// `[speed_accuracy.recognition]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecognitionSweepSpec {
    /// Objects, at most, spread evenly over the study's.
    pub objects: usize,
    /// Between taxels, mm.
    pub pitch_mm: Vec<f64>,
    /// Side of the array, mm: a whole number of each pitch.
    pub size_mm: f64,
    /// Levels of detail, among `tolerances_mm`.
    pub tolerances_mm: Vec<f64>,
    /// How frames are compressed.
    pub ensemble: Vec<Ensemble>,
    /// Taxels per measurement.
    pub ratio: Vec<f64>,
    /// What learns, with the parameters of [`Classifier::new`](crate::recognition::classifiers::classifier::Classifier::new).
    pub classifier: Vec<ClassifierKind>,
    /// Standard deviation of the noise, as a share of the full scale.
    pub noise_std_full_scale: f64,
    /// Touches of each object that train.
    pub training_touches: usize,
    /// Further touches of each object that test.
    pub test_touches: usize,
    /// Touches whose way from contact to answer is timed.
    pub timed_touches: usize,
}

impl RecognitionSweepSpec {
    /// Touches of each object, those that test included.
    pub(super) fn n_touches(&self) -> usize {
        self.training_touches + self.test_touches
    }
}
