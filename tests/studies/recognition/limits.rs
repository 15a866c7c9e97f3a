//! Where learning could break: C at its ends, wrong labels, classes of two rows and of one in a hundred. Each case has the
//! behaviour that `guide::limits` states.

use crate::svm_conditions::Worth;
use bubbletouch::random::Seed;
use bubbletouch::recognition::ClassifierKind;
use bubbletouch::recognition::classifiers::class_model::ClassModel;
use bubbletouch::recognition::classifiers::classifier::{Classifier, Cost};
use bubbletouch::recognition::classifiers::linear_svm::LinearSvmParams;
use bubbletouch::recognition::data::dataset::{Dataset, dataset};
use bubbletouch::recognition::data::spoiled::mislabelled;
use bubbletouch::recognition::svm::SvmParams;
use bubbletouch::recognition::svm::kernel::{Gamma, Kernel};
use ndarray::{Array1, Array2, array};
use rand::Rng;
use rand_distr::StandardNormal;

const KERNELS: [Kernel; 2] = [
    Kernel::Linear,
    Kernel::Rbf {
        gamma: Gamma::Value(0.5),
    },
];

const KINDS: [ClassifierKind; 8] = [
    ClassifierKind::LinearSvm,
    ClassifierKind::RbfSvm,
    ClassifierKind::PolynomialSvm,
    ClassifierKind::LogisticRegression,
    ClassifierKind::KNearest,
    ClassifierKind::NaiveBayes,
    ClassifierKind::DecisionTree,
    ClassifierKind::RandomForest,
];

/// Clusters around the corners of a simplex, `apart` standard deviations from the middle: so many rows of each class.
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

/// On a line: 0 1 0 1 0.
fn five() -> Dataset {
    dataset(
        array![[0.0], [1.0], [2.0], [3.0], [4.5]],
        array![0, 1, 0, 1, 0],
    )
    .unwrap()
}

#[test]
fn from_a_trillionth_to_a_trillion_of_c_a_solution_is_optimal_or_counted_as_capped() {
    let wrong = |data: Dataset, share| {
        let labels = mislabelled(data.targets.view(), share, &Seed::new(3)).unwrap();
        dataset(data.records, labels).unwrap()
    };
    let sets = [
        ("far apart", clusters(&[20, 20, 20], 8.0, 1)),
        ("overlapping", clusters(&[20, 20], 1.0, 2)),
        ("100 : 1", clusters(&[100, 1], 4.0, 3)),
        ("two rows a class", clusters(&[2; 6], 3.0, 4)),
        ("five rows that no point separates", five()),
        (
            "a third mislabelled",
            wrong(clusters(&[20, 20], 6.0, 5), 0.33),
        ),
        ("half mislabelled", wrong(clusters(&[12, 12], 6.0, 6), 0.5)),
    ];
    let mut n_capped = 0;
    for (name, data) in &sets {
        for kernel in KERNELS {
            // What no plane separates takes the ten million steps of the cap at a large C.
            let is_mixed = ["overlapping", "mislabelled", "no point"]
                .iter()
                .any(|word| name.contains(word));
            let largest = match kernel {
                Kernel::Linear if is_mixed => 2,
                _ => 12,
            };
            for exponent in (-12..=largest).step_by(2) {
                let params = SvmParams {
                    kernel,
                    c: 10f64.powi(exponent),
                    ..SvmParams::default()
                };
                let case = format!("{name}, {kernel:?}, C = 1e{exponent}");
                let model = params.train(data).unwrap();
                let values = model.decision_values(data.records.view()).unwrap();
                assert!(values.iter().all(|value| value.is_finite()), "{case}");
                n_capped += model.n_capped();
                let mut n_violated = 0;
                for problem in model.problems() {
                    let worth = Worth::of(&params, data, problem);
                    let allowed = 1.01 * params.tolerance + worth.rounding;
                    n_violated += usize::from(worth.violation > allowed);
                }
                assert!(
                    n_violated <= model.n_capped(),
                    "{case}: {n_violated} not optimal"
                );
            }
        }
    }
    assert!(n_capped < 40, "{n_capped}");
}

#[test]
fn at_a_tiny_c_every_multiplier_of_equal_classes_is_c_and_the_middles_decide() {
    // Then w = C (n₁ x̄₁ − n₀ x̄₀): the direction from mean to mean.
    let data = clusters(&[15, 15], 3.0, 7);
    for kernel in KERNELS {
        for c in [1e-12, 1e-9, 1e-6] {
            let params = SvmParams {
                kernel,
                c,
                ..SvmParams::default()
            };
            let model = params.train(&data).unwrap();
            let coefficients = &model.problems()[0].solution.coefficients;
            assert!(
                coefficients
                    .iter()
                    .all(|a| (a.abs() / c - 1.0).abs() < 1e-12)
            );
            let labels = model.labels(data.records.view()).unwrap();
            let n_right = labels
                .iter()
                .zip(&data.targets)
                .filter(|(a, b)| a == b)
                .count();
            assert!(n_right >= 27, "{kernel:?}, {c}: {n_right} of 30");
        }
    }
}

#[test]
fn at_an_enormous_c_what_can_be_separated_has_the_hard_margin() {
    // The nearest rows are at −1 and 1: w = 1, b = 0, both multipliers ½, whatever C.
    let data = dataset(
        array![[-1.0], [1.0], [-3.0], [2.0], [-7.0], [1.5]],
        array![0, 1, 0, 1, 0, 1],
    )
    .unwrap();
    for exponent in 0..=12 {
        let params = SvmParams {
            c: 10f64.powi(exponent),
            tolerance: 1e-9,
            ..SvmParams::default()
        };
        let model = params.train(&data).unwrap();
        let problem = &model.problems()[0];
        assert_eq!(model.n_capped(), 0);
        assert!(problem.solution.rho.abs() < 1e-8, "1e{exponent}");
        for (&row, a) in problem.rows.iter().zip(&problem.solution.coefficients) {
            let expected = if row < 2 { 0.5 } else { 0.0 };
            assert!((a.abs() - expected).abs() < 1e-8, "1e{exponent}: {a}");
        }
    }
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
            };
            let svm = params.train(data, &Seed::new(5)).unwrap();
            let case = format!("{name}, C = 1e{exponent}");
            assert!(svm.model().weights.iter().all(|w| w.is_finite()), "{case}");
            let open = svm.convergence().iter().filter(|end| {
                let gap = end.primal - end.dual;
                assert!(gap >= -1e-9 * end.primal.abs(), "{case}: {gap}");
                // Each row's margin is right to the tolerance, and costs up to C a unit.
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
            classifier.n_neighbours = 1;
            let model = classifier.train(&train, &Seed::new(1));
            let model = model.unwrap_or_else(|error| panic!("{name}, {kind:?}: {error}"));
            let labels = model.labels(test.records.view()).unwrap();
            let right = labels.iter().zip(&test.targets).filter(|(a, b)| a == b);
            let share = right.count() as f64 / labels.len() as f64;
            println!("{name}, {kind:?}: {share}");
            // A tree has one split to place, and Gaussians of one row no width of their own.
            let least = match kind {
                ClassifierKind::DecisionTree
                | ClassifierKind::NaiveBayes
                | ClassifierKind::RandomForest => 0.4,
                _ => 0.85,
            };
            assert!(share >= least, "{name}, {kind:?}: {share}");
        }
    }
}

#[test]
fn wrong_labels_cost_a_wide_margin_nothing_until_they_are_the_majority() {
    // Two classes far apart. Up to four in ten wrong labels, a soft margin holds; past half, it is turned round.
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
            let n_right = labels.iter().zip(&test.targets).filter(|(a, b)| a == b);
            let accuracy = n_right.count() as f64 / labels.len() as f64;
            assert!(
                range.contains(&accuracy),
                "{kind:?}, {share} wrong: {accuracy}"
            );
        }
    }
}
