//! Plan of a whole-body study: the checked values in SI units.

use crate::inputs::params::Described;
use crate::scene::spec::SHAPE_RULES;
use crate::scene::spec_motion::metres;
use crate::scene::{Carrier, Movement, ObjectSpec, PlannedRobot, Reader};
use crate::studies::prelude::*;
use crate::studies::whole_body::spec::*;
use crate::world::{MeshFolders, Motion, Oscillation, Robot};
use glam::DVec3;
use std::path::{Path, PathBuf};

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
    let free = object.free.map(|_| "free");
    if let Some(name) = free.or(object.press.as_ref().map(|_| "press")) {
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
