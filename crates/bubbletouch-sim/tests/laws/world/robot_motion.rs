//! Laws of trajectories of robots and bodies: smooth between waypoints, and within limits at all times.

use crate::cases::{cases, replaced};
use crate::counting::allocations;
use bubbletouch_sim::Result;
use bubbletouch_sim::geometry::{Pose, rotation_from_rpy};
use bubbletouch_sim::random::Seed;
use bubbletouch_sim::world::{
    Interpolation, JointTrajectory, Motion, Phase, PoseTrajectory, Robot, VelocityPlan,
};
use glam::{DQuat, DVec3};
use ndarray::{Array2, array};
use rand::Rng;
use std::f64::consts::PI;

const INTERPOLATIONS: [Interpolation; 3] = [
    Interpolation::Linear,
    Interpolation::Cubic,
    Interpolation::Monotone,
];

/// Times of the waypoints in robots/splines.py.
const TIMES: [f64; 5] = [0.0, 0.5, 1.7, 2.0, 4.0];
const VALUES: [f64; 5] = [0.0, 1.0, 1.2, -0.7, 0.4];

/// Creates a robot with two hinges and a slide; `follower` turns twice as far as `hinge`, in the opposite direction.
fn robot(hinge_limits: &str) -> Robot {
    let text = format!(
        r#"<robot name="r"><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
        <joint name="hinge" type="revolute"><parent link="a"/><child link="b"/><limit {hinge_limits} effort="1"/></joint>
        <joint name="follower" type="revolute"><parent link="b"/><child link="c"/>
          <limit lower="-9" upper="9" velocity="90" effort="1"/><mimic joint="hinge" multiplier="-2" offset="0.5"/></joint>
        <joint name="slide" type="prismatic"><parent link="c"/><child link="d"/>
          <limit lower="0" upper="0.1" velocity="9" effort="1"/></joint>
        </robot>"#
    );
    Robot::from_urdf("r.urdf", &text).expect("a sound robot")
}

fn free() -> Robot {
    robot(r#"lower="-9" upper="9" velocity="90""#)
}

/// Returns a trajectory of the hinge through these values at 0, 1, 2, … s; the slide stays at rest.
fn hinge(robot: &Robot, values: &[f64], kind: Interpolation) -> Result<JointTrajectory> {
    let times = (0..values.len()).map(|i| i as f64).collect();
    let mut positions = Array2::zeros((values.len(), 2));
    positions.column_mut(0).assign(&ndarray::aview1(values));
    JointTrajectory::new(robot, times, positions, kind)
}

#[test]
fn splines_are_those_of_an_independent_program() {
    use Interpolation::{Cubic, Monotone};
    let positions = Array2::from_shape_fn((5, 2), |(i, k)| if k == 0 { VALUES[i] } else { 0.05 });
    for (kind, time, value, velocity) in [
        (Cubic, 0.25, 0.31198778565799834, 2.247951142631994),
        (Cubic, 1.0, 2.262217899045617, 1.5405256763856046),
        (Cubic, 1.9, -0.07585798091235388, -6.592534804307855),
        (Cubic, 3.1, -1.3458535904255333, 2.495035017730494),
        (Monotone, 1.0, 1.134460719251675, 0.19228763746681832),
        (Monotone, 1.9, -0.20740740740740682, -8.44444444444445),
    ] {
        let through = JointTrajectory::new(&free(), TIMES.to_vec(), positions.clone(), kind);
        let through = through.unwrap();
        let found = [
            through.positions_at(time)[0],
            through.velocities_at(time)[0],
        ];
        for (found, expected) in found.into_iter().zip([value, velocity]) {
            assert!((found - expected).abs() < 1e-12, "{found}, {expected}");
        }
    }
}

#[test]
fn the_ends_hold_and_way_points_are_passed_exactly() {
    for kind in INTERPOLATIONS {
        let trajectory = hinge(&free(), &VALUES, kind).unwrap();
        for (i, &value) in VALUES.iter().enumerate() {
            assert_eq!(trajectory.positions_at(i as f64), [value, 0.0]);
        }
        assert_eq!(trajectory.positions_at(-3.0)[0], VALUES[0]);
        assert_eq!(trajectory.positions_at(f64::INFINITY)[0], VALUES[4]);
        assert_eq!(trajectory.velocities_at(99.0), [0.0, 0.0]);
        if kind != Interpolation::Linear {
            assert_eq!(trajectory.velocities_at(0.0), [0.0, 0.0]);
            assert!(trajectory.velocities_at(4.0 - 1e-12)[0].abs() < 1e-10);
        }
        assert_eq!(trajectory.end(), 4.0);
    }
    let one = hinge(&free(), &[0.3], Interpolation::Cubic).unwrap();
    let found = [-1.0, 1.0].map(|time| one.positions_at(time)[0]);
    assert_eq!(found, [0.3, 0.3]);
}

#[test]
fn a_limit_passed_between_legal_way_points_is_found() {
    let robot = robot(r#"lower="-1" upper="1.05" velocity="90""#);
    let values = [0.0, 1.0, 1.0, 0.0];
    // All waypoints and the straight lines between them are within the limits.
    for kind in [Interpolation::Linear, Interpolation::Monotone] {
        hinge(&robot, &values, kind).expect("nothing leaves the way-points");
    }
    let error = hinge(&robot, &values, Interpolation::Cubic).unwrap_err();
    let expected = "joint trajectory: joint `hinge`: 1.250000 rad (71.62°) at 1.5000 s (between way-point 2 and way-point 3); \
                    at most 1.050000 rad (60.16°)";
    assert_eq!(error.to_string(), expected);
}

#[test]
fn a_velocity_passed_between_slow_way_points_is_found() {
    let robot = robot(r#"lower="-9" upper="9" velocity="1.2""#);
    // At rest at both ends, one radian in one second has a speed of 1.5 rad/s half-way.
    hinge(&robot, &[0.0, 1.0], Interpolation::Linear).expect("1 rad/s");
    let expected = "joint trajectory: joint `hinge`: velocity -1.500000 rad/s at 0.5000 s (between way-point 1 and way-point 2); \
                    at most 1.200000 rad/s";
    for kind in [Interpolation::Cubic, Interpolation::Monotone] {
        let error = hinge(&robot, &[0.0, -1.0], kind).unwrap_err();
        assert_eq!(error.to_string(), expected);
    }
}

#[test]
fn a_joint_that_mimics_goes_beyond_its_own_limits_with_a_note() {
    let within = hinge(&free(), &[0.0, 4.5], Interpolation::Linear).expect("-8.5 rad");
    assert!(within.notes().is_empty());
    let beyond = hinge(&free(), &[0.0, 4.8], Interpolation::Linear).expect("-9.1 rad");
    assert_eq!(beyond.positions_at(1.0)[0], 4.8);
    let expected = "joint trajectory: joint `follower`: -9.100000 rad (-521.39°) at 1.0000 s (way-point 2); \
                    at least -9.000000 rad (-515.66°): it mimics `hinge`, whatever its own limits";
    assert_eq!(beyond.notes(), [expected]);
}

#[test]
fn a_joint_that_no_column_moves_rests() {
    let robot = robot(r#"lower="0.2" upper="9" velocity="90""#);
    let csv = "time_s,slide_mm\n0,10\n1,20\n";
    let read = JointTrajectory::read_csv(&robot, "t.csv", csv.as_bytes(), Interpolation::Linear);
    assert_eq!(read.unwrap().positions_at(0.5), [0.2, 0.015]);
}

#[test]
fn a_quarter_turn_is_within_a_limit_of_six_digits_and_no_more_is() {
    let robot = robot(r#"lower="-1.570796" upper="1.570796" velocity="9""#);
    let quarter = 90_f64.to_radians();
    for kind in INTERPOLATIONS {
        hinge(&robot, &[-quarter, quarter], kind).expect("3e-7 rad beyond");
        hinge(&robot, &[-quarter, quarter + 1e-6], kind).expect_err("1.3e-6 rad beyond");
    }
}

/// The closed form is compared with a search at 10,000 samples per second, on curves of all kinds.
#[test]
fn a_trajectory_is_refused_exactly_when_a_fine_search_finds_it_beyond() {
    let mut rng = Seed::new(2018).named("trajectories").rng();
    let (mut n_legal, mut n_beyond) = (0, 0);
    for case in 0..120 {
        let kind = INTERPOLATIONS[case % 3];
        let values: Vec<f64> = (0..4).map(|_| rng.gen_range(-1.0..1.0)).collect();
        let trajectory = hinge(&free(), &values, kind).unwrap();
        let times = (0..30_000).map(|i| 1e-4 * f64::from(i));
        let most = |of: &dyn Fn(f64) -> f64| times.clone().map(of).fold(0.0, f64::max);
        let position = most(&|time| trajectory.positions_at(time)[0].abs());
        let velocity = most(&|time| trajectory.velocities_at(time)[0].abs());
        for (position_share, velocity_share) in [(1.001, 1.001), (0.999, 9.0), (9.0, 0.999)] {
            let bound = position * position_share;
            let speed = velocity * velocity_share;
            let limits = format!(r#"lower="-{bound}" upper="{bound}" velocity="{speed}""#);
            let is_legal = hinge(&robot(&limits), &values, kind).is_ok();
            let expected = position_share > 1.0 && velocity_share > 1.0;
            assert_eq!(is_legal, expected, "{kind:?} {values:?}");
            n_legal += usize::from(is_legal);
            n_beyond += usize::from(!is_legal);
        }
    }
    assert_eq!((n_legal, n_beyond), (120, 240));
}

const CSV: &str = "time_s,slide_mm,hinge_deg\n0,10,0\n1.5, 20,90\n2,0,-45\n";

fn read(text: &str) -> Result<JointTrajectory> {
    JointTrajectory::read_csv(&free(), "t.csv", text.as_bytes(), Interpolation::Cubic)
}

#[test]
fn csv_columns_come_in_any_order_and_in_their_units() {
    let trajectory = read(CSV).unwrap();
    let found = trajectory.positions_at(1.5);
    assert_eq!(found, [90_f64.to_radians(), 0.02]);
    let same = read(
        "hinge,slide_m,time_s\n0,0.01,0\n1.5707963267948966,0.02,1.5\n-0.7853981633974483,0,2\n",
    )
    .unwrap();
    for time in [0.3, 1.7] {
        let pairs = trajectory.positions_at(time).into_iter();
        let mut pairs = pairs.zip(same.positions_at(time));
        assert!(pairs.all(|(a, b)| (a - b).abs() < 1e-15));
    }
}

/// Text of `CSV` | wrong text | message after `t.csv`.
const BAD_TABLES: &str = r#"
    90 | nan | , line 3, column hinge_deg: `nan`; a finite number
    90 | | , line 3, column hinge_deg: ``; a finite number
    20,90 | 20 | , line 3: 2 columns; 3 columns in every row
    2,0 | 1.5,0 | , line 4: time 1.5 s after 1.5 s; strictly ascending times
    time_s | time_ms | , line 1: no column time_s; times in seconds
    hinge_deg | hing_deg | , line 1: column `hing_deg`; one of `hinge`, `slide`
    hinge_deg | hinge_mm | , line 1: column `hinge_mm`; one of `hinge`, `slide`
    hinge_deg\n0,10,0\n1.5, 20,90\n2,0,-45 | hinge,hinge_deg\n0,10,0,0 | , line 1: a second column for hinge: `hinge_deg`; one column each
    hinge_deg\n0,10,0\n1.5, 20,90\n2,0,-45 | hinge_deg,follower\n0,10,0,0 | , line 1: a column for `follower`, which mimics another joint; only the joint that it follows
    hinge_deg\n0,10,0\n1.5, 20,90\n2,0,-45 | hinge_deg,sldie\n0,10,0,0 | , line 1: column `sldie`; perhaps `slide`
    ,slide_mm,hinge_deg\n0,10,0\n1.5, 20,90\n2,0,-45 | \n0 | , line 1: no column of a joint; `hinge`, `slide`
    20 | 101 | : joint `slide`: 0.130850 m at 1.1862 s (between line 2 and line 3); at most 0.100000 m
    0,10,0\n1.5, 20,90\n2,0,-45\n | | : no way-points; at least one
    time_s,slide_mm,hinge_deg\n0,10,0\n1.5, 20,90\n2,0,-45\n | | : an empty file; a header with time_s, then way-points
    1.5, | 1e-310, | : `hinge` with an endless velocity; way-points farther apart in time
"#;

#[test]
fn a_bad_csv_is_refused_with_its_line() {
    for [old, new, sentence] in cases(BAD_TABLES) {
        let error = read(&replaced(CSV, &old, &new)).expect_err(&sentence);
        assert_eq!(error.to_string(), format!("t.csv{sentence}"));
        assert_eq!(error.exit_code(), 2);
    }
    let latin = &b"time_s,\xe9\n"[..];
    let latin = JointTrajectory::read_csv(&free(), "t.csv", latin, Interpolation::Linear);
    assert_eq!(latin.unwrap_err().exit_code(), 2);
}

#[test]
fn bad_arguments_are_refused_with_their_way_point() {
    let new = |times: Vec<f64>, positions| {
        let trajectory = JointTrajectory::new(&free(), times, positions, Interpolation::Cubic);
        trajectory.unwrap_err().to_string()
    };
    assert_eq!(
        new(vec![0.0, 1.0], array![[0.0, 0.0], [f64::NAN, 0.0]]),
        "joint trajectory, way-point 2: NaN; finite numbers"
    );
    assert_eq!(
        new(vec![0.0], array![[0.0]]),
        "joint trajectory: 1 positions a way-point; the 2 of robot `r`"
    );
    assert_eq!(
        new(vec![0.0], array![[0.0, 0.0], [1.0, 0.0]]),
        "joint trajectory: 1 times for 2 way-points; a time each"
    );
}

#[test]
fn a_pose_passes_its_way_points_and_a_steady_turn_stays_steady() {
    let turn = |angle: f64| Pose::new(DQuat::from_rotation_z(angle), DVec3::new(angle, 0.0, 1.0));
    let poses = [0.0, 0.5, 1.0, 1.5, 2.0].map(turn);
    let times = vec![0.0, 1.0, 2.0, 3.0, 4.0];
    for kind in INTERPOLATIONS {
        let trajectory = PoseTrajectory::new(times.clone(), &poses, kind).unwrap();
        for (&time, pose) in times.iter().zip(&poses) {
            let found = trajectory.pose_at(time);
            assert!(found.translation == pose.translation);
            assert!((found.rotation.dot(pose.rotation).abs() - 1.0).abs() < 1e-15);
        }
        // Far from the ends, the interpolation of a rotation equals the interpolation of a position.
        for time in [1.25, 2.0, 2.6] {
            let angle = 2.0 * trajectory.pose_at(time).rotation.z.asin();
            let error = (angle - 0.5 * time).abs();
            assert!(error < 1e-12, "{kind:?} {time}: {angle}");
        }
        assert_eq!(trajectory.pose_at(-1.0), poses[0]);
        assert_eq!(trajectory.pose_at(5.0), poses[4]);
    }
}

#[test]
fn one_angle_of_the_way_points_turns_by_its_change() {
    let degrees = |angles: [f64; 3]| DVec3::from_array(angles.map(f64::to_radians));
    let start = [20.0, -35.0, 50.0];
    for (axis, change) in (0..3)
        .flat_map(|axis| [90.0, 180.0, 270.0, 360.0, -540.0, 725.0].map(|change| (axis, change)))
    {
        let angles = |share: f64| {
            let mut angles = start;
            angles[axis] += share * change;
            degrees(angles)
        };
        let csv = [0.0, 1.0].map(|share| {
            let [roll, pitch, yaw] = angles(share).to_array();
            format!("{share},0,0,0,{roll},{pitch},{yaw}\n")
        });
        let csv = format!("time_s,x,y,z,roll,pitch,yaw\n{}", csv.concat());
        for kind in INTERPOLATIONS {
            let way_points = [0.0, 1.0].map(|share| [DVec3::ZERO, angles(share)]);
            let given = PoseTrajectory::from_rpy(vec![0.0, 1.0], &way_points, kind).unwrap();
            let read = PoseTrajectory::read_csv("p.csv", csv.as_bytes(), kind).unwrap();
            for step in 0..=20 {
                let time = 0.05 * f64::from(step);
                let share = match kind {
                    Interpolation::Linear => time,
                    _ => time * time * (3.0 - 2.0 * time),
                };
                let expected = rotation_from_rpy(angles(share));
                for found in [&given, &read].map(|trajectory| trajectory.pose_at(time).rotation) {
                    let apart = 1.0 - found.dot(expected).abs();
                    assert!(apart < 1e-13, "{kind:?}, {axis}, {change}°, {time} s");
                }
            }
        }
    }
    // Three turns by 270° at equal times: a steady turn in the middle.
    let yaw = |turns: f64| [DVec3::ZERO, degrees([0.0, 0.0, 270.0 * turns])];
    let way_points = [0.0, 1.0, 2.0, 3.0].map(yaw);
    for kind in INTERPOLATIONS {
        let times = vec![0.0, 1.0, 2.0, 3.0];
        let trajectory = PoseTrajectory::from_rpy(times, &way_points, kind).unwrap();
        for time in [0.0, 1.0, 1.3, 1.5, 1.9, 2.0, 3.0] {
            let expected = rotation_from_rpy(yaw(time)[1]);
            let apart = 1.0 - trajectory.pose_at(time).rotation.dot(expected).abs();
            assert!(apart < 1e-13, "{kind:?} {time}: {apart}");
        }
    }
}

#[test]
fn turns_whose_direction_is_undetermined_are_refused() {
    let new = |angles: [f64; 3]| {
        let rpy = DVec3::from_array(angles.map(f64::to_radians));
        let way_points = [[DVec3::ZERO; 2], [DVec3::ZERO, rpy]];
        PoseTrajectory::from_rpy(vec![0.0, 1.0], &way_points, Interpolation::Cubic)
    };
    let allowed =
        "less than 180°, or a change of one of roll, pitch and yaw alone; more way-points";
    assert!(new([100.0, 0.0, 100.0]).is_ok() && new([0.0, 0.0, 360.0]).is_ok());
    let place = "pose trajectory, way-point 2";
    let several = format!("{place}: several angles change, one by 360.000000°; {allowed}");
    let error = new([0.0, 10.0, 360.0]).unwrap_err();
    assert_eq!(error.to_string(), several);
    let poses = [DQuat::IDENTITY, DQuat::from_rotation_x(PI)].map(Pose::from_rotation);
    let error = PoseTrajectory::new(vec![0.0, 1.0], &poses, Interpolation::Linear).unwrap_err();
    let half = format!("{place}: turned by 180°, in either direction; {allowed}");
    assert_eq!(error.to_string(), half);
}

#[test]
fn a_pose_csv_takes_quaternions_or_degrees() {
    let read =
        |text: &str| PoseTrajectory::read_csv("p.csv", text.as_bytes(), Interpolation::Linear);
    let degrees =
        "time_s,x_mm,y_mm,z_mm,roll_deg,pitch_deg,yaw_deg\n0,0,0,100,90,0,0\n2,0,0,300,90,0,90\n";
    let quaternions =
        "time_s,x,y,z,qx,qy,qz,qw\n0,0,0,0.1,0.7071,0,0,0.7071\n2,0,0,0.3,0.5,0.5,0.5,0.5\n";
    let [degrees, quaternions] = [degrees, quaternions].map(|text| read(text).unwrap());
    for time in [0.0, 0.7, 2.0] {
        let (a, b) = (degrees.pose_at(time), quaternions.pose_at(time));
        assert!((a.translation - b.translation).length() < 1e-15);
        let apart = (a.rotation.dot(b.rotation).abs() - 1.0).abs();
        assert!(apart < 1e-14, "{time}: {a:?}, {b:?}");
    }
    for [text, sentence] in cases(BAD_POSE_TABLES) {
        assert_eq!(read(&text).unwrap_err().to_string(), sentence);
    }
}

/// Table of poses | message.
const BAD_POSE_TABLES: &str = r#"
    time_s,x,y,z,qx,qy,qz,qw\n0,0,0,0,1,1,0,0\n | p.csv, line 2: a quaternion of length 1.4142135623730951; length 1
    time_s,x,y,z\n0,0,0,0\n | p.csv, line 1: no rotation; qx, qy, qz, qw, or roll, pitch, yaw, or roll_deg, pitch_deg, yaw_deg
    time_s,x,y,roll,pitch,yaw\n | p.csv, line 1: no column z; all of x, y, z
    time_s,x,y,z,qx_deg,qy,qz,qw\n | p.csv, line 1: no column qx; all of qx, qy, qz, qw
"#;

#[test]
fn every_motion_says_where_it_is() {
    let start = Pose::from_translation(DVec3::Z);
    let phase = Phase {
        duration: 2.0,
        linear: DVec3::X,
        angular: DVec3::ZERO,
    };
    let plan = VelocityPlan::new(start, vec![phase]).unwrap();
    let far = Pose::from_translation(DVec3::new(2.0, 0.0, 1.0));
    let way_points =
        PoseTrajectory::new(vec![0.0, 2.0], &[start, far], Interpolation::Linear).unwrap();
    let motions = [Motion::Plan(plan), Motion::WayPoints(way_points)];
    for motion in motions {
        let found = motion.pose_at(0.5).translation;
        let apart = (found - DVec3::new(0.5, 0.0, 1.0)).length();
        assert!(apart < 1e-15, "{found}");
        assert_eq!((motion.pose_at(9.0), motion.end()), (far, 2.0));
    }
    assert_eq!(Motion::Fixed(start).pose_at(7.0), start);
}

#[test]
fn following_a_trajectory_allocates_nothing() {
    let arm = Robot::read("../../objects/robots/arm.urdf".as_ref()).unwrap();
    let there = Array2::from_shape_fn((3, 7), |(i, k)| 0.2 * i as f64 - 0.05 * k as f64);
    let times = vec![0.0, 1.0, 2.0];
    let trajectory = JointTrajectory::new(&arm, times, there, Interpolation::Cubic).unwrap();
    let mut positions = vec![0.0; arm.n_positions()];
    let mut world_from_link = vec![Pose::IDENTITY; arm.links().len()];
    let mut follow = |steps: std::ops::Range<u32>| {
        for step in steps {
            trajectory.positions_into(1e-3 * f64::from(step), &mut positions);
            arm.forward_into(&Pose::IDENTITY, &positions, &mut world_from_link)
                .unwrap();
        }
    };
    assert!(allocations(|| drop(trajectory.positions_at(0.0))) > 0);
    assert_eq!(allocations(|| follow(0..2500)), 0);
}

#[test]
fn a_mutilated_csv_is_a_trajectory_or_bad_input_and_never_a_panic() {
    let mut rng = Seed::new(2018).named("mutilated trajectories").rng();
    let robot = free();
    let (mut n_sound, mut n_refused) = (0, 0);
    for _ in 0..2000 {
        let mut bytes = CSV.as_bytes().to_vec();
        for _ in 0..rng.gen_range(1..3) {
            let at = rng.gen_range(0..bytes.len());
            let byte = b"0123456789.,-e\n\"_\xff"[rng.gen_range(0..18)];
            match rng.gen_range(0..3) {
                0 => drop(bytes.remove(at)),
                1 => bytes[at] = byte,
                _ => bytes.insert(at, byte),
            }
        }
        match JointTrajectory::read_csv(&robot, "t.csv", &bytes[..], Interpolation::Cubic) {
            Ok(trajectory) => {
                let is_finite =
                    |time: f64| trajectory.positions_at(time).iter().all(|x| x.is_finite());
                assert!([0.0, 0.7, 1.5, 1.9, 9.0].into_iter().all(is_finite));
                n_sound += 1;
            }
            Err(error) => {
                assert!(error.to_string().starts_with("t.csv"), "{error}");
                assert_eq!(error.exit_code(), 2);
                n_refused += 1;
            }
        }
    }
    assert!(n_sound > 200 && n_refused > 200, "{n_sound}, {n_refused}");
}
