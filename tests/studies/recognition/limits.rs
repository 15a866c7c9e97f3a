//! Difficult training data: wrong labels, classes of two rows, and a class of one row in a hundred. Each case has the behaviour that `guide::limits` states.

use bubbletouch::random::Seed;
use bubbletouch::recognition::ClassifierKind;
use bubbletouch::recognition::classifiers::class_model::ClassModel;
use bubbletouch::recognition::classifiers::classifier::{Classifier, Cost};
use bubbletouch::recognition::classifiers::linear_svm::LinearSvmParams;
use bubbletouch::recognition::data::dataset::{Dataset, dataset};
use bubbletouch::recognition::data::spoiled::mislabelled;
use ndarray::{Array1, Array2};
use rand::Rng;
use rand_distr::StandardNormal;

const KINDS: [ClassifierKind; 7] = [
    ClassifierKind::LinearSvm,
    ClassifierKind::RbfSvm,
    ClassifierKind::PolynomialSvm,
    ClassifierKind::LogisticRegression,
    ClassifierKind::KNearest,
    ClassifierKind::NaiveBayes,
    ClassifierKind::RandomForest,
];

/// Returns Gaussian clusters around the corners of a simplex, `apart` standard deviations from its middle, with the given number of rows per class.
fn clusters(counts: &[usize], apart: f64, seed: u64) -> Dataset {
    let mut rng = Seed::new(seed).named("clusters").rng();
    let labels: Vec<usize> = (0..*counts.iter().max().unwrap())
        .flat_map(|turn| (0..counts.len()).filter(move |&class| turn < counts[class]))
        .collect();
    let features = Array2::from_shape_fn((labels.len(), counts.len()), |(row, column)| {
        let noise: f64 = rng.sample(StandardNormal);
        noise + if labels[row] == column { apart } else { 0.0 }
    });
    dataset(features, Array1::from(labels)).unwrap()
}

fn accuracy(labels: &Array1<usize>, data: &Dataset) -> f64 {
    let n_correct = labels.iter().zip(&data.targets).filter(|(a, b)| a == b);
    n_correct.count() as f64 / labels.len() as f64
}

#[test]
fn primal_linear_svms_close_their_gap_or_are_counted_as_capped_at_any_c() {
    let (overlapping, apart) = (clusters(&[30, 20, 10], 1.0, 8), clusters(&[20; 3], 6.0, 9));
    for (data, name) in [(&overlapping, "overlapping"), (&apart, "far apart")] {
        for exponent in (-12..=12).step_by(3) {
            let params = LinearSvmParams {
                c: 10f64.powi(exponent),
                tolerance: 0.01,
                max_passes: 1000,
                ..LinearSvmParams::default()
            };
            let svm = params.train(data, &Seed::new(5)).unwrap();
            let case = format!("{name}, C = 1e{exponent}");
            assert!(svm.model().weights.iter().all(|w| w.is_finite()), "{case}");
            let open = svm.convergence().iter().filter(|end| {
                let gap = end.primal - end.dual;
                assert!(gap >= -1e-9 * end.primal.abs(), "{case}: {gap}");
                // Each row's margin is correct to the tolerance, and costs up to C per unit.
                gap > 2.0 * params.tolerance * params.c * data.targets.len() as f64
            });
            assert!(open.count() <= svm.n_capped(), "{case}");
        }
    }
}

#[test]
fn every_classifier_learns_from_two_rows_a_class_and_from_a_hundred_to_one() {
    for (name, train, per_class) in [
        ("two rows a class", clusters(&[2; 5], 12.0, 10), 40),
        ("100 : 1", clusters(&[100, 1], 12.0, 11), 40),
        ("one row a class", clusters(&[1; 4], 12.0, 12), 40),
    ] {
        let n_classes = train.targets.iter().max().unwrap() + 1;
        let test = clusters(&vec![per_class; n_classes], 12.0, 13);
        for kind in KINDS {
            let mut classifier = Classifier::new(kind);
            classifier.c = Cost::Fixed(1e3);
            if kind == ClassifierKind::KNearest {
                classifier = classifier.with("n_neighbours", 1.0).unwrap();
            }
            let model = classifier.train(&train, &Seed::new(1));
            let model = model.unwrap_or_else(|error| panic!("{name}, {kind:?}: {error}"));
            let labels = model.labels(test.records.view()).unwrap();
            let share = accuracy(&labels, &test);
            // A tree has to place one split, and Gaussians of one row have no width of their own.
            let least = match kind {
                ClassifierKind::NaiveBayes | ClassifierKind::RandomForest => 0.4,
                _ => 0.85,
            };
            assert!(share >= least, "{name}, {kind:?}: {share}");
        }
    }
}

#[test]
fn wrong_labels_cost_a_wide_margin_nothing_until_they_are_the_majority() {
    // Two classes far apart. A soft margin tolerates up to four of ten wrong labels; beyond half, it is reversed.
    let right = clusters(&[200, 200], 8.0, 14);
    let test = clusters(&[200, 200], 8.0, 15);
    for kind in [ClassifierKind::LinearSvm, ClassifierKind::RbfSvm] {
        for (share, range) in [
            (0.2, 0.95..=1.0),
            (0.4, 0.9..=1.0),
            (0.6, 0.0..=0.1),
            (1.0, 0.0..=0.05),
        ] {
            let labels = mislabelled(right.targets.view(), share, &Seed::new(6)).unwrap();
            let data = dataset(right.records.clone(), labels).unwrap();
            let mut classifier = Classifier::new(kind);
            classifier.c = Cost::Fixed(0.01);
            let model = classifier.train(&data, &Seed::new(1)).unwrap();
            let labels = model.labels(test.records.view()).unwrap();
            let accuracy = accuracy(&labels, &test);
            assert!(range.contains(&accuracy), "{kind:?}, {share}: {accuracy}");
        }
    }
}
