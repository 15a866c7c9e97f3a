//! A study of a whole body as it is written.

use crate::files::FilePath;
use crate::inputs::defaults::{count, number};
use crate::sensing::Ensemble;
use crate::study_file::study_file;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

study_file! {
pub struct WholeBodyStudySpec {
    /// Everything else.
    pub whole_body: WholeBodySpec,
} }

/// `[whole_body]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WholeBodySpec {
    /// The URDF file of what is covered, beside the study's own.
    pub robot: FilePath,
    /// Distance between taxels, mm.
    #[serde(default = "number::<1>")]
    pub pitch_mm: f64,
    /// Side of a patch, about, mm.
    #[serde(default = "number::<100>")]
    pub patch_mm: f64,
    /// Whether flat ends of cylinders are covered, too.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub flat_ends: bool,
    /// ρ, mm; half the pitch when left out.
    pub taxel_radius_mm: Option<f64>,
    /// s, mm.
    #[serde(default = "number::<2>")]
    pub stroke_mm: f64,
    /// k, N/m.
    #[serde(default = "number::<100>")]
    pub stiffness_n_per_m: f64,
    /// c, N·s/m.
    #[serde(default)]
    pub damping_n_s_per_m: f64,
    /// Length of a step, ms.
    #[serde(default = "number::<1>")]
    pub step_ms: f64,
    /// Steps that are measured of each scene and rung.
    #[serde(default = "count::<1000>")]
    pub steps: usize,
    /// How far the spheres of an object may be from its surface, mm.
    #[serde(default = "default_surface_error_mm")]
    pub surface_error_mm: f64,
    /// What happens to the robot.
    pub scenes: Vec<BodySceneSpec>,
    /// How what is touched is compressed.
    pub sensing: BodySensingSpec,
    /// What is recognised.
    pub recognition: BodyRecognitionSpec,
    /// What a step costs by size; nothing of it when left out.
    pub ladders: Option<LaddersSpec>,
}

/// `[[whole_body.scenes]]`: an object that goes along a path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodySceneSpec {
    /// What the scene is called.
    pub name: String,
    /// A built-in object, its box about its own origin; or `parts`.
    pub object: Option<String>,
    /// What the object is made of, in its own frame.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<BodyPartSpec>,
    /// The link in whose frame the object is placed and moves.
    pub link: String,
    /// Where the object's origin is, mm; with `depth_mm`, where it aims.
    #[serde(default)]
    pub at_mm: [f64; 3],
    /// How it is turned: roll, pitch, yaw about the link's axes, degrees.
    #[serde(default, alias = "rotation_deg")]
    pub turn_deg: [f64; 3],
    /// With `depth_mm`: from where it comes to `at_mm`, a direction.
    #[serde(default = "default_from")]
    pub from: [f64; 3],
    /// How far it goes past first contact, mm. When left out, it is at `at_mm` itself.
    pub depth_mm: Option<f64>,
    /// To and fro by so much, mm, as a sine of the period.
    #[serde(default)]
    pub moves_mm: [f64; 3],
    /// To and fro about the link's z axis by so much, degrees, as the same sine.
    #[serde(default)]
    pub swing_deg: f64,
    /// Period of the sine, ms.
    #[serde(default = "number::<1000>")]
    pub period_ms: f64,
    /// Joints that are not at zero, degrees by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub posture_deg: BTreeMap<String, f64>,
}

/// A part of an object.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum BodyPartSpec {
    /// A ball.
    Ball {
        /// Its diameter, mm.
        diameter_mm: f64,
        /// Its middle, mm.
        #[serde(default)]
        at_mm: [f64; 3],
    },
    /// A cylinder about z with a half ball on each end.
    Capsule {
        /// Its diameter, mm.
        diameter_mm: f64,
        /// Along z, both half balls included, mm.
        length_mm: f64,
        /// Its middle, mm.
        #[serde(default)]
        at_mm: [f64; 3],
    },
    /// A torus about z: arms that close.
    Torus {
        /// Of the circle in the middle of the tube, mm.
        ring_diameter_mm: f64,
        /// Of the tube, mm.
        tube_diameter_mm: f64,
        /// Its middle, mm.
        #[serde(default)]
        at_mm: [f64; 3],
    },
}

/// `[whole_body.sensing]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodySensingSpec {
    /// Measurements a frame.
    pub measurements: usize,
    /// How they are made: `sbhe` and `sparse`, whose entries are few.
    pub ensembles: Vec<Ensemble>,
    /// Taxels of a Hadamard block, powers of two; each is a compression of its own.
    #[serde(default = "default_blocks")]
    pub sbhe_blocks: Vec<usize>,
}

/// `[whole_body.recognition]`: touches of built-in objects at one place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyRecognitionSpec {
    /// Built-in objects.
    pub objects: Vec<String>,
    /// The link in whose frame they are placed.
    pub link: String,
    /// Where they aim, mm.
    pub at_mm: [f64; 3],
    /// From where they come, a direction.
    #[serde(default = "default_from")]
    pub from: [f64; 3],
    /// They miss by up to so much either way across, mm.
    #[serde(default)]
    pub offset_mm: f64,
    /// They are turned about the link's z axis by up to so much either way, degrees.
    #[serde(default)]
    pub yaw_deg: f64,
    /// They go between these past first contact, mm.
    pub depth_mm: [f64; 2],
    /// Touches of each object that train.
    pub training_touches: usize,
    /// Touches of each object that test.
    pub test_touches: usize,
}

/// `[whole_body.ladders]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LaddersSpec {
    /// Rungs of the skin, taxels.
    pub taxels: Vec<usize>,
    /// On each of them, but for those that have no room for it: taxels touched, about.
    pub touched_at_taxels: Vec<usize>,
    /// Rungs of the touch, taxels, about.
    pub touched: Vec<usize>,
    /// Rungs of the object, spheres; the first makes the cushion of the other ladders; half are on its far side.
    pub spheres: Vec<usize>,
    /// Taxels touched on the rungs of the object, about.
    pub touched_at_spheres: usize,
    /// Taxels of the skin on the rungs of the touch and of the object.
    pub taxels_at_touch: usize,
}

impl BodyRecognitionSpec {
    /// Touches of each object.
    pub fn of_each(&self) -> usize {
        self.training_touches + self.test_touches
    }

    /// Touches of all objects.
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
