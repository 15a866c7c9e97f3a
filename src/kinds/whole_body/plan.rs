//! A study of a whole body that can run: every key checked, every unit SI.

use super::spec::{
    BodyPartSpec, BodyRecognitionSpec, BodySceneSpec, BodySensingSpec, LaddersSpec, WholeBodySpec,
    WholeBodyStudySpec,
};
use crate::error::Result;
use crate::geometry::rotation_from_rpy;
use crate::sensing::Ensemble;
use crate::study::MM;
use crate::study::{Check, not_negative, positive};
use crate::world::{MOST_TOUCHES, Robot, Taxel};
use glam::{DQuat, DVec3};
use std::path::{Path, PathBuf};

/// Settings of a study of a whole body, ready to run.
#[derive(Clone, Debug)]
pub struct WholeBodyPlan {
    /// As it was written.
    pub spec: WholeBodyStudySpec,
    /// What is covered.
    pub robot: Robot,
    /// Its file.
    pub robot_file: PathBuf,
    /// Each of the taxels.
    pub taxel: Taxel,
    /// Metres between taxels.
    pub pitch: f64,
    /// Side of a patch, about, metres.
    pub side: f64,
    /// Length of a step, seconds.
    pub dt: f64,
    /// How far the spheres of an object may be from its surface, metres.
    pub surface_error: f64,
    /// In the order of the file.
    pub scenes: Vec<ScenePlan>,
    /// Taxels of a Hadamard block, or none for very sparse rows: each a compression.
    pub compressions: Vec<(Ensemble, Option<usize>)>,
    /// Which objects are told apart where.
    pub recognition: RecognitionPlan,
    /// Rungs of all ladders, as they were written.
    pub ladders: Option<LaddersSpec>,
}

/// A scene: an object and its path.
#[derive(Clone, Debug, PartialEq)]
pub struct ScenePlan {
    /// What it is called.
    pub name: String,
    /// What touches.
    pub object: ObjectPlan,
    /// Where it is placed.
    pub place: PlacePlan,
    /// How far past first contact, metres; `None` where it is placed at once.
    pub depth: Option<f64>,
    /// Metres, in the frame of the link.
    pub moves: DVec3,
    /// Radians.
    pub swing: f64,
    /// Seconds.
    pub period: f64,
    /// Values of the robot's coordinates, radians or metres.
    pub positions: Vec<f64>,
}

/// What an object is.
#[derive(Clone, Debug, PartialEq)]
pub enum ObjectPlan {
    /// A built-in one by its name.
    BuiltIn(String),
    /// Parts.
    Parts(Vec<BodyPartSpec>),
}

/// Where an object is aimed, in the frame of a link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacePlan {
    /// The link's number.
    pub link: usize,
    /// Metres.
    pub at: DVec3,
    /// How it is turned.
    pub turn: DQuat,
    /// From where it comes, unit.
    pub from: DVec3,
}

/// Objects that are told apart.
#[derive(Clone, Debug, PartialEq)]
pub struct RecognitionPlan {
    /// At least two names.
    pub objects: Vec<String>,
    /// Where they are aimed.
    pub place: PlacePlan,
    /// Metres either way.
    pub offset: f64,
    /// Radians either way.
    pub yaw: f64,
    /// Least and most, metres.
    pub depth: [f64; 2],
    /// Touches of each object that train, at least 1.
    pub n_training: usize,
    /// Touches of each object that test, at least 1.
    pub n_test: usize,
}

/// Steps of a scene, at most: the time of each is in memory.
const MOST_STEPS: usize = 10_000_000;
/// Spheres of a cushion, at most.
const MOST_SPHERES: usize = 10_000_000;

impl WholeBodyPlan {
    /// Checks a study whose robot lies beside `folder`; the error names `place` (the file) and the first key that is out of its range.
    pub fn new(place: &str, folder: &Path, spec: WholeBodyStudySpec) -> Result<Self> {
        let check = Check { place };
        let wanted = &spec.whole_body;
        let robot_file = folder.join(&wanted.robot);
        let robot = Robot::read_urdf(&robot_file)?;
        let pitch = check.length("pitch_mm", wanted.pitch_mm)?;
        let scenes = wanted.scenes.iter().enumerate();
        let scenes = scenes
            .map(|(number, scene)| check.scene(number, scene, &robot))
            .collect::<Result<Vec<_>>>()?;
        let names: Vec<&str> = scenes.iter().map(|scene| scene.name.as_str()).collect();
        check.list("whole_body.scenes", names)?;
        let compressions = check.compressions(&wanted.sensing)?;
        Ok(Self {
            taxel: check.taxel(wanted)?,
            pitch,
            side: check.length("patch_mm", wanted.patch_mm)?,
            dt: check.length("step_ms", wanted.step_ms)?,
            surface_error: check.length("surface_error_mm", wanted.surface_error_mm)?,
            scenes,
            recognition: {
                let n_measured = compressions.len() * wanted.sensing.measurements;
                check.body_recognition(&wanted.recognition, (&robot, n_measured))?
            },
            compressions,
            ladders: check.ladders(wanted.ladders.as_ref())?,
            robot,
            robot_file,
            spec: {
                check.count("whole_body.steps", wanted.steps, MOST_STEPS)?;
                spec
            },
        })
    }

    /// Steps that are measured of each scene and rung.
    pub fn n_steps(&self) -> usize {
        self.spec.whole_body.steps
    }
}

impl Check<'_> {
    /// Thousandths that are positive: of a metre, or of a second.
    fn length(&self, key: &str, value: f64) -> Result<f64> {
        let key = format!("whole_body.{key}");
        Ok(MM * self.value(&key, value, positive, "a positive number")?)
    }

    fn taxel(&self, wanted: &WholeBodySpec) -> Result<Taxel> {
        let radius = wanted.taxel_radius_mm.unwrap_or(0.5 * wanted.pitch_mm);
        let key = "whole_body.stiffness_n_per_m";
        let stiffness = self.value(key, wanted.stiffness_n_per_m, positive, "a positive number")?;
        let key = "whole_body.damping_n_s_per_m";
        let allowed = "zero or a positive number";
        let damping = self.value(key, wanted.damping_n_s_per_m, not_negative, allowed)?;
        Ok(Taxel {
            radius: self.length("taxel_radius_mm", radius)?,
            stiffness,
            damping,
            stroke: self.length("stroke_mm", wanted.stroke_mm)?,
        })
    }

    fn scene(&self, number: usize, scene: &BodySceneSpec, robot: &Robot) -> Result<ScenePlan> {
        let key = |name: &str| format!("whole_body.scenes[{number}].{name}");
        let object = match (&scene.object, scene.parts.is_empty()) {
            (Some(name), true) => ObjectPlan::BuiltIn(name.clone()),
            (None, false) => ObjectPlan::Parts(scene.parts.clone()),
            _ => {
                let given = "both or neither of object and parts";
                return Err(self.error(&key("object"), given, "one of object and parts"));
            }
        };
        let mut positions = vec![0.0; robot.n_positions()];
        for (joint, degrees) in &scene.posture_deg {
            let key = key("posture_deg");
            let number = robot
                .joint(joint)
                .map_err(|_| self.error(&key, joint, "joints of the robot"))?;
            let Some((coordinate, ..)) = robot.drive_of(number) else {
                return Err(self.error(&key, joint, "joints that move"));
            };
            let allowed = "finite degrees";
            positions[coordinate] = self
                .value(&key, *degrees, f64::is_finite, allowed)?
                .to_radians();
        }
        let depth = scene.depth_mm.map(|depth| {
            let allowed = "a positive number";
            self.value(&key("depth_mm"), depth, positive, allowed)
        });
        let period = self.value(
            &key("period_ms"),
            scene.period_ms,
            positive,
            "a positive number",
        )?;
        let swing = self.value(
            &key("swing_deg"),
            scene.swing_deg,
            f64::is_finite,
            "finite degrees",
        )?;
        let at = self.vector(&key("at_mm"), scene.at_mm)?;
        let turn = self.vector(&key("turn_deg"), scene.turn_deg)?;
        Ok(ScenePlan {
            name: scene.name.clone(),
            object,
            place: PlacePlan {
                link: self.link(&key("link"), &scene.link, robot)?,
                at: MM * at,
                turn: rotation_from_rpy(turn.map(f64::to_radians)),
                from: self.direction(&key("from"), scene.from)?,
            },
            depth: depth.transpose()?.map(|depth| MM * depth),
            moves: MM * self.vector(&key("moves_mm"), scene.moves_mm)?,
            swing: swing.to_radians(),
            period: MM * period,
            positions,
        })
    }

    fn link(&self, key: &str, name: &str, robot: &Robot) -> Result<usize> {
        robot
            .link(name)
            .map_err(|_| self.error(key, name, "links of the robot"))
    }

    fn vector(&self, key: &str, values: [f64; 3]) -> Result<DVec3> {
        match values.iter().all(|value| value.is_finite()) {
            true => Ok(DVec3::from_array(values)),
            false => Err(self.error(key, format!("{values:?}"), "three finite numbers")),
        }
    }

    fn direction(&self, key: &str, values: [f64; 3]) -> Result<DVec3> {
        let vector = self.vector(key, values)?;
        vector
            .try_normalize()
            .ok_or_else(|| self.error(key, format!("{values:?}"), "a vector that is not zero"))
    }

    fn compressions(&self, wanted: &BodySensingSpec) -> Result<Vec<(Ensemble, Option<usize>)>> {
        self.positive_count("whole_body.sensing.measurements", wanted.measurements)?;
        let key = "whole_body.sensing.ensembles";
        let ensembles = self.list(key, wanted.ensembles.clone())?;
        let key_of_blocks = "whole_body.sensing.sbhe_blocks";
        let blocks = self.list(key_of_blocks, wanted.sbhe_blocks.clone())?;
        if let Some(block) = blocks.iter().find(|block| !block.is_power_of_two()) {
            return Err(self.error(key_of_blocks, block, "powers of two"));
        }
        let mut compressions = Vec::new();
        for ensemble in ensembles {
            match ensemble {
                Ensemble::Sbhe => {
                    compressions.extend(blocks.iter().map(|&block| (ensemble, Some(block))));
                }
                Ensemble::Sparse => compressions.push((ensemble, None)),
                _ => {
                    let allowed = "sbhe and sparse, which need no dense matrix";
                    return Err(self.error(key, format!("{ensemble:?}"), allowed));
                }
            }
        }
        Ok(compressions)
    }

    fn body_recognition(
        &self,
        wanted: &BodyRecognitionSpec,
        (robot, n_measured): (&Robot, usize),
    ) -> Result<RecognitionPlan> {
        let key = |name: &str| format!("whole_body.recognition.{name}");
        let objects = self.list(&key("objects"), wanted.objects.clone())?;
        if objects.len() < 2 {
            return Err(self.error(&key("objects"), "one object", "at least two"));
        }
        let [least, most] = wanted.depth_mm;
        if !(least > 0.0 && most >= least && most.is_finite()) {
            let given = format!("{:?}", wanted.depth_mm);
            return Err(self.error(&key("depth_mm"), given, "two positive numbers that ascend"));
        }
        let spread = |name: &str, value| {
            self.value(&key(name), value, not_negative, "zero or a positive number")
        };
        let count = |name: &str, count| self.count(&key(name), count, MOST_TOUCHES);
        let n_training = count("training_touches", wanted.training_touches)?;
        let n_test = count("test_touches", wanted.test_touches)?;
        let n_touches = objects.len() * (n_training + n_test);
        let bytes = 8.0 * n_touches as f64 * n_measured as f64;
        let what = format!("{n_measured} measurements of each of {n_touches} touches");
        self.memory(&key("training_touches"), n_training + n_test, bytes, &what)?;
        Ok(RecognitionPlan {
            objects,
            place: PlacePlan {
                link: self.link(&key("link"), &wanted.link, robot)?,
                at: MM * self.vector(&key("at_mm"), wanted.at_mm)?,
                turn: DQuat::IDENTITY,
                from: self.direction(&key("from"), wanted.from)?,
            },
            offset: MM * spread("offset_mm", wanted.offset_mm)?,
            yaw: spread("yaw_deg", wanted.yaw_deg)?.to_radians(),
            depth: [MM * least, MM * most],
            n_training,
            n_test,
        })
    }

    fn ladders(&self, wanted: Option<&LaddersSpec>) -> Result<Option<LaddersSpec>> {
        let Some(rungs) = wanted else {
            return Ok(None);
        };
        let key = |name: &str| format!("whole_body.ladders.{name}");
        for &count in &rungs.spheres {
            self.count(&key("spheres"), count, MOST_SPHERES)?;
        }
        for (name, counts) in [
            ("taxels", &rungs.taxels),
            ("touched_at_taxels", &rungs.touched_at_taxels),
            ("touched", &rungs.touched),
            ("spheres", &rungs.spheres),
        ] {
            for &count in &self.list(&key(name), counts.clone())? {
                self.positive_count(&key(name), count)?;
            }
        }
        for (name, count) in [
            ("touched_at_spheres", rungs.touched_at_spheres),
            ("taxels_at_touch", rungs.taxels_at_touch),
        ] {
            self.positive_count(&key(name), count)?;
        }
        Ok(Some(rungs.clone()))
    }
}
