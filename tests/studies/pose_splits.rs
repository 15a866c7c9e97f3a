//! Splits by pose: no test touch has a neighbour of the held-out kind among the training touches.

use crate::study::{Study, run};
use bubbletouch::recognition::data::split::Split;
use bubbletouch::recognition::statistics::grouped::{GroupCount, GroupedTest, interval_of_groups};
use bubbletouch::recognition::statistics::interval::Interval;
use bubbletouch::study::table::Tables;
use bubbletouch::world::Touch;
use std::collections::BTreeSet;

/// Study with unordered values, so that halves depend on the sizes of values and not on their positions.
const STUDY: &str = include_str!("../fixtures/texts/pose_splits.toml");

fn with_split(split: &str) -> String {
    format!("{STUDY}split = \"{split}\"\n")
}

fn degrees(touch: &Touch) -> usize {
    touch.yaw.to_degrees().round() as usize
}

fn tilt(touch: &Touch) -> [usize; 2] {
    touch.tilt.map(|t| t.to_degrees().round() as usize)
}

fn tenths_of_mm(metres: f64) -> usize {
    (1e4 * metres).round() as usize
}

/// Checks the touches of both sides in each trial; every object has equally many of each.
fn sides(split: &str, check: impl Fn(usize, &[&Touch], &[&Touch])) {
    let study = Study::new(&with_split(split));
    let touches = study.touches();
    for (trial, split) in study.sweep.splits.iter().enumerate() {
        let Split { train, test } = &**split;
        let all: BTreeSet<_> = train.iter().chain(test).collect();
        assert_eq!(all.len(), train.len() + test.len(), "each touch once");
        let of = |rows: &[usize]| rows.iter().map(|&row| touches[row].1).collect::<Vec<_>>();
        check(trial, &of(train), &of(test));
    }
}

/// Returns the distinct values of one side, ascending.
fn values<T: Ord>(side: &[&Touch], value: impl Fn(&Touch) -> T) -> Vec<T> {
    let all: BTreeSet<T> = side.iter().map(|touch| value(touch)).collect();
    all.into_iter().collect()
}

const N_TOUCHES: usize = 2 * 2 * 3 * 5 * 4 * 3;

#[test]
fn each_yaw_is_left_out_in_turn() {
    sides("leave_one_yaw_out", |trial, train, test| {
        let held_out = [0, 10, 20, 30, 40][trial % 5];
        assert_eq!(values(test, degrees), [held_out]);
        assert!(train.iter().all(|touch| degrees(touch) != held_out));
        assert_eq!(train.len() + test.len(), N_TOUCHES);
    });
}

#[test]
fn each_half_of_the_yaws_is_tested_in_turn_and_the_smaller_has_the_middle_one() {
    sides("half_of_yaws", |trial, train, test| {
        let (smaller, larger) = match trial % 2 {
            0 => (train, test),
            _ => (test, train),
        };
        assert_eq!(values(smaller, degrees), [0, 10, 20]);
        assert_eq!(values(larger, degrees), [30, 40]);
        assert_eq!(train.len() + test.len(), N_TOUCHES);
    });
}

#[test]
fn opposite_blocks_share_no_offset_and_no_yaw_and_each_is_tested_in_turn() {
    let blocks = std::cell::RefCell::new(Vec::new());
    sides("opposite_blocks", |_, train, test| {
        type Of = fn(&Touch) -> usize;
        let axes: [Of; 3] = [
            |touch| tenths_of_mm(touch.offset[0]),
            |touch| tenths_of_mm(touch.offset[1]),
            degrees,
        ];
        let block = axes.map(|axis| {
            let (learned, tested) = (values(train, axis), values(test, axis));
            let is_above = tested[0] > learned[learned.len() - 1];
            assert!(is_above || tested[tested.len() - 1] < learned[0]);
            is_above
        });
        // Training and test touches contain all tilts and depths.
        for side in [train, test] {
            assert_eq!(values(side, tilt).len(), 4);
            assert_eq!(values(side, |touch| tenths_of_mm(touch.depth)).len(), 3);
        }
        blocks.borrow_mut().push(block);
    });
    let blocks = blocks.into_inner();
    assert_eq!(blocks[0], [true; 3]);
    assert_eq!(blocks.iter().collect::<BTreeSet<_>>().len(), 8);
}

#[test]
fn no_tilt_and_no_depth_that_is_tested_is_learned() {
    sides("unseen_tilt", |trial, train, test| {
        let held_out = [[0, 0], [0, 5], [5, 0], [5, 5]][trial % 4];
        assert_eq!(values(test, tilt), [held_out]);
        assert!(train.iter().all(|touch| tilt(touch) != held_out));
    });
    sides("unseen_depth", |trial, train, test| {
        let held_out = [10, 20, 30][trial % 3];
        let depth = |touch: &Touch| tenths_of_mm(touch.depth);
        assert_eq!(values(test, depth), [held_out]);
        assert!(train.iter().all(|touch| depth(touch) != held_out));
    });
}

#[test]
fn a_random_split_has_neighbours_of_every_kind_on_both_sides_and_is_what_no_key_says() {
    sides("random", |_, train, test| {
        assert_eq!(values(test, degrees), values(train, degrees));
        assert_eq!(values(test, tilt), values(train, tilt));
    });
    let [none, random] = [STUDY.to_owned(), with_split("random")].map(|text| Study::new(&text));
    assert_eq!(none.sweep.splits, random.sweep.splits);
}

#[test]
fn a_split_is_an_axis_beside_which_the_random_one_has_its_fraction() {
    let axes = "trials = 2\n[axes]\n\"recognition.split\" = [\"random\", \"unseen_tilt\"]\n";
    let text = STUDY.replace("trials = 8\n", axes) + "test_fraction = 0.5\n";
    let tables = run(&text);
    let rows = tables.accuracy.iter();
    let rows: Vec<_> = rows
        .map(|(_, score)| (score.n_test, score.n_groups))
        .collect();
    // Each row counts as a group if none are held out, so that all rows have the column.
    let random = (360, Some(360));
    assert_eq!(rows, [random, random, (180, Some(1)), (180, Some(1))]);
    let (random, tilted) = (&tables.summary[0].1, &tables.summary[1].1);
    assert_eq!((random.n_groups, tilted.n_groups), (Some(360), Some(2)));
    let wilson = |n_correct| Interval::wilson(n_correct, 360, 0.95).unwrap();
    let by_rows = wilson((random.accuracy * 360.0).round() as usize);
    let interval = (random.accuracy_low, random.accuracy_high);
    assert_eq!(interval, (by_rows.low, by_rows.high));
}

/// Returns the groups of trials that each test one whole group, by its number.
fn tests_of(tables: &Tables, group: impl Fn(usize) -> usize) -> Vec<[GroupCount; 1]> {
    let scores = tables.accuracy.iter().map(|(_, score)| score);
    let counts = scores.map(|score| {
        [GroupCount {
            group: group(score.trial),
            n_rows: score.n_test,
            n_correct: score.n_correct,
        }]
    });
    counts.collect()
}

#[test]
fn the_interval_of_poses_held_out_comes_from_them_and_not_from_touches() {
    for (split, n_groups) in [
        ("leave_one_yaw_out", 5),
        ("opposite_blocks", 8),
        ("unseen_tilt", 4),
        ("unseen_depth", 3),
    ] {
        let tables = run(&with_split(split));
        // A classifier trained on one yaw cannot recognise other yaws.
        for (_, score) in &tables.accuracy {
            let interval = (score.accuracy_low, score.accuracy_high);
            assert_eq!((score.n_groups, interval), (Some(1), (0.0, 1.0)), "{split}");
        }
        let counts = tests_of(&tables, |trial| trial % n_groups);
        let tests = counts.iter().map(|groups| GroupedTest {
            n_rows: groups[0].n_rows,
            n_correct: groups[0].n_correct,
            groups,
        });
        let (expected, n) = interval_of_groups(&tests.collect::<Vec<_>>(), 0.95).unwrap();
        let found = &tables.summary[0].1;
        assert_eq!((found.n_groups, n), (Some(n_groups), n_groups), "{split}");
        let interval = (found.accuracy_low, found.accuracy_high);
        assert_eq!(interval, (expected.low, expected.high));
        // All tested touches, each as a group of its own.
        let tested = &counts[..n_groups];
        let sum = |of: fn(&GroupCount) -> usize| tested.iter().map(|[group]| of(group)).sum();
        let (n_correct, n_rows) = (sum(|group| group.n_correct), sum(|group| group.n_rows));
        let by_rows = Interval::wilson(n_correct, n_rows, 0.95).unwrap();
        assert!(found.accuracy_low < by_rows.low, "{split}: {found:?}");
    }
    let random = run(&with_split("random"));
    assert_eq!(random.accuracy[0].1.n_groups, None);
    assert_eq!(random.summary[0].1.n_groups, None);
}

#[test]
fn groups_kept_together_count_once_however_many_touches_are_decided_on_together() {
    let keys = "group_by = \"yaw\"\ntest_fraction = 0.4\ntouches_per_decision = [1, 3]\n";
    let tables = run(&format!("{STUDY}{keys}"));
    for (configuration, score) in &tables.accuracy {
        assert_eq!(score.n_groups, Some(2), "{configuration:?}");
    }
    for (configuration, score) in &tables.summary {
        assert_eq!(score.n_groups, Some(5), "all yaws are tested in some trial");
        assert!(score.accuracy_low <= score.accuracy && score.accuracy <= score.accuracy_high);
        assert!(score.accuracy_low > 0.0, "{configuration:?}: {score:?}");
    }
}
