//! Plan of a whole-body study: checked keys, converted to SI units.

use crate::error::Result;
use crate::geometry::{Pose, rotation_from_rpy};
use crate::inputs::check::{COUNT, Check, Range, SURFACE_ERROR, TOUCHES};
use crate::inputs::units::MM;
use crate::sensing::Ensemble;
use crate::studies::whole_body::path::Path as ObjectPath;
use crate::studies::whole_body::spec::{
    BodyRecognitionSpec, BodySceneSpec, BodySensingSpec, WholeBodyStudySpec,
};
use crate::world::{Robot, Taxel};
use glam::DVec3;
use std::path::{Path, PathBuf};

/// Checked keys of a whole-body study, converted to SI units.
#[derive(Clone, Debug)]
pub struct WholeBodyPlan {
    /// Specification as written in the study file.
    pub spec: WholeBodyStudySpec,
    /// Robot that is covered with skin.
    pub robot: Robot,
    /// Path of the robot's URDF file.
    pub robot_file: PathBuf,
    /// Parameters of each taxel.
    pub taxel: Taxel,
    /// Distance between neighbouring taxels, metres.
    pub pitch: f64,
    /// Approximate side length of a patch, metres.
    pub side: f64,
    /// Duration of a simulated step, seconds.
    pub dt: f64,
    /// Maximum distance between an object's spheres and its surface, metres.
    pub surface_error: f64,
    /// Scenes in the order of the study file.
    pub scenes: Vec<ScenePlan>,
    /// Compressions by name (`sbhe_32`, `sparse`), each with the number of taxels in a Hadamard block; `None` for very sparse rows.
    pub compressions: Vec<(String, Option<usize>)>,
    /// Target of the objects that are to be recognised.
    pub aim: Aim,
}

/// Scene of a study: an object and its path.
#[derive(Clone, Debug, PartialEq)]
pub struct ScenePlan {
    /// Specification as written in the study file.
    pub spec: BodySceneSpec,
    /// Target and path of the object.
    pub aim: Aim,
    /// Joint positions of the robot, radians or metres.
    pub positions: Vec<f64>,
}

/// Target of an object in the frame of a link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim {
    /// Index of the robot link.
    pub link: usize,
    /// Direction from the target to the start of the approach, a unit vector.
    pub from: DVec3,
    /// Path of the object, with the link at the origin until the robot's posture is known.
    pub path: ObjectPath,
}

/// Maximum number of steps of a scene; the times of all steps are in memory.
const MAX_STEPS: usize = 10_000_000;
/// Maximum number of spheres of a cushion.
const MAX_SPHERES: usize = 10_000_000;

/// Allowed values of the numeric keys of `[whole_body]`.
const KEYS: [(&str, Range); 23] = [
    ("pitch_mm", Range::Positive),
    ("taxel_radius_mm", Range::Positive),
    ("stiffness_n_per_m", Range::Positive),
    ("damping_n_s_per_m", Range::NotNegative),
    ("stroke_mm", Range::Positive),
    ("patch_mm", Range::Positive),
    ("step_ms", Range::Positive),
    ("surface_error_mm", SURFACE_ERROR),
    ("steps", Range::Count(1, MAX_STEPS)),
    ("sensing.measurements", COUNT),
    ("sensing.ensembles", Range::Any),
    ("sensing.sbhe_blocks", Range::Any),
    ("recognition.objects", Range::Any),
    ("recognition.offset_mm", Range::NotNegative),
    ("recognition.yaw_deg", Range::NotNegative),
    ("recognition.training_touches", TOUCHES),
    ("recognition.test_touches", TOUCHES),
    ("ladders.taxels", COUNT),
    ("ladders.touched_at_taxels", COUNT),
    ("ladders.touched", COUNT),
    ("ladders.spheres", Range::Count(1, MAX_SPHERES)),
    ("ladders.touched_at_spheres", COUNT),
    ("ladders.taxels_at_touch", COUNT),
];

/// Allowed values of the numeric keys of a scene.
const SCENE_KEYS: [(&str, Range); 3] = [
    ("depth_mm", Range::Positive),
    ("period_ms", Range::Positive),
    ("swing_deg", Range::Finite),
];

impl WholeBodyPlan {
    /// Creates the plan of a study and checks all keys; the path of the robot is relative to `folder`.
    ///
    /// # Errors
    /// If a key is out of its range; the error names `place` (the file) and the first such key.
    pub fn new(place: &str, folder: &Path, spec: WholeBodyStudySpec) -> Result<Self> {
        let check = Check { place };
        let wanted = &spec.whole_body;
        let robot_file = wanted.robot.within(folder);
        let robot = Robot::read_urdf(&robot_file)?;
        check.keys("whole_body", wanted, KEYS)?;
        let scenes = wanted.scenes.iter().enumerate();
        let scenes = scenes
            .map(|(number, scene)| check.scene(number, scene, &robot))
            .collect::<Result<Vec<_>>>()?;
        let names = scenes.iter().map(|scene| scene.spec.name.as_str());
        check.list("whole_body.scenes", names.collect())?;
        let compressions = check.compressions(&wanted.sensing)?;
        let n_measured = compressions.len() * wanted.sensing.measurements;
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
            surface_error: MM * wanted.surface_error_mm,
            scenes,
            aim: check.body_recognition(&wanted.recognition, (&robot, n_measured))?,
            compressions,
            robot,
            robot_file,
            spec,
        })
    }

    /// Returns the specification of the recognition.
    pub fn recognition(&self) -> &BodyRecognitionSpec {
        &self.spec.whole_body.recognition
    }

    /// Returns the number of measured steps for each scene and each size of a scaling series.
    pub fn n_steps(&self) -> usize {
        self.spec.whole_body.steps
    }
}

impl Check<'_> {
    fn scene(&self, number: usize, scene: &BodySceneSpec, robot: &Robot) -> Result<ScenePlan> {
        let prefix = format!("whole_body.scenes[{number}]");
        let key = |name: &str| format!("{prefix}.{name}");
        if scene.object.is_some() != scene.parts.is_empty() {
            let given = "both or neither of object and parts";
            return Err(self.error(&key("object"), given, "one of object and parts"));
        }
        self.keys(&prefix, scene, SCENE_KEYS)?;
        let mut aim = self.aim(&prefix, (&scene.link, scene.at_mm, scene.from), robot)?;
        let turn = self.vector(&key("turn_deg"), scene.turn_deg)?;
        aim.path.start.rotation = rotation_from_rpy(turn.map(f64::to_radians));
        aim.path.moves = MM * self.vector(&key("moves_mm"), scene.moves_mm)?;
        aim.path.swing = scene.swing_deg.to_radians();
        aim.path.period = MM * scene.period_ms;
        Ok(ScenePlan {
            spec: scene.clone(),
            aim,
            positions: self.positions(&key("posture_deg"), scene, robot)?,
        })
    }

    fn positions(&self, key: &str, scene: &BodySceneSpec, robot: &Robot) -> Result<Vec<f64>> {
        let mut positions = robot.rest_positions();
        for (joint, &degrees) in &scene.posture_deg {
            let number = robot.joint(joint);
            let number = number.map_err(|_| self.error(key, joint, "joints of the robot"))?;
            let Some((coordinate, ..)) = robot.drive_of(number) else {
                return Err(self.error(key, joint, "joints that move"));
            };
            let degrees = self.value(key, degrees, f64::is_finite, "finite degrees")?;
            positions[coordinate] = degrees.to_radians();
        }
        Ok(positions)
    }

    /// Returns the target that is given by the name of a link, a position in millimetres and a direction.
    fn aim(
        &self,
        prefix: &str,
        (link, at, from): (&str, [f64; 3], [f64; 3]),
        robot: &Robot,
    ) -> Result<Aim> {
        let key = |name: &str| format!("{prefix}.{name}");
        let found = robot.link(link);
        let direction = self.vector(&key("from"), from)?.try_normalize();
        let given = format!("{from:?}");
        let zero = || self.error(&key("from"), given, "a vector that is not zero");
        let at = MM * self.vector(&key("at_mm"), at)?;
        Ok(Aim {
            link: found.map_err(|_| self.error(&key("link"), link, "links of the robot"))?,
            from: direction.ok_or_else(zero)?,
            path: ObjectPath::resting(Pose::from_translation(at)),
        })
    }

    fn vector(&self, key: &str, values: [f64; 3]) -> Result<DVec3> {
        match values.iter().all(|value| value.is_finite()) {
            true => Ok(DVec3::from_array(values)),
            false => Err(self.error(key, format!("{values:?}"), "three finite numbers")),
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

    fn body_recognition(
        &self,
        wanted: &BodyRecognitionSpec,
        (robot, n_measured): (&Robot, usize),
    ) -> Result<Aim> {
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
        self.aim(prefix, (&wanted.link, wanted.at_mm, wanted.from), robot)
    }
}
