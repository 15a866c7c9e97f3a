//! Frames and splits of a study, compared with touches that are pressed one by one and rows that are counted individually.

use crate::study::{Study, changed, pressed};
use bubbletouch::recognition::data::split::Split;
use bubbletouch::study::progress::Silent;
use bubbletouch::study::taxel_array::TaxelArray;
use bubbletouch::study::{TouchedObject, sample_frames, simulate_array};
use bubbletouch::world::{Touch, TouchAxis};
use std::collections::BTreeSet;

/// Study in which some touches miss the array and some exceed its stroke.
const STUDY: &str = include_str!("../fixtures/texts/frames.toml");

#[test]
fn every_frame_is_its_touch_pressed_alone() {
    let study = Study::new(STUDY);
    let array = &study.plan.array;
    let frames = simulate_array(&study.touched, array, 1, &Silent);
    let deflection = frames.to_array();
    let touches = study.touches();
    let (mut n_missed, mut n_saturated) = (0, 0);
    for (row, &touch) in touches.iter().enumerate() {
        let (contact, alone) = pressed(array, touch, touch.1.depth);
        assert_eq!(deflection.row(row).to_vec(), alone, "row {row}");
        n_missed += usize::from(contact.is_none());
        n_saturated += usize::from(contact.is_some_and(|c| c.n_saturated > 0));
    }
    assert_eq!(touches.len(), deflection.nrows());
    assert_eq!(frames.facts.n_missed, n_missed);
    assert_eq!(frames.facts.n_saturated, n_saturated);
}

#[test]
fn frames_without_a_deflection_are_counted_and_none_is_of_a_deep_touch() {
    let depths = |depths: &str| {
        let text = STUDY.replace("depth_mm = [2.0, 4.0]", depths);
        let mut study = Study::new(&text.replace(", 400.0]", "]"));
        // Depths of a study are large enough not to vanish by rounding.
        let touches = study
            .touched
            .iter_mut()
            .flat_map(|object| &mut object.touches);
        for touch in touches.filter(|touch| touch.depth < 1e-9) {
            touch.depth = 1e-23;
        }
        let array = &study.plan.array;
        let frames = simulate_array(&study.touched, array, 3, &Silent);
        let deflection = frames.to_array();
        let empty = deflection.outer_iter().skip(2).step_by(3);
        let n_empty = empty.filter(|row| row.iter().all(|&d| d == 0.0)).count();
        assert_eq!(frames.facts.n_missed, n_empty);
        (n_empty, frames.facts.n_saturated, deflection.nrows() / 3)
    };
    let (n_empty, n_saturated, n_touches) = depths("depth_mm = [1e-9, 2.0]");
    assert!(0 < n_empty && 2 * n_empty <= n_touches, "{n_empty}");
    assert_eq!(n_saturated, 0);
    let (n_empty, n_saturated, n_touches) = depths("depth_mm = [10.0, 50.0, 200.0]");
    assert_eq!((n_empty, n_saturated), (0, n_touches));
}

/// Evaluates the contact equations for each taxel and sphere; returns `None` if no travel reaches the object.
fn by_the_equations(array: &TaxelArray, object: &TouchedObject, touch: &Touch) -> Option<Vec<f64>> {
    let pose = touch.patch_from_object(&object.rests[touch.rest]);
    let grid = array.grid();
    let spheres = object.object.model.spheres().unwrap().spheres();
    let needs: Vec<f64> = (0..grid.n_taxels())
        .map(|taxel| {
            let (x, y) = (grid.x(taxel % grid.nx), grid.y(taxel / grid.nx));
            spheres.iter().fold(f64::NEG_INFINITY, |deepest, sphere| {
                let c = pose.transform_point(sphere.center);
                let reach = array.taxel().radius + sphere.radius;
                let b2 = (c.x - x).powi(2) + (c.y - y).powi(2);
                match b2 < reach * reach {
                    true => deepest.max((reach * reach - b2).sqrt() - c.z),
                    false => deepest,
                }
            })
        })
        .collect();
    let first = needs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let pressed = |need: f64| (need - first + touch.depth).max(0.0);
    first
        .is_finite()
        .then(|| needs.into_iter().map(pressed).collect())
}

#[test]
fn missed_and_saturated_touches_are_counted_as_the_equations_say() {
    let study = Study::new(STUDY);
    let array = &study.plan.array;
    let stroke = array.taxel().stroke;
    let frames = simulate_array(&study.touched, array, 1, &Silent);
    let deflection = frames.to_array();
    let (mut n_missed, mut n_saturated) = (0, 0);
    for (row, (object, touch)) in deflection.outer_iter().zip(study.touches()) {
        let expected = by_the_equations(array, object, touch);
        n_missed += usize::from(expected.is_none());
        let expected = expected.unwrap_or_else(|| vec![0.0; array.n_taxels()]);
        n_saturated += usize::from(expected.iter().any(|&d| d > stroke * (1.0 + 1e-9)));
        for (&simulated, expected) in row.iter().zip(expected) {
            let difference = (simulated - expected.min(stroke)).abs();
            assert!(difference < 1e-9, "{difference} m");
        }
    }
    let n_touches = 3 * 4 * 2 * 2 * 2 * 2;
    assert_eq!(deflection.nrows(), n_touches);
    assert_eq!(n_missed, n_touches / 4, "the offset of 400 mm");
    assert_eq!(frames.facts.n_missed, n_missed);
    assert_eq!(n_saturated, 3 * n_touches / 8, "the depth of 4 mm");
    assert_eq!(frames.facts.n_saturated, n_saturated);
    let limits = study.run().limits;
    for (limit, count) in limits.iter().zip([n_missed, n_saturated]) {
        assert_eq!((limit.count, limit.total), (count as u64, n_touches as u64));
    }
}

fn with_recognition(keys: &str) -> Study {
    Study::new(&format!("{STUDY}{keys}\n"))
}

/// Asserts that every row is on one side exactly once.
fn assert_is_a_division(split: &Split, n_rows: usize) {
    let mut rows = [split.train.clone(), split.test.clone()].concat();
    rows.sort_unstable();
    assert_eq!(rows, (0..n_rows).collect::<Vec<_>>());
    assert!(!split.test.is_empty() && !split.train.is_empty());
}

/// Returns the values of these axes in rows.
fn groups(
    touches: &[(&TouchedObject, &Touch)],
    axes: &[TouchAxis],
    rows: &[usize],
) -> BTreeSet<Vec<usize>> {
    let group = |row: &usize| touches[*row].1.group(axes).unwrap();
    rows.iter().map(group).collect()
}

#[test]
fn what_is_kept_together_is_never_on_both_sides() {
    use TouchAxis::{Depth, OffsetX, OffsetY, Rest, TiltX, TiltY, Yaw};
    let pose = [Rest, OffsetX, OffsetY, Yaw, TiltX, TiltY];
    let kinds: [(&str, &[TouchAxis], &str); 7] = [
        ("offset", &[OffsetX, OffsetY], ""),
        ("offset", &[OffsetX, OffsetY], "folds = 3"),
        ("yaw", &[Yaw], "test_fraction = 0.5"),
        ("tilt", &[TiltX, TiltY], "test_fraction = 0.5"),
        ("depth", &[Depth], "folds = 2"),
        ("pose", &pose, ""),
        ("pose", &pose, "folds = 6"),
    ];
    for (kind, axes, keys) in kinds {
        let study = with_recognition(&format!("group_by = \"{kind}\"\n{keys}"));
        let touches = study.touches();
        assert_eq!(study.sweep.splits.len(), 6);
        for split in &study.sweep.splits {
            assert_is_a_division(split, touches.len());
            let [train, test] =
                [&split.train, &split.test].map(|rows| groups(&touches, axes, rows));
            assert!(train.is_disjoint(&test), "{kind}: {train:?} and {test:?}");
        }
    }
}

/// Returns a study with drawn poses, except for two listed values of a tilt.
fn with_drawn_poses(keys: &str) -> String {
    let offsets = "{ uniform = [-20.0, 20.0] }";
    let along = format!("{offsets}\nper_object = 120");
    let across = format!("offset_y_mm = {offsets}");
    let yaw = "yaw_deg = { uniform = [0.0, 360.0] }";
    let changes = [
        ("[-6.0, 0.0, 6.0, 400.0]", &along[..]),
        ("offset_y_mm = [0.0, 10.0]", &across),
        ("yaw_deg = [0.0, 30.0]", yaw),
    ];
    changed(STUDY, &changes) + keys
}

#[test]
fn no_test_touch_has_a_training_touch_of_its_object_nearer_than_is_kept_together() {
    let turned = |a: f64, b: f64| {
        let apart = (a - b).to_degrees().rem_euclid(360.0);
        apart.min(360.0 - apart)
    };
    let are_offsets_near = |a: &Touch, b: &Touch, near_mm: f64| {
        let apart_mm = |k: usize| 1e3 * (a.offset[k] - b.offset[k]).abs();
        apart_mm(0) < near_mm && apart_mm(1) < near_mm
    };
    for kind in ["pose", "offset", "yaw"] {
        let keys = match kind {
            "pose" => "group_by_mm = 6.0\ngroup_by_deg = 40.0",
            "offset" => "group_by_mm = 1.5",
            _ => "group_by_deg = 1.0\nfolds = 3",
        };
        let is_near = |a: &Touch, b: &Touch| match kind {
            "pose" => {
                are_offsets_near(a, b, 6.0) && turned(a.yaw, b.yaw) < 40.0 && a.tilt == b.tilt
            }
            "offset" => are_offsets_near(a, b, 1.5),
            _ => turned(a.yaw, b.yaw) < 1.0,
        };
        let keys = format!("group_by = \"{kind}\"\n{keys}\n");
        let study = Study::new(&with_drawn_poses(&keys));
        let touches = study.touches();
        for split in &study.sweep.splits {
            assert_is_a_division(split, touches.len());
            for &test in &split.test {
                let (object, touch) = touches[test];
                let near = split.train.iter().find(|&&row| {
                    let (other, trained) = touches[row];
                    std::ptr::eq(other, object) && is_near(touch, trained)
                });
                assert_eq!(near, None, "{kind}: touch {test}");
            }
        }
        // Some groups contain several touches, so neighbours exist.
        let keys = study.sweep.group_keys.as_ref().unwrap();
        let n_groups = keys.iter().collect::<BTreeSet<_>>().len();
        assert!((7..touches.len()).contains(&n_groups), "{kind}: {n_groups}");
    }
    // A random split separates neighbours, so the law is not trivial.
    let study = Study::new(&with_drawn_poses(""));
    let touches = study.touches();
    let split = &study.sweep.splits[0];
    let has_neighbour = split.test.iter().any(|&test| {
        split.train.iter().any(|&row| {
            test / 120 == row / 120 && are_offsets_near(touches[test].1, touches[row].1, 1.5)
        })
    });
    assert!(has_neighbour);
}

#[test]
fn without_keeping_together_offsets_are_on_both_sides() {
    let study = with_recognition("");
    let split = &study.sweep.splits[0];
    let axes = [TouchAxis::OffsetX, TouchAxis::OffsetY];
    let [train, test] =
        [&split.train, &split.test].map(|rows| groups(&study.touches(), &axes, rows));
    assert!(!train.is_disjoint(&test));
}

#[test]
fn over_the_folds_each_touch_is_tested_exactly_once() {
    for keys in ["folds = 3", "folds = 3\ngroup_by = \"pose\""] {
        let study = with_recognition(keys);
        let n_rows = study.sweep.labels.len();
        let divisions: Vec<_> = study.sweep.splits.chunks(3).collect();
        assert_eq!(divisions.len(), 2);
        for folds in &divisions {
            let mut tested: Vec<usize> = folds.iter().flat_map(|f| f.test.clone()).collect();
            tested.sort_unstable();
            assert_eq!(tested, (0..n_rows).collect::<Vec<_>>(), "{keys}");
            folds.iter().for_each(|f| assert_is_a_division(f, n_rows));
        }
        assert_ne!(divisions[0][0].test, divisions[1][0].test, "divided anew");
    }
}

#[test]
fn a_study_tests_what_its_splits_hold_out() {
    let study = with_recognition("folds = 3\ntrain_touches = [5, 10]");
    for (configuration, score) in &study.run().accuracy {
        assert_eq!(score.n_test, study.sweep.splits[score.trial].test.len());
        assert_eq!(score.n_train, 3 * configuration.train_touches);
        assert_eq!(score.accuracy, score.n_correct as f64 / score.n_test as f64);
    }
}

#[test]
fn a_damper_pushes_back_on_taxels_that_move_and_not_on_saturated_ones() {
    let damped = "stroke_mm = 3.5\nstiffness_n_per_m = 200.0\ndamping_n_s_per_m = 4.0";
    let text = STUDY
        .replace("stroke_mm = 3.5", damped)
        .replace("[2.0, 4.0]\n", "4.0\nspeed_mm_per_s = 50.0\n")
        .replace("[sensing]", "[signal]\nsteps = [\"force\"]\n\n[sensing]");
    let study = Study::new(&text);
    let array = &study.plan.array;
    let frames = simulate_array(&study.touched, array, 1, &Silent);
    let frames = frames.to_array();
    let samples = sample_frames(&study.plan, &study.sweep.groups, &study.touched).unwrap();
    assert_eq!(samples.shown.frames.len(), study.touched.len());
    let per_object = study.touched[0].touches.len();
    let (mut n_moving, mut n_saturated) = (0, 0);
    for (object, (_, forces)) in samples.shown.frames.iter().enumerate() {
        for (&deflection, &force) in frames.row(object * per_object).iter().zip(forces) {
            let spring = 200.0 * deflection;
            let is_saturated = deflection == f64::from(array.taxel().stroke as f32);
            let is_moving = deflection > 0.0 && !is_saturated;
            let damper = if is_moving { 4.0 * 0.05 } else { 0.0 };
            assert!((force - spring - damper).abs() < 1e-6, "{force} N");
            n_moving += usize::from(is_moving);
            n_saturated += usize::from(is_saturated);
        }
    }
    assert!(n_moving > 20 && n_saturated > 0, "{n_moving} {n_saturated}");
}
