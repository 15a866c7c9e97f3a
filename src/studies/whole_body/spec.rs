//! Specification of a whole-body study: the keys of its TOML file.

use crate::files::FilePath;
use crate::inputs::defaults::{count, number};
use crate::sensing::Ensemble;
use crate::study_file::study_file;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

study_file! {
pub struct WholeBodyStudySpec {
    /// All settings of the study.
    pub whole_body: WholeBodySpec,
} }

/// `[whole_body]`: a robot covered with skin, its scenes, and the measurement of computing time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WholeBodySpec {
    /// URDF file of the covered robot, relative to the study file.
    pub robot: FilePath,
    /// Distance between taxels, mm.
    #[serde(default = "number::<1>")]
    pub pitch_mm: f64,
    /// Approximate side length of a patch, mm.
    #[serde(default = "number::<100>")]
    pub patch_mm: f64,
    /// Whether the flat ends of cylinders are covered, too.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub flat_ends: bool,
    /// Taxel radius ρ, mm. Default: half the pitch.
    pub taxel_radius_mm: Option<f64>,
    /// Stroke s, mm.
    #[serde(default = "number::<2>")]
    pub stroke_mm: f64,
    /// Stiffness k, N/m.
    #[serde(default = "number::<100>")]
    pub stiffness_n_per_m: f64,
    /// Damping c, N·s/m.
    #[serde(default)]
    pub damping_n_s_per_m: f64,
    /// Duration of a step, ms.
    #[serde(default = "number::<1>")]
    pub step_ms: f64,
    /// Number of measured steps for each scene and each size of a scaling series.
    #[serde(default = "count::<1000>")]
    pub steps: usize,
    /// Largest distance between an object's spheres and its surface, mm.
    #[serde(default = "default_surface_error_mm")]
    pub surface_error_mm: f64,
    /// Simulated scenes.
    pub scenes: Vec<BodySceneSpec>,
    /// Compression of the readings of touched taxels into measurements.
    pub sensing: BodySensingSpec,
    /// Recognised objects and their touches.
    pub recognition: BodyRecognitionSpec,
    /// Sizes for the measurement of computing time. Default: none.
    pub ladders: Option<LaddersSpec>,
}

/// `[[whole_body.scenes]]`: an object that moves along a path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodySceneSpec {
    /// Name of the scene.
    pub name: String,
    /// Name of a built-in object, with the centre of its bounding box at its origin; replaces `parts`.
    pub object: Option<String>,
    /// Parts of the object, in its own frame.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<BodyPartSpec>,
    /// Link in whose frame the object is placed and moves.
    pub link: String,
    /// Position of the object's origin, mm; with `depth_mm`, the target of its approach.
    #[serde(default)]
    pub at_mm: [f64; 3],
    /// Orientation of the object: roll, pitch, yaw about the link's axes, degrees.
    #[serde(default, alias = "rotation_deg")]
    pub turn_deg: [f64; 3],
    /// With `depth_mm`: direction from `at_mm` to the start of the approach.
    #[serde(default = "default_from")]
    pub from: [f64; 3],
    /// Travel past first contact, mm. Without this key, the object is placed at `at_mm`.
    pub depth_mm: Option<f64>,
    /// Amplitude of a sinusoidal translation, mm.
    #[serde(default)]
    pub moves_mm: [f64; 3],
    /// Amplitude of a sinusoidal rotation about the link's z axis, degrees; in phase with `moves_mm`.
    #[serde(default)]
    pub swing_deg: f64,
    /// Period of the sinusoidal motion, ms.
    #[serde(default = "number::<1000>")]
    pub period_ms: f64,
    /// Joint angles by joint name, degrees; all other joints are at zero.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub posture_deg: BTreeMap<String, f64>,
}

/// Part of an object.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum BodyPartSpec {
    /// Ball.
    Ball {
        /// Diameter, mm.
        diameter_mm: f64,
        /// Centre, mm.
        #[serde(default)]
        at_mm: [f64; 3],
    },
    /// Cylinder about z with a hemisphere on each end.
    Capsule {
        /// Diameter, mm.
        diameter_mm: f64,
        /// Length along z including both hemispheres, mm.
        length_mm: f64,
        /// Centre, mm.
        #[serde(default)]
        at_mm: [f64; 3],
    },
    /// Torus about z, such as arms around the robot.
    Torus {
        /// Diameter of the centre line of the tube, mm.
        ring_diameter_mm: f64,
        /// Diameter of the tube, mm.
        tube_diameter_mm: f64,
        /// Centre, mm.
        #[serde(default)]
        at_mm: [f64; 3],
    },
}

/// `[whole_body.sensing]`: compression of the touched taxels into measurements.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodySensingSpec {
    /// Number of measurements per frame.
    pub measurements: usize,
    /// Ensembles with sparse matrices: `sbhe` and `sparse`.
    pub ensembles: Vec<Ensemble>,
    /// Numbers of taxels in a Hadamard block, powers of two; each gives a compression of its own.
    #[serde(default = "default_blocks")]
    pub sbhe_blocks: Vec<usize>,
}

/// `[whole_body.recognition]`: touches of built-in objects at one location.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyRecognitionSpec {
    /// Names of built-in objects.
    pub objects: Vec<String>,
    /// Link in whose frame the objects are placed.
    pub link: String,
    /// Target of the approach, mm.
    pub at_mm: [f64; 3],
    /// Direction from the target to the start of the approach.
    #[serde(default = "default_from")]
    pub from: [f64; 3],
    /// Largest random offset from the target across the approach, mm.
    #[serde(default)]
    pub offset_mm: f64,
    /// Largest random rotation about the link's z axis, degrees.
    #[serde(default)]
    pub yaw_deg: f64,
    /// Range of the random travel past first contact, mm.
    pub depth_mm: [f64; 2],
    /// Number of training touches of each object.
    pub training_touches: usize,
    /// Number of test touches of each object.
    pub test_touches: usize,
}

/// `[whole_body.ladders]`: series of growing skins, touches and objects for the measurement of computing time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LaddersSpec {
    /// Numbers of taxels in the series of growing skins.
    pub taxels: Vec<usize>,
    /// Approximate numbers of touched taxels for each of these skins, if the skin is large enough.
    pub touched_at_taxels: Vec<usize>,
    /// Approximate numbers of touched taxels in the series of growing touches.
    pub touched: Vec<usize>,
    /// Numbers of spheres in the series of growing objects, half of them on the far side. The first number is used in the other series.
    pub spheres: Vec<usize>,
    /// Approximate number of touched taxels in the series of growing objects.
    pub touched_at_spheres: usize,
    /// Number of taxels of the skin in the series of growing touches and objects.
    pub taxels_at_touch: usize,
}

impl BodyRecognitionSpec {
    /// Returns the number of touches of each object.
    pub fn of_each(&self) -> usize {
        self.training_touches + self.test_touches
    }

    /// Returns the number of touches of all objects.
    pub fn n_touches(&self) -> usize {
        self.objects.len() * self.of_each()
    }
}

fn default_surface_error_mm() -> f64 {
    0.25
}

fn default_from() -> [f64; 3] {
    [1.0, 0.0, 0.0]
}

fn default_blocks() -> Vec<usize> {
    vec![32]
}
