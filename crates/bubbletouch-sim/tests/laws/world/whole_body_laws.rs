//! Laws of a whole body: its kernel agrees with the kernel for skins of any shape, and its cost depends only on the contact.

use bubbletouch_sim::contact::{DamperState, relaxation_factor};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::objects::{Model, Sphere, SphereUnion};
use bubbletouch_sim::whole_body::{
    AT_REST, BodyContact, BodyPatch, BodyState, CoveredRobot, SphereClusters, WholeBody,
};
use bubbletouch_sim::world::{Dome, Extrusion, Grid, Patch, Robot, Taxel, Taxels};
use glam::DVec3;
use rand::Rng;
use std::f64::consts::{PI, TAU};
use std::path::Path;

use crate::counting::{allocations, peak_bytes};
use crate::every_part::{Behind, by_every_part};
use crate::scenes::{Scene, TAXEL, ball, direction, random_pose, rng, touched};

const DT: f64 = 1e-3;

/// Returns a flat patch or a part of a cylinder, some centimetres large.
pub(super) fn random_extrusion(rng: &mut impl Rng) -> Extrusion {
    let pitch = rng.gen_range(1e-3..4e-3);
    let extrusion = if rng.gen_bool(0.4) {
        Extrusion::grid(&Grid {
            nx: rng.gen_range(1..40),
            ny: rng.gen_range(1..40),
            pitch,
        })
    } else {
        let (radius, length) = (rng.gen_range(5e-3..0.05), rng.gen_range(0.0..0.08));
        Extrusion::cylinder(radius, length, rng.gen_range(0.1..TAU), pitch)
    };
    extrusion.unwrap()
}

/// Returns a part of a ball, some centimetres large.
pub(super) fn random_dome(rng: &mut impl Rng) -> Dome {
    let (radius, pitch) = (rng.gen_range(0.01..0.06), rng.gen_range(1e-3..4e-3));
    let (polar, arc) = (rng.gen_range(0.2..PI), rng.gen_range(0.2..TAU));
    let polar = if rng.gen_bool(0.3) { 0.5 * PI } else { polar };
    let arc = if rng.gen_bool(0.3) { TAU } else { arc };
    Dome::new(radius, polar, arc, pitch).unwrap()
}

fn random_body(rng: &mut impl Rng, taxel: Taxel) -> WholeBody {
    let n = rng.gen_range(1..6);
    let patches = (0..n).map(|k| {
        let name = format!("patch {k}");
        match rng.gen_bool(0.3) {
            true => Patch::new(name, random_dome(rng), taxel),
            false => Patch::new(name, random_extrusion(rng), taxel),
        }
    });
    WholeBody::new(&patches.collect::<Result<Vec<_>, _>>().unwrap()).unwrap()
}

/// Returns spheres from a tenth of a millimetre to centimetres.
fn random_union(rng: &mut impl Rng) -> SphereUnion {
    let n = 10f64.powf(rng.gen_range(0.0..2.5)) as usize;
    let spheres = (0..n).map(|_| Sphere {
        center: rng.gen_range(0.0..0.03) * direction(rng),
        radius: 10f64.powf(rng.gen_range(-4.0..-1.7)),
    });
    SphereUnion::new(spheres.collect()).unwrap()
}

/// Returns the patches of a body as skins with any layout.
pub(super) fn as_skins(body: &WholeBody) -> Vec<Patch> {
    let skin = |patch: &BodyPatch| {
        Patch::new(patch.name(), patch.layout(), Taxels::Equal(*patch.taxel())).unwrap()
    };
    body.patches().iter().map(skin).collect()
}

/// Objects, and the poses of the objects and the patches.
struct Touch {
    unions: Vec<SphereUnion>,
    objects: Vec<Pose>,
    patches: Vec<Pose>,
}

impl Touch {
    fn random(rng: &mut impl Rng, body: &WholeBody) -> Self {
        let n_objects = rng.gen_range(1..4);
        let mut poses = |n: usize| -> Vec<Pose> {
            let mut pose = || {
                let distance = rng.gen_range(0.0..0.08);
                random_pose(rng, distance)
            };
            (0..n).map(|_| pose()).collect()
        };
        let (objects, patches) = (poses(n_objects), poses(body.patches().len()));
        Self {
            unions: objects.iter().map(|_| random_union(rng)).collect(),
            objects,
            patches,
        }
    }

    fn clusters(&self) -> Vec<SphereClusters> {
        self.unions.iter().map(SphereClusters::new).collect()
    }

    /// Returns the deflections of one patch by the kernel for any skin.
    fn slowly(&self, patch: usize, skin: &Patch) -> Vec<f64> {
        let models: Vec<Model> = self.unions.iter().cloned().map(Model::from).collect();
        let patch_from_world = self.patches[patch].inverse();
        let objects = self.objects.iter();
        let poses: Vec<Pose> = objects.map(|pose| patch_from_world.compose(pose)).collect();
        touched(skin, &models, &poses).deflections
    }
}

#[test]
fn what_goes_away_leaves_nothing_behind() {
    let mut n_touched = 0;
    for case in 0..20 {
        let mut rng = rng("away", case);
        let body = random_body(&mut rng, TAXEL);
        let mut state = BodyState::at_rest(&body);
        let touch = Touch::random(&mut rng, &body);
        state.place(&body, &touch.patches).unwrap();
        let clusters = touch.clusters();
        n_touched += state
            .press(&body, &clusters, &touch.objects, DT)
            .unwrap()
            .n_touched;
        let away = vec![Pose::from_translation(DVec3::X); clusters.len()];
        let contact = state.press(&body, &clusters, &away, DT).unwrap();
        assert_eq!(contact, BodyContact::default());
        assert_eq!(state.touched(&body).count(), 0);
        let mut all = (0..body.patches().len()).flat_map(|patch| state.deflections(patch));
        assert!(all.all(|&deflection| deflection == 0.0));
    }
    assert!(n_touched > 1000, "{n_touched}");
}

#[test]
fn damped_taxels_relax_and_push_as_dampers_do_until_they_are_at_rest() {
    let taxel = Taxel {
        damping: 5.0,
        ..TAXEL
    };
    let mut n_pushed = 0;
    for case in 0..20 {
        let mut rng = rng("damped", case);
        let body = random_body(&mut rng, taxel);
        let skins = as_skins(&body);
        let mut state = BodyState::at_rest(&body);
        let mut slow: Vec<_> = skins
            .iter()
            .map(|skin| DamperState::at_rest(skin.n_taxels()))
            .collect();
        let mut touch = Touch::random(&mut rng, &body);
        state.place(&body, &touch.patches).unwrap();
        let clusters = touch.clusters();
        for step in 0..40 {
            if step == 20 {
                touch.objects.fill(Pose::from_translation(DVec3::X));
            }
            let dt = rng.gen_range(1e-3..0.05);
            state.press(&body, &clusters, &touch.objects, dt).unwrap();
            for (patch, (skin, slow)) in skins.iter().zip(&mut slow).enumerate() {
                slow.step(skin.taxels(), dt, &touch.slowly(patch, skin));
                for (fast, slow) in state.deflections(patch).iter().zip(&slow.deflection) {
                    assert!((fast - slow).abs() <= AT_REST, "case {case}, step {step}");
                }
            }
            let forces = body.frame(state.forces(&body));
            let slow_forces = slow.iter().flat_map(|slow| &slow.force);
            // Taxels that an earlier step has put to rest are pushed out again.
            let slack = taxel.stiffness * AT_REST / (1.0 - relaxation_factor(&taxel, dt));
            for (fast, slow) in forces.iter().zip(slow_forces) {
                assert!(
                    (fast - slow).abs() <= slack,
                    "case {case}, step {step}: {fast} {slow}"
                );
                n_pushed += usize::from(*fast > 100.0 * slack);
            }
            touch
                .objects
                .iter_mut()
                .for_each(|pose| pose.translation += 1e-3 * direction(&mut rng));
        }
        // The factor e^(−20 · 50 ms · k / c) is far below a nanometre relative to the stroke.
        for _ in 0..40 {
            state.press(&body, &clusters, &touch.objects, 0.05).unwrap();
        }
        assert_eq!(state.touched(&body).count(), 0, "case {case}");
    }
    assert!(n_pushed > 10_000, "{n_pushed}");
}

#[test]
fn without_dampers_the_force_is_that_of_the_spring() {
    let mut n_touched = 0;
    for case in 0..20 {
        let mut rng = rng("springs", case);
        let body = random_body(&mut rng, TAXEL);
        let mut state = BodyState::at_rest(&body);
        for _ in 0..2 {
            let touch = Touch::random(&mut rng, &body);
            state.place(&body, &touch.patches).unwrap();
            n_touched += state
                .press(&body, &touch.clusters(), &touch.objects, DT)
                .unwrap()
                .n_touched;
            let springs = state
                .touched(&body)
                .map(|(taxel, deflection)| (taxel, TAXEL.stiffness * deflection));
            assert!(state.forces(&body).eq(springs));
        }
    }
    assert!(n_touched > 1000, "{n_touched}");
}

#[test]
fn a_step_allocates_nothing_once_the_touch_has_been_seen() {
    let mut rng = rng("allocations", 0);
    let body = random_body(&mut rng, TAXEL);
    let mut state = BodyState::at_rest(&body);
    let touch = Touch::random(&mut rng, &body);
    let clusters = touch.clusters();
    let mut step = || {
        state.place(&body, &touch.patches).unwrap();
        state.press(&body, &clusters, &touch.objects, DT).unwrap();
    };
    step();
    assert_eq!(allocations(step), 0);
}

#[test]
fn a_body_at_rest_has_a_few_bytes_a_taxel() {
    let (mut n_taxels, mut n_bytes, mut kept) = (0, 0, None);
    let bytes = peak_bytes(|| {
        let sleeve = Extrusion::cylinder(0.06, 0.2, 3.0, 1e-3).unwrap();
        let patches = (0..20).map(|k| Patch::new(format!("{k}"), sleeve.clone(), TAXEL).unwrap());
        let body = WholeBody::new(&patches.collect::<Vec<_>>()).unwrap();
        let state = BodyState::at_rest(&body);
        (n_taxels, n_bytes) = (body.n_taxels(), body.n_bytes() + state.n_bytes());
        kept = Some(state);
    });
    drop(kept);
    let share = bytes as f64 / n_taxels as f64;
    assert!(
        n_taxels > 700_000 && (8.0..10.0).contains(&share),
        "{share} bytes a taxel"
    );
    let said = n_bytes as f64 / bytes as f64;
    assert!((said - 1.0).abs() < 0.02, "{n_bytes} of {bytes} bytes");
}

#[test]
fn bad_taxels_and_names_are_refused() {
    let (nx, ny, pitch) = (2, 2, 1e-3);
    let extrusion = Extrusion::grid(&Grid { nx, ny, pitch }).unwrap();
    let palm = |taxels: Taxels| Patch::new("palm", extrusion.clone(), taxels);
    let soft = Taxel {
        stiffness: 0.0,
        ..TAXEL
    };
    let endless = Taxel {
        stroke: f64::NAN,
        ..TAXEL
    };
    let same = palm(TAXEL.into()).unwrap();
    let each = palm(Taxels::Each(vec![TAXEL; 4])).unwrap();
    for (error, said) in [
        (
            palm(soft.into()).unwrap_err(),
            "skin patch palm, taxel stiffness: 0 N/m; a finite positive number",
        ),
        (
            palm(endless.into()).unwrap_err(),
            "skin patch palm, taxel stroke: NaN m; a finite positive number",
        ),
        (
            WholeBody::new(&[each]).unwrap_err(),
            "body patch palm, taxels: one each; one taxel for all places",
        ),
        (
            WholeBody::new(&[same.clone(), same]).unwrap_err(),
            "body: two patches called `palm`; a name of its own for each",
        ),
    ] {
        assert_eq!(error.to_string(), said);
    }
}

fn humanoid() -> Robot {
    Robot::read(Path::new("../../objects/robots/humanoid.urdf")).unwrap()
}

#[test]
fn the_humanoid_has_two_million_taxels_in_about_two_hundred_patches() {
    let covered = CoveredRobot::new(&humanoid(), TAXEL, 1e-3, 0.1).unwrap();
    let (n_taxels, n_patches) = (covered.body().n_taxels(), covered.body().patches().len());
    assert!((2_000_000..2_050_000).contains(&n_taxels), "{n_taxels}");
    assert!((190..=210).contains(&n_patches), "{n_patches}");
}

#[test]
fn taxels_of_a_covered_robot_are_a_pitch_apart_across_seams_too() {
    let (robot, pitch) = (humanoid(), 8e-3);
    let covered = CoveredRobot::new(&robot, TAXEL, pitch, 0.1).unwrap();
    let mut poses = Vec::new();
    let still = vec![0.0; robot.n_positions()];
    let links = robot.forward(&Pose::IDENTITY, &still).unwrap();
    covered.patch_poses(&links, &mut poses);
    // Only patches of one limb are used, so that nothing else is near. Its half balls, whose poles are less even, only serve as neighbours.
    let patches = covered.body().patches().iter().zip(&poses);
    let limb = patches.filter(|(patch, _)| patch.name().starts_with("left_shank "));
    let centers: Vec<(bool, DVec3)> = limb
        .flat_map(|(patch, pose)| {
            let is_side = !patch.name().contains("cap");
            let centers = patch.layout().centers().to_vec();
            centers
                .into_iter()
                .map(move |center| (is_side, pose.transform_point(center)))
        })
        .collect();
    assert!(centers.len() > 1000, "{}", centers.len());
    for (_, center) in centers.iter().filter(|(is_side, _)| *is_side) {
        let mut distances: Vec<f64> = centers
            .iter()
            .map(|(_, other)| other.distance(*center))
            .collect();
        distances.sort_by(f64::total_cmp);
        // At the ends of the limb a taxel has three neighbours.
        for distance in &distances[1..4] {
            assert!((distance / pitch - 1.0).abs() < 0.15, "{distance}");
        }
    }
}

#[test]
fn patches_go_with_their_links() {
    let robot = humanoid();
    let covered = CoveredRobot::new(&robot, TAXEL, 8e-3, 0.1).unwrap();
    let mut positions = vec![0.0; robot.n_positions()];
    let poses = |positions: &[f64]| {
        let mut poses = Vec::new();
        let links = robot.forward(&Pose::IDENTITY, positions).unwrap();
        covered.patch_poses(&links, &mut poses);
        poses
    };
    let before = poses(&positions);
    let elbow = robot.joint("left_elbow").unwrap();
    let (coordinate, ..) = robot.drive_of(elbow).unwrap();
    positions[coordinate] = -1.0;
    let after = poses(&positions);
    for ((patch, before), after) in covered.body().patches().iter().zip(&before).zip(&after) {
        let is_below = ["left_forearm", "left_hand"]
            .iter()
            .any(|link| patch.name().starts_with(link));
        let moved = before.translation.distance(after.translation) > 1e-3;
        assert_eq!(moved, is_below, "{}", patch.name());
    }
}

#[test]
fn a_robot_with_nothing_to_cover_and_a_pitch_that_is_none_are_refused() {
    let tiny = Dome::new(1e-3, 1.0, 1.0, 1e-4).unwrap();
    let pin = Patch::new("pin", tiny, TAXEL).unwrap();
    let bare = CoveredRobot::new(&Robot::floating("ghost"), TAXEL, 1e-3, 0.1);
    for (error, said) in [
        (bare.unwrap_err(), "robot ghost: nothing to cover; "),
        (
            WholeBody::new(&[pin]).unwrap_err(),
            "body patch pin, dome radius: 0.001 m; ",
        ),
        (
            CoveredRobot::new(&humanoid(), TAXEL, -1.0, 0.1).unwrap_err(),
            "skin of pelvis, taxel pitch: -1 m; ",
        ),
    ] {
        assert!(error.to_string().starts_with(said), "{error}");
    }
}

/// Robot hand made of a box and two fingers. One finger ends flat and free, the other in a ball, and both begin within the box.
const HAND: &str = r#"<robot name="hand"><link name="palm">
    <collision><origin xyz="0 0 0.02"/><geometry><box size="0.08 0.03 0.1"/></geometry></collision>
    <collision><origin xyz="0.02 0 0.09"/><geometry><cylinder radius="0.01" length="0.06"/></geometry></collision>
    <collision><origin xyz="-0.02 0 0.09"/><geometry><cylinder radius="0.01" length="0.06"/></geometry></collision>
    <collision><origin xyz="-0.02 0 0.12"/><geometry><sphere radius="0.01"/></geometry></collision>
</link></robot>"#;

#[test]
fn faces_of_boxes_are_covered_and_flat_ends_in_the_open_if_they_are_asked_for() {
    let hand = Robot::from_urdf("hand.urdf", HAND).unwrap();
    let pitch = 2e-3;
    let bare = CoveredRobot::new(&hand, TAXEL, pitch, 0.04).unwrap();
    let covered = CoveredRobot::with_flat_ends(&hand, TAXEL, pitch, 0.04).unwrap();
    let names = |covered: &CoveredRobot, part: &str| -> Vec<String> {
        let patches = covered.body().patches().iter();
        let names = patches.map(|patch| patch.name().to_owned());
        names.filter(|name| name.contains(part)).collect()
    };
    assert_eq!(names(&bare, " end "), [""; 0]);
    assert_eq!(names(&covered, " end "), ["palm end 1"]);
    // Sides of 30 mm stay whole; sides of 100 mm are divided into three.
    let face = ["palm face 1 1.1", "palm face 1 2.1", "palm face 1 3.1"];
    assert_eq!(names(&bare, "face 1 "), face);
    assert_eq!(names(&covered, "face 1 "), face);
    let mut poses = Vec::new();
    covered.patch_poses(&[Pose::IDENTITY], &mut poses);
    let mut n_on_faces = [0; 6];
    for (patch, pose) in covered.body().patches().iter().zip(&poses) {
        let layout = patch.layout();
        for (&center, &axis) in layout.centers().iter().zip(layout.axes()) {
            let (center, axis) = (pose.transform_point(center), pose.transform_vector(axis));
            if patch.name().contains(" end ") {
                assert!((center.z - 0.12).abs() < 1e-12 && axis.distance(DVec3::Z) < 1e-12);
                assert!(center.truncate().distance(DVec3::X.truncate() * 0.02) < 0.01);
            } else if patch.name().contains(" face ") {
                let from_middle = center - 0.02 * DVec3::Z;
                let half = 0.5 * DVec3::new(0.08, 0.03, 0.1);
                let out = from_middle.dot(axis);
                assert!(
                    (out - half.dot(axis.abs())).abs() < 1e-12,
                    "on the face: {out}"
                );
                assert!((from_middle.abs() - half).max_element() < 1e-12);
                let face = 2 * axis.abs().max_position() + usize::from(axis.element_sum() < 0.0);
                n_on_faces[face] += 1;
                assert!(patch.name().contains(&format!(" face {} ", face + 1)));
            }
        }
    }
    for (face, n) in n_on_faces.into_iter().enumerate() {
        let [width, height] = [1, 2].map(|next| [0.08, 0.03, 0.1][(face / 2 + next) % 3]);
        let expected = width * height / (pitch * pitch);
        assert!(
            (f64::from(n) / expected - 1.0).abs() < 0.05,
            "face {face}: {n}"
        );
    }
}

#[test]
fn a_ball_on_a_box_and_on_a_flat_end_is_felt_as_by_any_skin() {
    let hand = Robot::from_urdf("hand.urdf", HAND).unwrap();
    let covered = CoveredRobot::with_flat_ends(&hand, TAXEL, 2e-3, 0.04).unwrap();
    let body = covered.body();
    let mut poses = Vec::new();
    covered.patch_poses(&[Pose::IDENTITY], &mut poses);
    let mut state = BodyState::at_rest(body);
    state.place(body, &poses).unwrap();
    let on_end = DVec3::new(0.021, 1e-3, 0.1295);
    let on_face = DVec3::new(0.0, -0.0245, 0.03);
    for place in [on_end, on_face] {
        let clusters = [SphereClusters::new(&ball(0.01))];
        let at = Pose::from_translation(place);
        let contact = state.press(body, &clusters, &[at], DT).unwrap();
        assert!(contact.n_touched > 4, "{place}: {contact:?}");
        for (number, (patch, pose)) in as_skins(body).into_iter().zip(&poses).enumerate() {
            let scene = Scene::new(patch, ball(0.01), at.seen_from(pose));
            let expected = by_every_part(&scene, Behind::Ignored);
            for (found, expected) in state.deflections(number).iter().zip(expected) {
                let error = (found - expected.deflection).abs();
                assert!(error < 1e-12, "patch {number}: {found} {expected:?}");
            }
        }
    }
}
