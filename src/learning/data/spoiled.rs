//! Deliberate defects of training data: wrong labels and class imbalance.

use crate::random::Seed;
use crate::{Error, Result};
use bubbletouch_svm::split::Split;
use ndarray::{Array1, ArrayView1};
use rand::Rng;
use rand::seq::SliceRandom;
use std::collections::BTreeMap;

/// Returns a copy of the labels in which a fraction (0 to 1) of the labels is replaced by wrong labels. In each class, the number of wrong labels is this
/// fraction of the class's rows, rounded to whole rows. A wrong label is drawn uniformly from the other classes.
///
/// For one seed, the wrong labels of a smaller fraction are a subset of the wrong labels of a larger fraction. With a single class, no label is changed.
///
/// # Errors
/// If the fraction is outside 0 to 1.
pub fn mislabelled(labels: ArrayView1<usize>, fraction: f64, seed: &Seed) -> Result<Array1<usize>> {
    if !(0.0..=1.0).contains(&fraction) {
        return Err(Error::input(
            "mislabelled fraction",
            fraction,
            "from 0 to 1",
        ));
    }
    let classes = rows_by_class(labels, 0..labels.len());
    let names: Vec<usize> = classes.keys().copied().collect();
    let mut wrong = labels.to_owned();
    for (place, (label, mut rows)) in classes.into_iter().enumerate() {
        if names.len() == 1 {
            break;
        }
        let mut rng = seed.named("mislabelled").numbered(label as u64).rng();
        rows.shuffle(&mut rng);
        let n_wrong = (fraction * rows.len() as f64).round() as usize;
        for &row in &rows[..n_wrong] {
            let further = rng.gen_range(1..names.len());
            wrong[row] = names[(place + further) % names.len()];
        }
    }
    Ok(wrong)
}

/// Returns a split with imbalanced training classes, whose sizes form a geometric sequence. Source: Cui et al., *Class-balanced loss based on effective number
/// of samples*, 2019. The K classes are put in random order. Let n be the smallest number of training rows of any class. Class r (from 0) keeps its first
/// n · ratio^(−r / (K − 1)) training rows, rounded. The first class therefore has `ratio` times as many rows as the last class. The test rows are unchanged.
///
/// # Errors
/// If the ratio is below 1 or not finite, or leaves a class without a row (above 2 n).
pub fn with_imbalance(
    split: &Split,
    labels: ArrayView1<usize>,
    ratio: f64,
    seed: &Seed,
) -> Result<Split> {
    let classes = rows_by_class(labels, split.train.iter().copied());
    let fewest = classes.values().map(Vec::len).min().unwrap_or(0);
    let most = 2.0 * fewest as f64;
    if !(1.0..=most).contains(&ratio) {
        return Err(Error::input(
            "class imbalance",
            ratio,
            format!("from 1 to {most}, twice the fewest training rows of a class"),
        ));
    }
    let mut order: Vec<usize> = classes.keys().copied().collect();
    order.shuffle(&mut seed.named("class imbalance").rng());
    let last = (order.len() - 1).max(1) as f64;
    let mut left = BTreeMap::new();
    for (rank, class) in order.into_iter().enumerate() {
        let kept = fewest as f64 * ratio.powf(-(rank as f64) / last);
        left.insert(class, kept.round().max(1.0) as usize);
    }
    let keep = |row: &usize| match left.get_mut(&labels[*row]) {
        Some(0) | None => false,
        Some(left) => {
            *left -= 1;
            true
        }
    };
    Ok(Split {
        train: split.train.iter().copied().filter(keep).collect(),
        test: split.test.clone(),
    })
}

fn rows_by_class(
    labels: ArrayView1<usize>,
    rows: impl IntoIterator<Item = usize>,
) -> BTreeMap<usize, Vec<usize>> {
    let mut classes = BTreeMap::<usize, Vec<usize>>::new();
    for row in rows {
        classes.entry(labels[row]).or_default().push(row);
    }
    classes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard_errors::{assert_expected, of_share};

    fn labels() -> Array1<usize> {
        (0..500).map(|row| 3 * (row % 5)).collect()
    }

    #[test]
    fn the_asked_share_of_each_class_is_wrong_and_more_include_fewer() {
        let (labels, seed) = (labels(), Seed::new(4));
        let mut before = labels.clone();
        for fraction in [0.0, 0.1, 0.33, 0.9, 1.0] {
            let wrong = mislabelled(labels.view(), fraction, &seed).unwrap();
            for class in 0..5 {
                let rows = (0..500).filter(|row| labels[*row] == 3 * class);
                let n_wrong = rows.filter(|row| wrong[*row] != labels[*row]).count();
                assert_eq!(n_wrong, (100.0 * fraction).round() as usize);
            }
            for row in 0..500 {
                assert!(before[row] == labels[row] || before[row] == wrong[row]);
                assert!(wrong[row].is_multiple_of(3) && wrong[row] < 15);
            }
            before = wrong;
        }
        // All labels are wrong; each of the four other classes receives about a quarter of the 400 rows.
        for class in 0..5 {
            let n = before.iter().filter(|&&label| label == 3 * class).count();
            assert_expected("label", n as f64, 100.0, 400.0 * of_share(0.25, 400));
        }
        for fraction in [-0.1, 1.1, f64::NAN] {
            assert!(mislabelled(labels.view(), fraction, &seed).is_err());
        }
        let one = Array1::from_elem(9, 7);
        assert_eq!(mislabelled(one.view(), 1.0, &seed).unwrap(), one);
    }

    #[test]
    fn classes_fall_from_the_most_frequent_to_the_rarest_by_equal_ratios() {
        let labels = labels();
        let whole = Split {
            train: (0..400).collect(),
            test: (400..500).collect(),
        };
        for (ratio, expected) in [
            (1.0, [80, 80, 80, 80, 80]),
            (16.0, [5, 10, 20, 40, 80]),
            (100.0, [1, 3, 8, 25, 80]),
        ] {
            let split = with_imbalance(&whole, labels.view(), ratio, &Seed::new(4));
            let split = split.unwrap();
            let classes = rows_by_class(labels.view(), split.train.iter().copied());
            let mut counts: Vec<usize> = classes.values().map(Vec::len).collect();
            counts.sort_unstable();
            assert_eq!(counts, expected, "{ratio}");
            assert_eq!(split.test, whole.test);
            assert!(split.train.is_sorted(), "leading rows, in their order");
        }
        for ratio in [0.5, 161.0, f64::NAN, f64::INFINITY] {
            let error = with_imbalance(&whole, labels.view(), ratio, &Seed::new(4));
            assert!(error.unwrap_err().to_string().contains("from 1 to 160"));
        }
    }
}
