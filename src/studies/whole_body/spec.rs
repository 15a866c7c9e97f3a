//! Keys of a whole-body study.

use crate::files::FilePath;
use crate::scene::{JointsSpec, ObjectSpec};
use crate::studies::prelude::*;
use crate::studies::recognition::spec::STIFFNESS;

study_file! {
pub struct WholeBodyStudySpec {
    /// Table `[whole_body]`: all keys of the study.
    whole_body: WholeBodySpec;
} }

/// Maximum number of measured steps of a scene; the times of all steps are kept in memory.
const MAX_STEPS: usize = 10_000_000;
/// Maximum number of spheres of an object in a scaling series.
const MAX_SPHERES: usize = 10_000_000;

params! {
    /// Keys of `[whole_body]`: a robot covered with skin, its scenes, and the measurement of computing time.
    pub struct WholeBodySpec {
        /// URDF file of the robot that is covered with skin, relative to the study file.
        robot: FilePath => Unchecked, Condition, Never;
        /// Distance between neighbouring taxels, mm, positive. Default: 1.
        pitch_mm: f64 = 1.0 => Positive, Choice, Never;
        /// Approximate side length of a patch, mm, positive. Default: 100.
        patch_mm: f64 = 100.0 => Positive, Choice, Never;
        /// Whether the flat ends of cylinders are also covered with skin. Default: false.
        #[serde(skip_serializing_if = "std::ops::Not::not")]
        flat_ends: bool = false => Any, Choice, Never;
        /// Radius ρ of a taxel, mm, ρ > 0. Default: half the pitch.
        taxel_radius_mm: Option<f64> => Positive, Choice, Never;
        /// Stroke s of a taxel, mm, positive: its maximum deflection. Default: 2.
        stroke_mm: f64 = 2.0 => Positive, Choice, Never;
        /// Stiffness k of a taxel, N/m, positive. Default: 100.
        stiffness_n_per_m: f64 = STIFFNESS => Positive, Choice, Never,
            acts: acts![WholeBodySpec: |body| body.damping_n_s_per_m > 0.0
                => "the skin has no damper", "a whole_body.damping_n_s_per_m above 0 beside it"];
        /// Damping coefficient c of a taxel, N·s/m, at least 0. Default: 0.
        damping_n_s_per_m: f64 = 0.0 => NotNegative, Choice, Never;
        /// Duration of a simulated step, ms, positive. Default: 1.
        step_ms: f64 = 1.0 => Positive, Choice, Never;
        /// Number of measured steps of each scene and of each size of a scaling series, at least 1. Default: 1000.
        steps: usize = 1000 => Count(1, MAX_STEPS), Note, Never;
        /// Maximum distance between the surface of an object and the surface of its sphere model, mm, at least 1e-6. Default: 0.25.
        surface_error_mm: f64 = 0.25 => SURFACE_ERROR, Condition, Never;
        /// Tables `[[whole_body.scenes]]`: the scenes that are simulated.
        scenes: Vec<BodySceneSpec>;
        /// Table `[whole_body.sensing]`: compression of the readings of touched taxels into measurements.
        sensing: BodySensingSpec;
        /// Table `[whole_body.recognition]`: the objects that are recognised, and their touches.
        recognition: BodyRecognitionSpec;
        /// Table `[whole_body.ladders]`: scaling series for the measurement of computing time. Default: none.
        ladders: Option<LaddersSpec>;
    }
}

params! {
    /// Keys of `[[whole_body.scenes]]`: a scene in which an object touches the skin and may move over it.
    pub struct BodySceneSpec {
        /// Name of the scene in tables and charts.
        name: String => Unchecked, Subject, Never;
        /// Constant joint positions of the robot, given by the keys of `[robots.joints]` of a scene file with a single time. A joint that is not listed is at 0, or
        /// at its limit nearest to 0.
        joints: Option<JointsSpec> => Unchecked, Condition, Never;
        /// Object that touches the skin, with the keys of `[[objects]]` in a scene file. The key `link` is a link of the covered robot. The key `motion` can only
        /// be an oscillation; by default, the object does not move.
        object: ObjectSpec => Unchecked, Condition, Never;
        /// Direction from the position `object.at` to the start of the approach, in the frame of the link; used with `depth_mm`. Default: +x.
        from: [f64; 3] = [1.0, 0.0, 0.0] => Unchecked, Condition, Never;
        /// Travel of the object past first contact, mm. The object then approaches the position `object.at` along a straight line. Default: no approach; the object
        /// is placed at `object.at`.
        depth_mm: Option<f64> => Positive, Condition, Never;
    }
}

params! {
    /// Keys of `[whole_body.sensing]`: compression of the readings of touched taxels into measurements.
    pub struct BodySensingSpec {
        /// Number m of measurements per step, at least 1.
        measurements: usize => COUNT, Choice, Never;
        /// Ensembles of the measurement matrix to compare: `sbhe` and `sparse`. Only these ensembles have sparse matrices.
        ensembles: Vec<Ensemble> => Any, Choice, Table;
        /// Numbers of taxels in a Hadamard block, each a power of two. Each number defines one compression of the ensemble `sbhe`. Default: 32.
        sbhe_blocks: Vec<usize> = vec![32] => Any, Choice, Table;
    }
}

params! {
    /// Keys of `[whole_body.recognition]`: touches of built-in objects at one location of the skin.
    pub struct BodyRecognitionSpec {
        /// Names of the built-in objects that are recognised.
        objects: Vec<String> => Any, Subject, Never;
        /// Name of the robot link in whose frame the approach of the objects is defined.
        link: String => Unchecked, Condition, Never;
        /// Position in the frame of the link that the objects approach, mm.
        at_mm: [f64; 3] => Unchecked, Condition, Never;
        /// Direction from the target to the start of the approach, in the link's frame. Default: +x.
        from: [f64; 3] = [1.0, 0.0, 0.0] => Unchecked, Condition, Never;
        /// Maximum random offset of an object from the target, perpendicular to the approach, mm, at least 0. Default: 0.
        offset_mm: f64 = 0.0 => NotNegative, Condition, Never;
        /// Maximum random rotation of an object about the link's z axis, degrees, at least 0. Default: 0.
        yaw_deg: f64 = 0.0 => NotNegative, Condition, Never;
        /// Bounds of the random press depth (travel of an object past first contact), mm: lower and upper.
        depth_mm: [f64; 2] => Unchecked, Condition, Never;
        /// Number of training touches per object, at least 1.
        training_touches: usize => TOUCHES, Choice, Never;
        /// Number of test touches per object, at least 1.
        test_touches: usize => TOUCHES, Condition, Never;
    }
}

params! {
    /// Keys of `[whole_body.ladders]`: scaling series of skin, touch and object, whose computing times are measured.
    pub struct LaddersSpec {
        /// Approximate total number of taxels of each skin in the series of growing skins. Tables list the actual numbers.
        taxels: Vec<usize> => COUNT, Condition, Table;
        /// Approximate numbers of touched taxels in the series in which the skin grows, each at most 40 % of the largest skin. Each skin is timed with each number
        /// that is at most 40 % of its taxels.
        touched_at_taxels: Vec<usize> => COUNT, Condition, Table;
        /// Approximate numbers of touched taxels in the scaling series of the touch. A size that the skin cannot reach has its measured number in tables.
        touched: Vec<usize> => COUNT, Condition, Table;
        /// Numbers of spheres of the object in the scaling series of the object; half of the spheres are on the side away from the skin. The series of growing
        /// skins and of growing touches use the first number.
        spheres: Vec<usize> => Count(1, MAX_SPHERES), Condition, Table;
        /// Approximate number of touched taxels in the series in which the object's number of spheres grows.
        touched_at_spheres: usize => COUNT, Condition, Never;
        /// Number of taxels of the skin in the scaling series of the touch and of the object.
        taxels_at_touch: usize => COUNT, Condition, Never;
    }
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
