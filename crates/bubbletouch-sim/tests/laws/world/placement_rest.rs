//! Laws of resting poses, on unions of spheres whose poses are known.

use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::objects::{Sphere, SphereUnion};
use bubbletouch_sim::random::Seed;
use bubbletouch_sim::world::{RestPose, as_modelled, stable_poses, stable_poses_about};
use glam::{DQuat, DVec3};
use rand::Rng;
use std::f64::consts::{PI, TAU};

fn union(points: impl IntoIterator<Item = DVec3>, radius: f64) -> SphereUnion {
    let sphere = |center| Sphere { center, radius };
    SphereUnion::new(points.into_iter().map(sphere).collect()).unwrap()
}

/// Creates a block of spheres of 2 mm radius with these edge lengths.
fn block(size: DVec3) -> SphereUnion {
    let radius = 2e-3;
    let counts = (size / 3e-3).ceil();
    let along = |axis: usize, i: usize| {
        let inner = size[axis] - 2.0 * radius;
        radius + inner * i as f64 / (counts[axis] - 1.0)
    };
    let counts = counts.to_array().map(|n| n as usize);
    let mut points = Vec::new();
    for i in 0..counts[0] {
        for j in 0..counts[1] {
            for k in 0..counts[2] {
                points.push(DVec3::new(along(0, i), along(1, j), along(2, k)));
            }
        }
    }
    union(points, radius)
}

/// Creates a solid of revolution of height `length` and radius `profile(z)`, as rings of spheres of 2 mm radius on its surface.
fn revolution(length: f64, n_around: usize, profile: impl Fn(f64) -> f64) -> SphereUnion {
    let radius = 2e-3;
    let n_rings = 40;
    let mut points = Vec::new();
    for ring in 0..=n_rings {
        let z = length * ring as f64 / n_rings as f64;
        let reach = profile(z) - radius;
        let steps = if ring == 0 || ring == n_rings { 8 } else { 1 };
        for step in 0..steps {
            let reach = reach * (steps - step) as f64 / steps as f64;
            for i in 0..n_around {
                let angle = TAU * i as f64 / n_around as f64;
                let lift = radius + z * (1.0 - 2.0 * radius / length);
                points.push(DVec3::new(reach * angle.cos(), reach * angle.sin(), lift));
            }
        }
    }
    union(points, radius)
}

fn capsule(radius: f64, length: f64) -> SphereUnion {
    let n = 60;
    let places = (0..=n).map(|i| DVec3::new(0.0, 0.0, radius + length * i as f64 / n as f64));
    union(places, radius)
}

fn heights(poses: &[RestPose]) -> Vec<f64> {
    let mut heights: Vec<_> = poses.iter().map(|pose| pose.height).collect();
    heights.sort_by(f64::total_cmp);
    heights
}

/// Returns the height h(d) = max (c · d + r) − com · d over all spheres.
fn standing(spheres: &SphereUnion, com: DVec3, down: DVec3) -> f64 {
    let reach = |s: &Sphere| (s.center - com).dot(down) + s.radius;
    spheres
        .spheres()
        .iter()
        .map(reach)
        .fold(f64::NEG_INFINITY, f64::max)
}

fn assert_rests_on_table(spheres: &SphereUnion, pose: &RestPose) {
    let bounds = spheres.moved(&pose.table_from_object).bounds();
    assert!(bounds.min.z.abs() < 1e-12);
    assert!((bounds.max.z - pose.height).abs() < 1e-12);
    assert!(bounds.center().truncate().length() < 1e-12);
}

fn assert_local_minima(spheres: &SphereUnion, com: DVec3, poses: &[RestPose]) {
    let mut rng = Seed::new(11).rng();
    for pose in poses {
        let down = pose.table_from_object.rotation.conjugate() * DVec3::NEG_Z;
        let height = standing(spheres, com, down);
        for tip in [1e-5, 1e-4, 1e-3, 5e-3] {
            for _ in 0..200 {
                let turn = TAU * rng.r#gen::<f64>();
                let (u, v) = down.any_orthonormal_pair();
                let tipped = (down + tip * (turn.cos() * u + turn.sin() * v)).normalize();
                let rise = standing(spheres, com, tipped) - height;
                assert!(rise > -1e-10, "tipped by {tip}: {rise} m");
            }
        }
    }
}

#[test]
fn a_block_rests_on_its_six_faces_the_largest_likeliest() {
    let size = DVec3::new(0.03, 0.05, 0.08);
    let poses = stable_poses(&block(size).into());
    assert_eq!(poses.len(), 6);
    let exact = [0.03, 0.03, 0.05, 0.05, 0.08, 0.08];
    for (pose, exact) in poses.iter().zip(exact) {
        assert!((pose.height - exact).abs() < 1e-9, "{poses:?}");
        assert_rests_on_table(&block(size), pose);
    }
    // Spheres round the edges off, so the box of the centres decides. The solid angle of a face, seen from the middle, is
    // 4 asin(bc / √((a² + b²)(a² + c²))), where a is the distance between the faces.
    let [a, b, c] = (size - 4e-3).to_array();
    let share = |a: f64, b: f64, c: f64| {
        let root = ((a * a + b * b) * (a * a + c * c)).sqrt();
        (b * c / root).asin() / PI
    };
    for (pose, exact) in
        poses
            .iter()
            .step_by(2)
            .zip([share(a, b, c), share(b, a, c), share(c, a, b)])
    {
        assert!(
            (pose.probability - exact).abs() < 0.01,
            "{} {exact}",
            pose.probability
        );
    }
}

#[test]
fn a_ball_has_one_pose_whether_one_sphere_or_many() {
    let one = union([DVec3::new(0.1, 0.2, 0.3)], 0.03);
    assert_eq!(stable_poses(&one.clone().into()).len(), 1);
    let n = 1500;
    let many = union(
        (0..n).map(|i| {
            let z = 1.0 - (2 * i + 1) as f64 / n as f64;
            let (sin, cos) = (2.399963229728653 * i as f64).sin_cos();
            let flat = (1.0 - z * z).sqrt();
            0.028 * DVec3::new(flat * cos, flat * sin, z)
        }),
        2e-3,
    );
    let poses = stable_poses(&many.clone().into());
    assert_eq!(poses.len(), 1);
    assert_eq!(poses[0].probability, 1.0);
    assert_eq!(poses, stable_poses(&many.clone().into()));
}

#[test]
fn a_long_capsule_lies_on_its_side() {
    let poses = stable_poses(&capsule(0.01, 0.1).into());
    assert_eq!(poses.len(), 1, "{poses:?}");
    assert!((poses[0].height - 0.02).abs() < 1e-9);
}

#[test]
fn a_can_stands_on_either_end_or_lies_on_its_side() {
    let (radius, length) = (0.034, 0.1);
    let can = revolution(length, 60, |_| radius);
    let poses = stable_poses(&can.clone().into());
    assert_eq!(poses.len(), 3, "{poses:?}");
    // The side corresponds to the band of directions up to where the centre of mass is over the rim's sphere centres.
    let (half, rim) = (length / 2.0 - 2e-3, radius - 2e-3);
    let side = half / half.hypot(rim);
    assert!(
        (poses[0].probability - side).abs() < 0.01,
        "{poses:?} {side}"
    );
    assert!((poses[0].height - 2.0 * radius).abs() < 2e-4);
    for end in &poses[1..] {
        assert!((end.height - length).abs() < 1e-9);
        assert_rests_on_table(&can, end);
    }
}

#[test]
fn a_cone_rests_on_its_base_or_its_flank() {
    let cone = revolution(0.08, 60, |z| 0.03 - 0.3 * z);
    let poses = stable_poses(&cone.clone().into());
    assert_eq!(poses.len(), 2, "{poses:?}");
    assert_local_minima(&cone, cone.center_of_mass(), &poses);
}

#[test]
fn a_weighted_ball_stands_with_its_weight_down() {
    // A smooth minimum, without faces and edges.
    let ball = union([DVec3::ZERO], 0.05);
    let com = DVec3::new(0.006, -0.012, 0.004);
    let poses = stable_poses_about(&ball.into(), com);
    assert_eq!(poses.len(), 1);
    let down = poses[0].table_from_object.rotation.conjugate() * DVec3::NEG_Z;
    assert!(down.angle_between(com) < 1e-6, "{down}");
}

#[test]
fn every_pose_is_a_local_minimum_of_the_height_of_the_centre_of_mass() {
    let mut rng = Seed::new(7).rng();
    for n in [4, 5, 8, 20, 200] {
        let mut random = || 0.1 * (rng.r#gen::<f64>() - 0.5);
        let points: Vec<_> = (0..n)
            .map(|_| DVec3::new(random(), random(), random()))
            .collect();
        let spheres = union(points, 0.01);
        let com = spheres.center_of_mass();
        let poses = stable_poses(&spheres.clone().into());
        assert_local_minima(&spheres, com, &poses);
        assert!((poses.iter().map(|p| p.probability).sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(
            poses
                .windows(2)
                .all(|p| p[0].probability >= p[1].probability)
        );
        for pose in &poses {
            assert_rests_on_table(&spheres, pose);
        }
    }
}

#[test]
fn a_turned_object_has_the_same_poses() {
    let size = DVec3::new(0.03, 0.05, 0.08);
    let (block, com) = (block(size), 0.5 * size);
    let before = heights(&stable_poses_about(&block.clone().into(), com));
    let mut rng = Seed::new(3).rng();
    for _ in 0..5 {
        let mut random = || rng.r#gen::<f64>() - 0.5;
        let rotation = DQuat::from_xyzw(random(), random(), random(), random()).normalize();
        let turn = Pose::new(rotation, DVec3::new(random(), random(), random()));
        let poses = stable_poses_about(&block.moved(&turn).into(), turn.transform_point(com));
        let after = heights(&poses);
        assert_eq!(before.len(), after.len());
        for (before, after) in before.iter().zip(after) {
            assert!((before - after).abs() < 1e-9);
        }
    }
}

#[test]
fn as_modelled_keeps_z_up_and_sets_the_object_down_in_the_middle() {
    let block = block(DVec3::new(0.03, 0.05, 0.08));
    let lifted = block.moved(&Pose::from_translation(DVec3::new(1.0, 2.0, 3.0)));
    let pose = as_modelled(&lifted.clone().into());
    assert_eq!(pose.table_from_object.rotation, DQuat::IDENTITY);
    assert_eq!(pose.probability, 1.0);
    assert_rests_on_table(&lifted, &pose);
}
