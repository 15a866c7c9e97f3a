//! Laws of splits: which rows train, which test, and which must be separated.

use std::collections::BTreeSet;

use bubbletouch::random::Seed;
use bubbletouch::recognition::data::split::{
    Side, Split, given_hold_out, group_hold_out, group_k_fold, stratified_hold_out,
    stratified_k_fold,
};
use ndarray::Array1;

/// Returns labels with class sizes 40, 17, 9 and 4, interleaved irregularly.
fn labels() -> Array1<usize> {
    let mut labels = Vec::new();
    for (class, n) in [(2, 40), (0, 17), (5, 9), (1, 4)] {
        labels.extend(std::iter::repeat_n(class, n));
    }
    (0..labels.len())
        .map(|i| labels[i * 37 % labels.len()])
        .collect()
}

fn is_partition(split: &Split, n_rows: usize) -> bool {
    let mut all = [split.train.as_slice(), &split.test].concat();
    all.sort_unstable();
    all == (0..n_rows).collect::<Vec<_>>()
}

fn count(labels: &Array1<usize>, rows: &[usize], class: usize) -> usize {
    rows.iter().filter(|&&row| labels[row] == class).count()
}

#[test]
fn every_row_is_in_a_hold_out_exactly_once_and_every_class_keeps_its_share() {
    let labels = labels();
    for fraction in [0.01, 0.25, 0.5, 0.99] {
        let split = stratified_hold_out(labels.view(), fraction, &Seed::new(1)).unwrap();
        assert!(is_partition(&split, labels.len()));
        for (class, n) in [(2, 40), (0, 17), (5, 9), (1, 4)] {
            let wanted = ((n as f64 * fraction).round() as usize).clamp(1, n - 1);
            assert_eq!(count(&labels, &split.test, class), wanted);
        }
    }
}

#[test]
fn folds_test_every_row_once_and_differ_by_at_most_one_row() {
    let labels = labels();
    let folds = stratified_k_fold(labels.view(), 4, &Seed::new(1)).unwrap();
    let mut tested: Vec<usize> = folds.iter().flat_map(|fold| fold.test.clone()).collect();
    tested.sort_unstable();
    assert_eq!(tested, (0..labels.len()).collect::<Vec<_>>());
    for class in [usize::MAX, 0, 1, 2, 5] {
        let sizes = folds.iter().map(|fold| match class {
            usize::MAX => fold.test.len(),
            class => count(&labels, &fold.test, class),
        });
        let sizes: Vec<usize> = sizes.collect();
        assert!(sizes.iter().max().unwrap() - sizes.iter().min().unwrap() <= 1);
    }
    assert!(folds.iter().all(|fold| is_partition(fold, labels.len())));
}

#[test]
fn a_split_depends_on_its_seed_alone() {
    let labels = labels();
    let draw = |seed| stratified_hold_out(labels.view(), 0.3, &Seed::new(seed)).unwrap();
    assert_eq!(draw(1), draw(1));
    assert_ne!(draw(1), draw(2));
}

#[test]
fn another_class_does_not_change_a_class_split() {
    let few = Array1::from_iter((0..30).map(|row| row % 2));
    let many = Array1::from_iter((0..30).map(|row| row % 2).chain([2; 10]));
    let few = stratified_hold_out(few.view(), 0.3, &Seed::new(3)).unwrap();
    let many = stratified_hold_out(many.view(), 0.3, &Seed::new(3)).unwrap();
    let common: Vec<usize> = many.test.into_iter().filter(|&row| row < 30).collect();
    assert_eq!(few.test, common);
}

#[test]
fn no_group_is_both_trained_on_and_tested() {
    // 12 poses; each contains each of 5 objects twice.
    let labels = Array1::from_iter((0..120).map(|row| row % 5));
    let groups = Array1::from_iter((0..120).map(|row| 100 + row / 10));
    let seed = Seed::new(4);
    let hold_out = group_hold_out(labels.view(), groups.view(), 0.25, &seed).unwrap();
    assert_eq!(hold_out.test.len(), 30, "3 of 12 poses");
    let folds = group_k_fold(labels.view(), groups.view(), 4, &seed).unwrap();
    assert!(folds.iter().all(|fold| fold.test.len() == 30));
    for split in folds.iter().chain([&hold_out]) {
        assert!(is_partition(split, 120));
        let of = |rows: &[usize]| rows.iter().map(|&row| groups[row]).collect::<BTreeSet<_>>();
        assert!(of(&split.train).is_disjoint(&of(&split.test)));
    }
    let n_tested: usize = folds.iter().map(|fold| fold.test.len()).sum();
    assert_eq!(n_tested, 120);
}

#[test]
fn groups_within_one_class_are_held_out_class_by_class() {
    // Copies of a touch share a group: 3 objects, 8 distinct touches each, 1 to 3 copies.
    let rows: Vec<(usize, usize)> = (0..24)
        .flat_map(|group| std::iter::repeat_n((group / 8, group), 1 + group % 3))
        .collect();
    let labels = Array1::from_iter(rows.iter().map(|row| row.0));
    let groups = Array1::from_iter(rows.iter().map(|row| row.1));
    let split = group_hold_out(labels.view(), groups.view(), 0.25, &Seed::new(5)).unwrap();
    let tested: BTreeSet<usize> = split.test.iter().map(|&row| groups[row]).collect();
    for class in 0..3 {
        let n_tested = tested.iter().filter(|&&group| group / 8 == class).count();
        assert_eq!(n_tested, 2, "a quarter of the 8 distinct touches");
    }
}

#[test]
fn smaller_training_sets_are_prefixes_with_equal_classes() {
    let labels = labels();
    let split = stratified_hold_out(labels.view(), 0.25, &Seed::new(6)).unwrap();
    for per_class in 1..=3 {
        let smaller = split.at_most(labels.view(), per_class).unwrap();
        assert_eq!(smaller.train, split.train[..4 * per_class]);
        assert_eq!(smaller.test, split.test);
        for class in [0, 1, 2, 5] {
            assert_eq!(count(&labels, &smaller.train, class), per_class);
        }
    }
    assert!(split.at_most(labels.view(), 0).is_err());
    let error = split.at_most(labels.view(), 4).unwrap_err().to_string();
    assert!(error.ends_with("1 to 3 is allowed, the fewest training rows of a class"));
}

#[test]
fn a_validation_split_stays_within_the_training_rows() {
    let labels = labels();
    let outer = stratified_hold_out(labels.view(), 0.25, &Seed::new(7)).unwrap();
    let training: Array1<usize> = outer.train.iter().map(|&row| labels[row]).collect();
    let inner = stratified_hold_out(training.view(), 0.34, &Seed::new(8)).unwrap();
    let validation = outer.within_train(&inner);
    assert!(validation.test.is_sorted());
    let mut both = [validation.train.as_slice(), &validation.test].concat();
    both.sort_unstable();
    let mut train = outer.train.clone();
    train.sort_unstable();
    assert_eq!(both, train);
}

#[test]
fn what_cannot_be_split_is_an_error_that_names_the_class() {
    let seed = Seed::new(9);
    let lonely = Array1::from(vec![0, 0, 0, 7]);
    let error = stratified_hold_out(lonely.view(), 0.5, &seed).unwrap_err();
    let few = "labels, class 7: 1 rows; at least 2 rows are needed for this split";
    assert_eq!(error.to_string(), few);
    let two = Array1::from(vec![0, 0, 1, 1]);
    for fraction in [0.0, 1.0, -0.5, f64::NAN] {
        assert!(stratified_hold_out(two.view(), fraction, &seed).is_err());
    }
    for k in [0, 1, 3] {
        assert!(stratified_k_fold(two.view(), k, &seed).is_err());
    }
    // Each class is one group.
    assert!(group_hold_out(two.view(), two.view(), 0.5, &seed).is_err());
    assert!(group_k_fold(two.view(), two.view(), 3, &seed).is_err());
    assert!(group_hold_out(two.view(), Array1::zeros(3).view(), 0.5, &seed).is_err());
    assert!(stratified_hold_out(Array1::zeros(0).view(), 0.5, &seed).is_err());
}

#[test]
fn a_given_hold_out_has_each_row_where_it_was_put_and_draws_the_order_alone() {
    let labels = ndarray::arr1(&[0, 0, 0, 1, 1, 1, 0, 1]);
    use Side::{LeftOut, Test, Train};
    let sides = [Train, Test, Train, LeftOut, Train, Test, LeftOut, Train];
    let split = given_hold_out(labels.view(), &sides, &Seed::new(1)).unwrap();
    let mut train = split.train.clone();
    train.sort_unstable();
    assert_eq!((train, split.test), (vec![0, 2, 4, 7], vec![1, 5]));
    // One row of each class, alternating.
    let classes: Vec<usize> = split.train.iter().map(|&row| labels[row]).collect();
    assert_eq!(classes, [0, 1, 0, 1]);
    assert!(given_hold_out(labels.view(), &sides[1..], &Seed::new(1)).is_err());
    assert!(given_hold_out(labels.view(), &[Train; 8], &Seed::new(1)).is_err());
}

#[test]
fn folds_of_groups_contain_every_class_evenly() {
    // Four classes, five recordings of each, four rows a recording.
    let labels = Array1::from_iter((0..80).map(|row| row / 20));
    let groups = Array1::from_iter((0..80).map(|row| row / 4));
    for seed in 0..20 {
        let folds = group_k_fold(labels.view(), groups.view(), 5, &Seed::new(seed)).unwrap();
        for fold in folds {
            assert!((0..4).all(|class| count(&labels, &fold.test, class) == 4));
        }
    }
    // Three classes share four groups: a and c are one fold, b and d the other.
    let labels = Array1::from(vec![1, 1, 0, 0, 2, 2]);
    let groups = Array1::from(vec![0, 1, 1, 2, 2, 3]);
    for seed in 0..20 {
        let seed = Seed::new(seed);
        let folds = group_k_fold(labels.view(), groups.view(), 2, &seed).unwrap();
        let held_out = group_hold_out(labels.view(), groups.view(), 0.25, &seed).unwrap();
        for fold in folds.iter().chain([&held_out]) {
            assert!([vec![0, 3, 4], vec![1, 2, 5]].contains(&fold.test));
        }
    }
    let error = group_k_fold(labels.view(), groups.view(), 3, &Seed::new(1)).unwrap_err();
    let few = "folds: 3, but class 0 has rows in only 2 groups; at most 2 with these groups: each needs a group of every class";
    assert_eq!(error.to_string(), few);
    // Three groups of two classes each: two of them are always in one fold, without the third class.
    let labels = Array1::from(vec![0, 1, 1, 2, 2, 0]);
    let groups = Array1::from(vec![0, 0, 1, 1, 2, 2]);
    let error = group_k_fold(labels.view(), groups.view(), 2, &Seed::new(1)).unwrap_err();
    let none = "folds: 2, but no division of the groups has every class in each; groups of which each class has two or more that can be apart";
    assert_eq!(error.to_string(), none);
}
