//! Runs a study of a whole body: learn, then the scenes and the ladders one after the other, so that nothing else is timed.

use super::bars::bars;
use super::drive::{Drive, PosedBody};
use super::ladders::{Rung, climb, rungs};
use super::path::Path;
use super::plan::{ScenePlan, WholeBodyPlan};
use super::recognition::{Compression, learn, name_of};
use super::table::{BodyCase, BodySensed, Series, WholeBodyTables};
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::objects::SphereUnion;
use crate::study::pieces::{NamedPiece, PieceRows, PieceStudy, PiecesLeft};
use crate::study::time_left::Piece;
use crate::whole_body::CoveredRobot;

impl WholeBodyPlan {
    /// What each compression is called as a piece.
    fn compression_names(&self) -> Vec<String> {
        let compressions = self.compressions.iter();
        let name = |&(ensemble, block)| format!("learn from {}", name_of(ensemble, block));
        compressions.map(name).collect()
    }

    /// What needs all that is learned.
    fn learned_names(&self) -> Vec<String> {
        let mut names = self.compression_names();
        names.extend(self.scenes.iter().map(scene_name));
        names
    }

    fn rungs(&self) -> Vec<Rung> {
        self.ladders.as_ref().map_or_else(Vec::new, rungs)
    }
}

/// Stages, for the time left.
const LEARN: u8 = 0;
const PLAY: u8 = 1;
const CLIMB: u8 = 2;

/// Seconds to cover a robot, for a touch that is learned from or tested, and for a step of a scene with an object of no size, about.
const COVER_S: f64 = 0.5;
const TOUCH_S: f64 = 7e-4;
const SCENE_S: f64 = 5e-5;
/// What a step of a scene takes for each metre of its object: a longer one touches more.
const SCENE_S_PER_M: f64 = 1.7e-3;

fn scene_name(scene: &ScenePlan) -> String {
    format!("scene {}", scene.name)
}

fn rung_name(rung: &Rung) -> String {
    format!("ladder of {:?}, {}", rung.series, rung.name).to_lowercase()
}

impl PieceStudy for WholeBodyPlan {
    type Rows = WholeBodyTables;
    type Tables = WholeBodyTables;

    /// Compressions and scenes need all that is learned; rungs need nothing.
    fn pieces(&self) -> Vec<NamedPiece> {
        let names = self.compression_names().into_iter();
        let compressions =
            names.map(|name| NamedPiece::new(name, 0, Piece::one_by_one(LEARN, 0.0)));
        let scenes = self.scenes.iter().map(|scene| {
            NamedPiece::new(scene_name(scene), 0, self.scene_work(scene)).made_of(scene)
        });
        let rungs = self.rungs();
        let rungs = rungs.iter().enumerate().map(|(number, rung)| {
            let work = Piece::one_by_one(CLIMB, rung.planned_s(self.n_steps()));
            NamedPiece::new(rung_name(rung), number + 1, work).made_of(rung)
        });
        compressions.chain(scenes).chain(rungs).collect()
    }

    fn measure(&self, left: &PiecesLeft<WholeBodyTables>) -> Result<()> {
        let scenes = left.of(&self.scenes, |scene| scene_name(scene));
        let names = left.of(self.learned_names(), String::clone);
        if !names.is_empty()
            && let Some(covered) = left.prepare(&names, || {
                left.during(&self.cover_work(), || self.cover(left))
            })?
            && let Some(compressions) = left.prepare(&names, || {
                let straight = vec![0.0; self.robot.n_positions()];
                let straight = Posture::new(self, &covered, &straight)?;
                left.during(&self.learn_work(), || {
                    learn(self, &straight.posed, &straight.links, left.progress)
                })
            })?
        {
            for (compression, name) in compressions.iter().zip(self.compression_names()) {
                left.finish(&name, || {
                    Ok(WholeBodyTables {
                        recognition: vec![compression.score.clone()],
                        ..WholeBodyTables::default()
                    })
                })?;
            }
            left.progress.stage("scenes", scenes.len() as u64);
            for scene in scenes {
                let play = || play(self, scene, &covered, &compressions);
                left.finish(&scene_name(scene), play)?;
            }
        }
        let rungs = left.of(self.rungs(), rung_name);
        left.progress.stage("ladders", rungs.len() as u64);
        rungs.iter().try_for_each(|rung| {
            left.finish(&rung_name(rung), || {
                let (case, driven) = climb(self, rung)?;
                let mut tables = WholeBodyTables::default();
                tables.add(&case, driven.count, driven.times);
                Ok(tables)
            })
        })
    }

    fn shared_work(&self, left: &PiecesLeft<WholeBodyTables>) -> Vec<Piece> {
        match self.learned_names().iter().any(|name| left.has(name)) {
            true => vec![self.cover_work(), self.learn_work()],
            false => Vec::new(),
        }
    }

    fn tables(&self, mut tables: WholeBodyTables) -> Result<WholeBodyTables> {
        tables.bars = bars(&tables);
        Ok(tables)
    }
}

impl PieceRows for WholeBodyTables {
    fn append(&mut self, next: Self) {
        self.cases.extend(next.cases);
        self.sensed.extend(next.sensed);
        self.recognition.extend(next.recognition);
        self.timing.extend(next.timing);
    }
}

impl WholeBodyPlan {
    fn cover_work(&self) -> Piece {
        Piece::one_by_one(LEARN, COVER_S)
    }

    fn learn_work(&self) -> Piece {
        let n_touches = self.recognition.n_training + self.recognition.n_test;
        let n_touches = n_touches * self.recognition.objects.len();
        Piece::one_by_one(LEARN, TOUCH_S * n_touches as f64)
    }

    /// An object that cannot be made fails when its scene begins.
    fn scene_work(&self, scene: &ScenePlan) -> Piece {
        let length = scene.object.length().unwrap_or(0.0);
        let step_s = SCENE_S + SCENE_S_PER_M * length;
        Piece::one_by_one(PLAY, step_s * self.n_steps() as f64)
    }

    fn cover(&self, left: &PiecesLeft<WholeBodyTables>) -> Result<CoveredRobot> {
        left.progress.stage("cover", 1);
        let covered = CoveredRobot::new(&self.robot, self.taxel, self.pitch, self.side)?;
        left.progress.advance(1);
        Ok(covered)
    }
}

/// Where everything of a robot is.
pub(super) struct Posture<'a> {
    pub links: Vec<Pose>,
    pub posed: PosedBody<'a>,
}

impl<'a> Posture<'a> {
    pub fn new(plan: &WholeBodyPlan, covered: &'a CoveredRobot, positions: &[f64]) -> Result<Self> {
        let links = plan.robot.forward(&Pose::IDENTITY, positions)?;
        let mut poses = Vec::new();
        covered.patch_poses(&links, &mut poses);
        let posed = PosedBody {
            body: covered.body(),
            poses,
        };
        Ok(Self { links, posed })
    }
}

/// Brings an object to where its scene begins.
pub(super) fn begin<'a>(
    scene: &ScenePlan,
    posture: &Posture<'a>,
    object: &SphereUnion,
) -> Result<Drive<'a>> {
    let path = Path {
        world_from_link: posture.links[scene.place.link],
        start: Pose::new(scene.place.turn, scene.place.at),
        moves: scene.moves,
        swing: scene.swing,
        period: scene.period,
    };
    let mut drive = Drive::new(&posture.posed, object, path);
    if let Some(depth) = scene.depth {
        drive.approach(scene.place.from, depth)?;
    }
    Ok(drive)
}

/// Plays a scene; the error names it.
fn play(
    plan: &WholeBodyPlan,
    scene: &ScenePlan,
    covered: &CoveredRobot,
    compressions: &[Compression],
) -> Result<WholeBodyTables> {
    let in_scene = |error: Error| error.under(format!("scene {}, ", scene.name));
    let object = scene.object.build(plan.surface_error).map_err(in_scene)?;
    let posture = Posture::new(plan, covered, &scene.positions)?;
    let mut drive = begin(scene, &posture, &object).map_err(in_scene)?;
    let case = BodyCase {
        series: Series::Scene,
        name: scene.name.clone(),
        n_taxels: covered.body().n_taxels(),
        n_patches: covered.body().patches().len(),
        n_spheres: drive.n_spheres(),
    };
    let driven = drive.run(plan.n_steps(), plan.dt, compressions)?;
    let mut tables = WholeBodyTables::default();
    for (compression, (sum, decisions)) in compressions.iter().zip(&driven.sensed) {
        let most = decisions.iter().copied().max().unwrap_or(0);
        let label = decisions.iter().position(|&n| n == most).unwrap_or(0);
        tables.sensed.push(BodySensed {
            scene: scene.name.clone(),
            compression: compression.name.clone(),
            measurement_sum_mm: *sum,
            decision: plan.recognition.objects[label].clone(),
            decision_share: most as f64 / driven.count.n_steps as f64,
        });
    }
    tables.add(&case, driven.count, driven.times);
    Ok(tables)
}
