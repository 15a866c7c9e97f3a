//! Keys of a whole-body study, and its plan: the checked values in SI units.

use crate::files::FilePath;
use crate::inputs::params::Described;
use crate::scene::spec::SHAPE_RULES;
use crate::scene::spec_motion::metres;
use crate::scene::{Carrier, JointsSpec, Movement, ObjectSpec, PlannedRobot, Reader};
use crate::studies::prelude::*;
use crate::studies::whole_body::ladders::{ScalingPoint, rungs};
use crate::world::{MeshFolders, Motion, Oscillation, Robot};
use glam::DVec3;
use std::path::{Path, PathBuf};

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
        stiffness_n_per_m: f64 = 100.0 => Positive, Choice, Never;
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

/// Checked keys of a whole-body study, converted to SI units.
#[derive(Clone, Debug)]
pub struct WholeBodyPlan {
    /// File name of the study, for error messages.
    pub place: String,
    /// Folder to which paths in the study file are relative.
    pub folder: PathBuf,
    /// Specification of the study, with the keys, values and units of the study file.
    pub spec: WholeBodyStudySpec,
    /// Robot that is covered with skin.
    pub robot: Robot,
    /// Parameters that all taxels of the skin share.
    pub taxel: Taxel,
    /// Distance between neighbouring taxels, metres.
    pub pitch: f64,
    /// Approximate side length of a patch, metres.
    pub side: f64,
    /// Duration of a simulated step, seconds.
    pub dt: f64,
    /// Scenes in the order of the study file.
    pub scenes: Vec<ScenePlan>,
    /// Compressions (measurement matrices), each with its name and the number of taxels in a Hadamard block. The name is `sbhe_` and this number, or `sparse`;
    /// the number is `None` for very sparse rows.
    pub compressions: Vec<(String, Option<usize>)>,
    /// Target position and approach direction of the objects that are recognised.
    pub aim: Aim,
    /// Sizes of the scaling series; empty without a table `[whole_body.ladders]`.
    pub(super) rungs: Vec<ScalingPoint>,
    /// Size of the covered robot; zero until the study is loaded.
    pub(super) size: BodySize,
}

/// Size of a robot that is covered with skin.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BodySize {
    /// Number of taxels; for very fine skins, extrapolated from a coarser skin.
    pub n_taxels: f64,
    /// Memory of the skin, bytes.
    pub body_bytes: f64,
    /// Memory of a state of the skin at rest, bytes.
    pub state_bytes: f64,
}

/// Plan of a scene: an object, its motion, and the joint positions of the robot.
#[derive(Clone, Debug, PartialEq)]
pub struct ScenePlan {
    /// Specification of the scene, with the keys, values and units of the study file.
    pub spec: BodySceneSpec,
    /// Target position, approach direction and motion of the object.
    pub aim: Aim,
    /// Joint positions of the robot, radians or metres.
    pub positions: Vec<f64>,
}

/// Target position, approach direction and motion of an object in the frame of a robot link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim {
    /// Index of the robot link in whose frame the object moves.
    pub link: usize,
    /// Direction from the target to the point where the approach starts, a unit vector.
    pub from: DVec3,
    /// Motion of the object in the frame of the link.
    pub motion: Oscillation,
}

impl WholeBodyPlan {
    /// Creates the plan of a study and checks all its keys; the path of the robot file is relative to `folder`.
    ///
    /// # Errors
    /// If a key is out of its range; the error names `place` (the file) and the first such key.
    pub fn new(place: &str, folder: &Path, spec: WholeBodyStudySpec) -> Result<Self> {
        let check = Check { place };
        let wanted = &spec.whole_body;
        let covered = PlannedRobot {
            name: ROBOT.to_owned(),
            robot: Robot::read(&wanted.robot.within(folder))?,
            meshes: MeshFolders::default(),
            base: Motion::Fixed(Pose::IDENTITY),
            joints: None,
        };
        check.keys("whole_body", wanted, keys_of::<WholeBodyStudySpec>())?;
        let reader = Reader {
            robots: vec![covered],
            ..Reader::new(place, folder)
        };
        let scenes = (1..)
            .zip(&wanted.scenes)
            .map(|(number, scene)| scene_plan(&reader, number, scene))
            .collect::<Result<Vec<_>>>()?;
        let robot = reader.robots[0].robot.clone();
        let names = scenes.iter().map(|scene| scene.spec.name.as_str());
        check.list("whole_body.scenes", names.collect())?;
        let compressions = check.compressions(&wanted.sensing)?;
        let n_measured = compressions.len() * wanted.sensing.measurements;
        check.body_recognition(&wanted.recognition, n_measured)?;
        let mut ladders = wanted.ladders.iter();
        ladders.try_for_each(|ladders| check.touched_at_taxels(ladders))?;
        let radius_mm = wanted.taxel_radius_mm.unwrap_or(0.5 * wanted.pitch_mm);
        Ok(Self {
            taxel: Taxel {
                radius: MM * radius_mm,
                stiffness: wanted.stiffness_n_per_m,
                damping: wanted.damping_n_s_per_m,
                stroke: MM * wanted.stroke_mm,
            },
            pitch: MM * wanted.pitch_mm,
            side: MM * wanted.patch_mm,
            dt: MM * wanted.step_ms,
            scenes,
            folder: folder.to_owned(),
            place: place.to_owned(),
            aim: recognition_aim(&reader, &wanted.recognition, &robot)?,
            rungs: wanted.ladders.as_ref().map_or_else(Vec::new, rungs),
            compressions,
            robot,
            spec,
            size: BodySize::default(),
        })
    }

    /// Returns the keys of the table `[whole_body.recognition]`.
    pub fn recognition(&self) -> &BodyRecognitionSpec {
        &self.spec.whole_body.recognition
    }
}

/// Value of the key `robot` of an object, which refers to the robot that is covered with skin.
const ROBOT: &str = "robot";

/// Checks a scene of the study, given its number from 1.
fn scene_plan(reader: &Reader, number: usize, scene: &BodySceneSpec) -> Result<ScenePlan> {
    let robot = &reader.robots[0].robot;
    let prefix = format!("whole_body.scenes[{number}]");
    let key = |name: &str| format!("{prefix}.{name}");
    let check = &reader.check;
    check.keys(&prefix, scene, keys_of::<WholeBodyStudySpec>())?;
    let object = &scene.object;
    let misplaced = [
        ("free", object.free.is_some()),
        ("press", object.press.is_some()),
    ];
    if let Some((name, _)) = misplaced.into_iter().find(|(_, is_given)| *is_given) {
        let allowed = "at and motion, and depth_mm beside the object";
        return Err(check.error(&key(&format!("object.{name}")), "given", allowed));
    }
    // Solids are packed when the scene runs; their keys are checked before.
    check.rules(&key("object"), object, SHAPE_RULES)?;
    object.check(check, &key("object"), None)?;
    if object.mesh.is_none() && object.spheres.is_none() {
        reader.solid(&key("object"), object)?;
    }
    let on_robot = ObjectSpec {
        robot: Some(object.robot.clone().unwrap_or(ROBOT.to_owned())),
        ..object.clone()
    };
    let Movement::Imposed {
        carrier: Carrier::Link { link, .. },
        motion,
    } = reader.imposed(&key("object"), &on_robot)?
    else {
        unreachable!("a link carries the object")
    };
    let motion = match motion {
        Motion::Fixed(start) => Oscillation::resting(start),
        Motion::Oscillation(oscillation) => oscillation,
        Motion::Plan(_) | Motion::WayPoints(_) => {
            let given = "phases or way-points";
            return Err(check.error(&key("object.motion"), given, "an oscillation"));
        }
    };
    let positions = match reader.joints(&key("joints"), scene.joints.as_ref(), robot)? {
        None => robot.rest_positions(),
        Some(joints) if joints.times().len() > 1 => {
            let given = format!("{} times", joints.times().len());
            return Err(check.error(&key("joints"), given, "one time: the robot stands still"));
        }
        Some(joints) => joints.positions_at(0.0),
    };
    Ok(ScenePlan {
        spec: scene.clone(),
        aim: Aim {
            link,
            from: direction(reader, &key("from"), scene.from)?,
            motion,
        },
        positions,
    })
}

/// Returns the target position and the approach direction of the objects for recognition.
fn recognition_aim(reader: &Reader, wanted: &BodyRecognitionSpec, robot: &Robot) -> Result<Aim> {
    let key = |name: &str| format!("whole_body.recognition.{name}");
    let at = metres(wanted.at_mm);
    Ok(Aim {
        link: reader.under(&key("link"), robot.link(&wanted.link))?,
        from: direction(reader, &key("from"), wanted.from)?,
        motion: Oscillation::resting(Pose::from_translation(at)),
    })
}

/// Returns the direction of the approach as a unit vector; if the vector has length 0, the error names the `key`.
fn direction(reader: &Reader, key: &str, from: [f64; 3]) -> Result<DVec3> {
    let direction = DVec3::from_array(from).try_normalize();
    let zero = || {
        let given = format!("{from:?}");
        reader.check.error(key, given, "a vector that is not zero")
    };
    direction.ok_or_else(zero)
}

impl Check<'_> {
    /// Checks that each touch of the series of growing skins fits on at least one skin.
    fn touched_at_taxels(&self, ladders: &LaddersSpec) -> Result<()> {
        let most = LaddersSpec::max_touched(ladders.taxels.iter().copied().max().unwrap_or(0));
        match ladders.touched_at_taxels.iter().find(|&&n| n > most) {
            Some(n) => {
                let allowed = format!("at most {most}, 40 % of the largest skin in ladders.taxels");
                Err(self.error("whole_body.ladders.touched_at_taxels", n, allowed))
            }
            None => Ok(()),
        }
    }

    fn compressions(&self, wanted: &BodySensingSpec) -> Result<Vec<(String, Option<usize>)>> {
        let blocks = &wanted.sbhe_blocks;
        if let Some(block) = blocks.iter().find(|block| !block.is_power_of_two()) {
            return Err(self.error("whole_body.sensing.sbhe_blocks", block, "powers of two"));
        }
        let sbhe = |&block: &usize| (format!("sbhe_{block}"), Some(block));
        let of_ensemble = |ensemble: &Ensemble| match ensemble {
            Ensemble::Sbhe => Ok(blocks.iter().map(sbhe).collect()),
            Ensemble::Sparse => Ok(vec![("sparse".to_owned(), None)]),
            _ => Err(self.error(
                "whole_body.sensing.ensembles",
                format!("{ensemble:?}"),
                "sbhe and sparse, which need no dense matrix",
            )),
        };
        let compressions = wanted.ensembles.iter().map(of_ensemble);
        Ok(compressions.collect::<Result<Vec<_>>>()?.concat())
    }

    fn body_recognition(&self, wanted: &BodyRecognitionSpec, n_measured: usize) -> Result<()> {
        let prefix = "whole_body.recognition";
        let key = |name: &str| format!("{prefix}.{name}");
        if wanted.objects.len() < 2 {
            return Err(self.error(&key("objects"), "one object", "at least two"));
        }
        let [least, most] = wanted.depth_mm;
        if !(least > 0.0 && most >= least && most.is_finite()) {
            let given = format!("{:?}", wanted.depth_mm);
            return Err(self.error(&key("depth_mm"), given, "two positive numbers that ascend"));
        }
        let n_touches = wanted.n_touches();
        let bytes = 8.0 * n_touches as f64 * n_measured as f64;
        let what = format!("{n_measured} measurements of each of {n_touches} touches");
        self.memory(&key("training_touches"), wanted.of_each(), bytes, &what)?;
        Ok(())
    }
}
