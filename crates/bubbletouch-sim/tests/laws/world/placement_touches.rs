//! Laws of touch placement.

use crate::cases::cases;
use crate::standard_errors::{assert_expected, mean_and_std, of_mean, of_share};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::random::Seed;
use bubbletouch_sim::world::{Placement, RestPose, RestPoses, Spread, Touch, TouchAxis, touches};

fn rests(probabilities: &[f64]) -> Vec<RestPose> {
    let rest = |&probability| RestPose {
        table_from_object: Pose::IDENTITY,
        height: 0.1,
        probability,
    };
    probabilities.iter().map(rest).collect()
}

fn listed(values: &[f64]) -> Spread {
    Spread::Values(values.to_vec())
}

/// Returns a placement of 2 offsets × 3 yaws × 2 depths.
fn grid() -> Placement {
    Placement {
        rest: RestPoses::Stable,
        offset_x: listed(&[0.0, 0.002]),
        offset_y: listed(&[0.0]),
        yaw: listed(&[0.0, 0.5, 1.0]),
        tilt_x: listed(&[0.0]),
        tilt_y: listed(&[0.0]),
        depth: listed(&[0.003, 0.004]),
        per_object: None,
    }
}

/// Returns a placement that draws a number of touches.
fn drawing(placement: Placement, per_object: usize) -> Placement {
    Placement {
        per_object: Some(per_object),
        ..placement
    }
}

/// Returns a placement that draws a number of touches whose yaw is spread uniformly.
fn turning(per_object: usize, low: f64, high: f64) -> Placement {
    let yaw = Spread::Uniform { low, high };
    drawing(Placement { yaw, ..grid() }, per_object)
}

fn made(placement: &Placement, probabilities: &[f64]) -> Vec<Touch> {
    touches(placement, &rests(probabilities), &Seed::new(2018)).unwrap()
}

fn refused(placement: &Placement, probabilities: &[f64]) -> String {
    let result = touches(placement, &rests(probabilities), &Seed::new(2018));
    result.unwrap_err().to_string()
}

#[test]
fn lists_alone_give_every_combination_with_the_last_axis_fastest() {
    let all = made(&grid(), &[0.7, 0.3]);
    assert_eq!(all.len(), 2 * 2 * 3 * 2);
    let mut expected = Vec::new();
    for rest in 0..2 {
        for x in [0.0, 0.002] {
            for yaw in [0.0, 0.5, 1.0] {
                for depth in [0.003, 0.004] {
                    expected.push((rest, [x, 0.0], yaw, depth));
                }
            }
        }
    }
    let made: Vec<_> = all
        .iter()
        .map(|t| (t.rest, t.offset, t.yaw, t.depth))
        .collect();
    assert_eq!(made, expected);
}

#[test]
fn a_number_of_combinations_is_drawn_without_repetition_and_nests() {
    let all = made(&grid(), &[0.7, 0.3]);
    let drawn = |count| made(&drawing(grid(), count), &[0.7, 0.3]);
    let every = drawn(24);
    for touch in &every {
        assert!(all.contains(touch));
        assert_eq!(every.iter().filter(|other| *other == touch).count(), 1);
    }
    assert_ne!(every, all);
    for count in [1, 5, 23] {
        assert_eq!(drawn(count), every[..count]);
    }
}

#[test]
fn each_combination_is_equally_likely_to_be_drawn() {
    let mut count = [0; 24];
    for seed in 0..4000 {
        let placement = drawing(grid(), 6);
        let drawn = touches(&placement, &rests(&[0.7, 0.3]), &Seed::new(seed)).unwrap();
        for touch in drawn {
            let index = |axis| touch.group(&[axis]).unwrap()[0];
            let within = index(TouchAxis::OffsetX) * 6 + index(TouchAxis::Yaw) * 2;
            count[touch.rest * 12 + within + index(TouchAxis::Depth)] += 1;
        }
    }
    // Each of 4,000 placements draws six of 24 combinations.
    for count in count {
        let share = f64::from(count) / 4000.0;
        assert_expected("combination", share, 0.25, of_share(0.25, 4000));
    }
}

#[test]
fn uniform_spreads_fill_their_range_and_resting_poses_follow_their_probability() {
    let all = made(&turning(20_000, -1.0, 3.0), &[0.7, 0.1, 0.2]);
    let n = all.len();
    let yaws: Vec<f64> = all.iter().map(|t| t.yaw).collect();
    let (mean, _) = mean_and_std(&yaws);
    assert_expected("yaw", mean, 1.0, of_mean(4.0 / f64::sqrt(12.0), n));
    assert!(all.iter().all(|t| (-1.0..3.0).contains(&t.yaw)));
    for (rest, probability) in [0.7, 0.1, 0.2].into_iter().enumerate() {
        let share = all.iter().filter(|t| t.rest == rest).count() as f64 / n as f64;
        assert_expected("rest", share, probability, of_share(probability, n));
    }
    let deep = all.iter().filter(|t| t.depth == 0.004).count() as f64 / n as f64;
    assert_expected("depth", deep, 0.5, of_share(0.5, n));
}

#[test]
fn a_touch_is_drawn_alone_by_its_number_and_each_axis_by_its_name() {
    let (some, more) = (turning(5, 0.0, 1.0), turning(50, 0.0, 1.0));
    assert_eq!(made(&some, &[1.0]), made(&more, &[1.0])[..5]);
    let other_depths = Placement {
        depth: listed(&[0.001]),
        ..some.clone()
    };
    for (a, b) in made(&some, &[1.0]).iter().zip(made(&other_depths, &[1.0])) {
        assert_eq!((a.offset, a.yaw), (b.offset, b.yaw));
    }
}

#[test]
fn touches_group_by_their_listed_values_but_not_by_uniform_ones() {
    for touch in made(&turning(30, 0.0, 1.0), &[0.5, 0.5]) {
        let group = touch.group(&[TouchAxis::Rest, TouchAxis::OffsetX]).unwrap();
        assert_eq!(group[0], touch.rest);
        assert_eq!([0.0, 0.002][group[1]], touch.offset[0]);
        let error = touch.group(&[TouchAxis::Yaw]).unwrap_err().to_string();
        assert!(error.contains("yaw, which is spread uniformly"), "{error}");
    }
}

/// Changed property | its values, or the ends of a uniform range | part of the message.
const IMPOSSIBLE_PLACEMENTS: &str = "
    yaw | 0 to 1 | yaw spread uniformly
    per_object | 0 | 1 to 12
    per_object | 13 | 1 to 12
    offset_x | | offset_x: no values
    yaw | 0.5 0.1 0.5 | yaw: 0.5 twice
    depth | -0.001 | depth: -0.001
    tilt_x | 1.6 | quarter turn
    offset_y | NaN | offset_y: NaN
    yaw | 2 to 1 | from 2 to 1
    yaw | 0 to inf | yaw: inf
";

#[test]
fn placements_that_cannot_be_made_are_refused_with_their_reason() {
    for [property, values, reason] in cases(IMPOSSIBLE_PLACEMENTS) {
        let number = |word: &str| word.parse::<f64>().unwrap();
        let spread = match values.split_once(" to ") {
            Some((low, high)) => Spread::Uniform {
                low: number(low),
                high: number(high),
            },
            None => Spread::Values(values.split_whitespace().map(number).collect()),
        };
        let mut placement = grid();
        match property.as_str() {
            "per_object" => placement.per_object = Some(values.parse().unwrap()),
            "offset_x" => placement.offset_x = spread,
            "offset_y" => placement.offset_y = spread,
            "yaw" => placement.yaw = spread,
            "tilt_x" => placement.tilt_x = spread,
            _ => placement.depth = spread,
        }
        let message = refused(&placement, &[1.0]);
        assert!(message.contains(&reason), "{message}");
    }
    assert!(refused(&grid(), &[]).contains("resting poses: none"));
    assert!(refused(&grid(), &[0.5, -0.5]).contains("probability -0.5"));
}

#[test]
fn a_slip_that_asks_for_endless_combinations_is_refused_before_memory_runs_out() {
    let many: Vec<f64> = (0..10_000).map(|i| i as f64 * 1e-6).collect();
    let axis = || Spread::Values(many.clone());
    let placement = Placement {
        offset_x: axis(),
        offset_y: axis(),
        yaw: axis(),
        depth: axis(),
        ..grid()
    };
    assert!(refused(&placement, &[1.0]).contains("1 to 10000000"));
    assert_eq!(made(&drawing(placement, 7), &[1.0]).len(), 7);
}
