//! Specification of a whole-body study: the keys of its TOML file.

use crate::files::FilePath;
use crate::inputs::defaults::{count, number};
use crate::inputs::schema_types::Names;
use crate::scene::{JointsSpec, ObjectSpec};
use crate::sensing::Ensemble;
use crate::study_file::study_file;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

study_file! {
pub struct WholeBodyStudySpec {
    /// Table `[whole_body]`: all keys of the study.
    pub whole_body: WholeBodySpec,
} }

/// Keys of `[whole_body]`: a robot covered with skin, its scenes, and the measurement of computing time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WholeBodySpec {
    /// URDF file of the robot that is covered with skin, relative to the study file.
    #[schemars(with = "String")]
    pub robot: FilePath,
    /// Distance between neighbouring taxels, mm, positive. Default: 1.
    #[serde(default = "number::<1>")]
    pub pitch_mm: f64,
    /// Approximate side length of a patch, mm, positive. Default: 100.
    #[serde(default = "number::<100>")]
    pub patch_mm: f64,
    /// Whether the flat ends of cylinders are also covered with skin. Default: false.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub flat_ends: bool,
    /// Radius ρ of a taxel, mm, ρ > 0. Default: half the pitch.
    pub taxel_radius_mm: Option<f64>,
    /// Stroke s of a taxel, mm, positive: its maximum deflection. Default: 2.
    #[serde(default = "number::<2>")]
    pub stroke_mm: f64,
    /// Stiffness k of a taxel, N/m, positive. Default: 100.
    #[serde(default = "number::<100>")]
    pub stiffness_n_per_m: f64,
    /// Damping coefficient c of a taxel, N·s/m, at least 0. Default: 0.
    #[serde(default)]
    pub damping_n_s_per_m: f64,
    /// Duration of a simulated step, ms, positive. Default: 1.
    #[serde(default = "number::<1>")]
    pub step_ms: f64,
    /// Number of measured steps of each scene and of each size of a scaling series, at least 1. Default: 1000.
    #[serde(default = "count::<1000>")]
    pub steps: usize,
    /// Maximum distance between the surface of an object and the surface of its sphere model, mm, at least 1e-6. Default: 0.25.
    #[serde(default = "default_surface_error_mm")]
    pub surface_error_mm: f64,
    /// Tables `[[whole_body.scenes]]`: the scenes that are simulated.
    pub scenes: Vec<BodySceneSpec>,
    /// Table `[whole_body.sensing]`: compression of the readings of touched taxels into measurements.
    pub sensing: BodySensingSpec,
    /// Table `[whole_body.recognition]`: the objects that are recognised, and their touches.
    pub recognition: BodyRecognitionSpec,
    /// Table `[whole_body.ladders]`: scaling series for the measurement of computing time. Default: none.
    pub ladders: Option<LaddersSpec>,
}

/// Keys of `[[whole_body.scenes]]`: a scene in which an object touches the skin and may move over it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BodySceneSpec {
    /// Name of the scene in tables and charts.
    pub name: String,
    /// Constant joint positions of the robot, given by the keys of `[robots.joints]` of a scene file with a single time. A joint that is not listed is at 0, or
    /// at its limit nearest to 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joints: Option<JointsSpec>,
    /// Object that touches the skin, with the keys of `[[objects]]` in a scene file. The key `link` is a link of the covered robot. The key `motion` can only
    /// be an oscillation; by default, the object does not move.
    pub object: ObjectSpec,
    /// Direction from the position `object.at` to the start of the approach, in the frame of the link; used with `depth_mm`. Default: +x.
    #[serde(default = "default_from")]
    pub from: [f64; 3],
    /// Travel of the object past first contact, mm. The object then approaches the position `object.at` along a straight line. Default: no approach; the object
    /// is placed at `object.at`.
    pub depth_mm: Option<f64>,
}

/// Keys of `[whole_body.sensing]`: compression of the readings of touched taxels into measurements.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BodySensingSpec {
    /// Number m of measurements per step, at least 1.
    pub measurements: usize,
    /// Ensembles of the measurement matrix to compare: `sbhe` and `sparse`. Only these ensembles have sparse matrices.
    #[schemars(with = "Vec<Names<Ensemble>>")]
    pub ensembles: Vec<Ensemble>,
    /// Numbers of taxels in a Hadamard block, each a power of two. Each number defines one compression of the ensemble `sbhe`. Default: 32.
    #[serde(default = "default_blocks")]
    pub sbhe_blocks: Vec<usize>,
}

/// Keys of `[whole_body.recognition]`: touches of built-in objects at one location of the skin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BodyRecognitionSpec {
    /// Names of the built-in objects that are recognised.
    pub objects: Vec<String>,
    /// Name of the robot link in whose frame the approach of the objects is defined.
    pub link: String,
    /// Position in the frame of the link that the objects approach, mm.
    pub at_mm: [f64; 3],
    /// Direction from the target to the start of the approach, in the link's frame. Default: +x.
    #[serde(default = "default_from")]
    pub from: [f64; 3],
    /// Maximum random offset of an object from the target, perpendicular to the approach, mm, at least 0. Default: 0.
    #[serde(default)]
    pub offset_mm: f64,
    /// Maximum random rotation of an object about the link's z axis, degrees, at least 0. Default: 0.
    #[serde(default)]
    pub yaw_deg: f64,
    /// Bounds of the random press depth (travel of an object past first contact), mm: lower and upper.
    pub depth_mm: [f64; 2],
    /// Number of training touches per object, at least 1.
    pub training_touches: usize,
    /// Number of test touches per object, at least 1.
    pub test_touches: usize,
}

/// Keys of `[whole_body.ladders]`: scaling series of skin, touch and object, whose computing times are measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LaddersSpec {
    /// Approximate total number of taxels of each skin in the series of growing skins. Tables list the actual numbers.
    pub taxels: Vec<usize>,
    /// Approximate numbers of touched taxels in the series in which the skin grows, each at most 40 % of the largest skin. Each skin is timed with each number
    /// that is at most 40 % of its taxels.
    pub touched_at_taxels: Vec<usize>,
    /// Approximate numbers of touched taxels in the scaling series of the touch. A size that the skin cannot reach has its measured number in tables.
    pub touched: Vec<usize>,
    /// Numbers of spheres of the object in the scaling series of the object; half of the spheres are on the side away from the skin. The series of growing
    /// skins and of growing touches use the first number.
    pub spheres: Vec<usize>,
    /// Approximate number of touched taxels in the series in which the object's number of spheres grows.
    pub touched_at_spheres: usize,
    /// Number of taxels of the skin in the scaling series of the touch and of the object.
    pub taxels_at_touch: usize,
}

impl LaddersSpec {
    /// Returns the largest number of touched taxels on a skin of `n_taxels` taxels, which is 40 % of them. The square of spheres of a larger touch might not fit
    /// around the skin.
    pub(super) fn max_touched(n_taxels: usize) -> usize {
        (0.4 * n_taxels as f64) as usize
    }
}

impl BodyRecognitionSpec {
    /// Returns the number of touches per object, which is the sum of its training and test touches.
    pub fn of_each(&self) -> usize {
        self.training_touches + self.test_touches
    }

    /// Returns the number of touches, summed over all objects.
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
