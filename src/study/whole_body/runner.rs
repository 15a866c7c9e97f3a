//! Runs a study of a whole body: learn, then the scenes and the ladders one after the other, so that nothing else is timed.

use super::bars::bars;
use super::drive::{Drive, PosedBody};
use super::ladders::{climb, rungs};
use super::path::Path;
use super::plan::{ScenePlan, WholeBodyPlan};
use super::recognition::{Compression, learn};
use super::table::{BodyCase, BodySensed, Series, WholeBodyTables};
use crate::error::Result;
use crate::geometry::Pose;
use crate::objects::{Sphere, SphereUnion};
use crate::study::progress::Progress;
use crate::whole_body::CoveredRobot;
use glam::DVec3;

/// What a study of a whole body found.
#[derive(Clone, Debug)]
pub struct BodyOutcome {
    /// All tables.
    pub tables: WholeBodyTables,
    /// Of each scene that touches something, as it begins.
    pub pictures: Vec<BodyPicture>,
}

/// What a scene looks like, in the world frame.
#[derive(Clone, Debug)]
pub struct BodyPicture {
    /// The scene.
    pub scene: String,
    /// Places on the skin, metres, some millimetres apart, and the pressure on their patch: force over area, Pa.
    pub skin: Vec<(DVec3, f64)>,
    /// Patches that are touched.
    pub n_patches: usize,
    /// Touched taxels, metres.
    pub touched: Vec<DVec3>,
    /// What touches, metres.
    pub object: Vec<Sphere>,
}

/// Between the places of a picture's skin, metres.
const PICTURE_PITCH: f64 = 4e-3;

/// Runs a study. The tables but for times and bars are the same bytes at any number of threads.
///
/// # Errors
/// An object that is not built in, or that does not meet the skin where it is aimed; what a stage refuses.
pub fn measure_body(plan: &WholeBodyPlan, progress: &dyn Progress) -> Result<BodyOutcome> {
    progress.stage("cover", 1);
    let covered = CoveredRobot::new(&plan.robot, plan.taxel, plan.pitch, plan.side)?;
    progress.advance(1);
    let straight = Posture::new(plan, &covered, &vec![0.0; plan.robot.n_positions()])?;
    let compressions = learn(plan, &straight.posed, &straight.links, progress)?;
    let mut tables = WholeBodyTables {
        recognition: compressions.iter().map(|c| c.score.clone()).collect(),
        ..WholeBodyTables::default()
    };
    let mut pictures = Vec::new();
    progress.stage("scenes", plan.scenes.len() as u64);
    for scene in &plan.scenes {
        let (place, object) = (&scene.name, scene.object.build(plan.surface_error));
        let object = object.map_err(|error| error.under(format!("scene {place}, ")))?;
        pictures.extend(play(
            plan,
            scene,
            &covered,
            &object,
            &compressions,
            &mut tables,
        )?);
        progress.advance(1);
    }
    if let Some(ladders) = &plan.ladders {
        let rungs = rungs(ladders);
        progress.stage("ladders", rungs.len() as u64);
        for rung in &rungs {
            let (case, driven) = climb(plan, rung)?;
            tables.add(&case, driven.count, driven.times);
            progress.advance(1);
        }
    }
    tables.bars = bars(&tables);
    Ok(BodyOutcome { tables, pictures })
}

/// Where everything of a robot is.
struct Posture<'a> {
    links: Vec<Pose>,
    posed: PosedBody<'a>,
}

impl<'a> Posture<'a> {
    fn new(plan: &WholeBodyPlan, covered: &'a CoveredRobot, positions: &[f64]) -> Result<Self> {
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

/// Plays a scene into the tables; what it looks like, if anything is touched.
fn play(
    plan: &WholeBodyPlan,
    scene: &ScenePlan,
    covered: &CoveredRobot,
    object: &SphereUnion,
    compressions: &[Compression],
    tables: &mut WholeBodyTables,
) -> Result<Option<BodyPicture>> {
    let posture = Posture::new(plan, covered, &scene.positions)?;
    let path = Path {
        world_from_link: posture.links[scene.place.link],
        start: Pose::new(scene.place.turn, scene.place.at),
        moves: scene.moves,
        swing: scene.swing,
        period: scene.period,
    };
    let mut drive = Drive::new(&posture.posed, object, path);
    if let Some(depth) = scene.depth {
        drive
            .approach(scene.place.from, depth)
            .map_err(|error| error.under(format!("scene {}, ", scene.name)))?;
    }
    let case = BodyCase {
        series: Series::Scene,
        name: scene.name.clone(),
        n_taxels: covered.body().n_taxels(),
        n_patches: covered.body().patches().len(),
        n_spheres: drive.n_spheres(),
    };
    let driven = drive.run(plan.n_steps(), plan.dt, compressions)?;
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
    let is_touched = driven.count.touched_max > 0;
    tables.add(&case, driven.count, driven.times);
    if !is_touched {
        return Ok(None);
    }
    picture(plan, scene, covered, &posture, &mut drive, object).map(Some)
}

fn picture(
    plan: &WholeBodyPlan,
    scene: &ScenePlan,
    covered: &CoveredRobot,
    posture: &Posture,
    drive: &mut Drive,
    object: &SphereUnion,
) -> Result<BodyPicture> {
    let path = drive.path;
    let n_patches = drive.probe(&path).n_patches;
    let body = covered.body();
    let mut pressures = vec![0.0; body.patches().len()];
    let mut touched = Vec::new();
    let (mut patch, mut layout) = (usize::MAX, None);
    for (taxel, deflection) in drive.touched() {
        let of = body.firsts().partition_point(|&first| first <= taxel) - 1;
        if of != patch || layout.is_none() {
            patch = of;
            layout = Some(body.patches()[patch].layout());
        }
        pressures[patch] += plan.taxel.stiffness * deflection;
        if let Some(layout) = &layout {
            let center = layout.centers()[taxel - body.firsts()[patch]];
            touched.push(posture.posed.poses[patch].transform_point(center));
        }
    }
    for (pressure, patch) in pressures.iter_mut().zip(body.patches()) {
        *pressure /= patch.n_taxels() as f64 * plan.pitch * plan.pitch;
    }
    let pitch = PICTURE_PITCH.max(plan.pitch);
    let coarse = CoveredRobot::new(&plan.robot, plan.taxel, pitch, plan.side)?;
    let skin = coarse.body().patches().iter().zip(&posture.posed.poses);
    let skin = skin.zip(&pressures).flat_map(|((patch, pose), &pressure)| {
        let centers = patch.layout().centers().to_vec();
        centers
            .into_iter()
            .map(move |center| (pose.transform_point(center), pressure))
    });
    Ok(BodyPicture {
        scene: scene.name.clone(),
        skin: skin.collect(),
        n_patches,
        touched,
        object: object.moved(&path.at(0.0)).spheres().to_vec(),
    })
}
