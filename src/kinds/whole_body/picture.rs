//! What the scene looks like that touches most of a robot.

use super::objects::of_scene;
use super::plan::{ScenePlan, WholeBodyPlan};
use super::study::{Posture, begin};
use crate::error::Result;
use crate::objects::Sphere;
use crate::table::Table;
use crate::whole_body::CoveredRobot;
use glam::DVec3;

/// What a scene looks like, in the world frame.
#[derive(Clone, Debug)]
pub struct BodyPicture {
    /// The scene.
    pub scene: String,
    /// Places on the skin, metres, some millimetres apart, and the pressure on their patch: force over area, Pa.
    pub skin: Vec<(DVec3, f64)>,
    /// Touched taxels, metres.
    pub touched: Vec<DVec3>,
    /// What touches, metres.
    pub object: Vec<Sphere>,
}

/// Between the places of a picture's skin, metres.
const PICTURE_PITCH: f64 = 4e-3;

/// The scene in which most patches are touched, of those in which any taxel is; the last of equals.
///
/// # Errors
/// As of a run.
pub(super) fn picture_body(plan: &WholeBodyPlan, cases: &Table) -> Result<Option<BodyPicture>> {
    let number = |column, row: &usize| cases.number(column, *row);
    let most = (0..cases.n_rows)
        .filter(|&row| cases.word("series", row) == "scene")
        .filter(|row| number("touched_max", row) > 0.0)
        .max_by(|a, b| {
            let patches = |row| number("patches_touched_mean", row);
            patches(a).total_cmp(&patches(b))
        });
    let name = most.map(|row| cases.word("name", row));
    let mut scenes = plan.scenes.iter();
    let scene = scenes.find(|scene| Some(scene.spec.name.as_str()) == name);
    scene.map(|scene| picture(plan, scene)).transpose()
}

fn picture(plan: &WholeBodyPlan, scene: &ScenePlan) -> Result<BodyPicture> {
    let covered = CoveredRobot::new(&plan.robot, plan.taxel, plan.pitch, plan.side)?;
    let object = of_scene(&scene.spec, plan.surface_error)?;
    let posture = Posture::new(plan, &covered, &scene.positions)?;
    let mut drive = begin(scene, &posture, &object)?;
    let path = drive.path;
    drive.probe(&path);
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
        scene: scene.spec.name.clone(),
        skin: skin.collect(),
        touched,
        object: object.moved(&path.at(0.0)).spheres().to_vec(),
    })
}
