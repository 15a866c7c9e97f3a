//! The support vector machines against scikit-learn's results and the optimality conditions, on easy and difficult data sets.

use crate::drawn::params;
use crate::svm_conditions::Worth;
use bubbletouch_svm::dataset::{Dataset, dataset};
use bubbletouch_svm::kernel::{Gamma, Kernel};
use bubbletouch_svm::{BinaryProblem, Multiclass, SvmParams};
use linfa::DatasetBase;
use ndarray::{Array1, Array2, array, s};

/// Returns rows that Python reproduces bit by bit. The linear congruential generator `s ← (1103515245 s + 12345) mod 2³¹`, started at 12345, gives `s / 2³¹`;
/// class c shifts feature j by `0.25 (c (j + 2) mod 5)`.
fn generated(n_rows: usize, n_columns: usize, n_classes: usize) -> Dataset {
    let mut state = 12345_u64;
    let features = Array2::from_shape_fn((n_rows, n_columns), |(i, j)| {
        state = (state * 1_103_515_245 + 12345) % (1 << 31);
        state as f64 / (1_u64 << 31) as f64 + 0.25 * ((i % n_classes * (j + 2)) % 5) as f64
    });
    let labels = Array1::from_iter((0..n_rows).map(|i| i % n_classes));
    dataset(features, labels).unwrap()
}

/// Returns 80 training and 40 test rows of 4 features in 4 classes.
fn fixed() -> (Dataset, Array2<f64>) {
    let all = generated(120, 4, 4);
    let test = all.records.slice(s![80.., ..]).to_owned();
    let train = all.records.slice(s![..80, ..]).to_owned();
    (
        dataset(train, all.targets.slice(s![..80]).to_owned()).unwrap(),
        test,
    )
}

/// Returns the allowed difference from LIBSVM's decision values for any tolerance. LIBSVM stores kernel values in f32, and multipliers of up to C amplify their
/// rounding. (On classes 1 and 2, linear, C = 100, LIBSVM's solution at a tolerance of 1e-9 violates the optimality conditions by 1.4e-4, this crate's by
/// 1e-9.)
fn near(c: f64) -> f64 {
    1e-4 * c.sqrt()
}

const RBF: Kernel = Kernel::Rbf {
    gamma: Gamma::Scale,
};
const CUBIC: Kernel = Kernel::Polynomial {
    gamma: Gamma::Scale,
    coef0: 1.0,
    degree: 3,
};

fn digits(labels: &Array1<usize>) -> String {
    labels.iter().map(usize::to_string).collect()
}

/// Results of scikit-learn 1.9.1 on `fixed()` with SVC(C, kernel, gamma="scale", degree=3, coef0=1). The labels are computed with the default tolerance. The
/// decision values of the first test row and the sum of the pairs' dual objectives are computed with tol=1e-9.
const SCIKIT_LEARN: [(Kernel, f64, &str, [f64; 6], f64); 6] = [
    (
        Kernel::Linear,
        1.0,
        "0123012301230120032321030123032301230123",
        [
            1.501563536,
            1.318926053,
            1.4115571,
            -0.628503751,
            -0.543994928,
            -0.206455909,
        ],
        -70.42094188013797,
    ),
    (
        Kernel::Linear,
        100.0,
        "0123022301230120032321230323032001230113",
        [
            6.481878154,
            2.525664445,
            6.060794649,
            -0.707203693,
            -1.07281149,
            -1.031230275,
        ],
        -1990.3958642991047,
    ),
    (
        RBF,
        1.0,
        "0123032301230120032321030323032301230113",
        [
            1.262036056,
            1.254311998,
            1.176622927,
            0.19147599,
            -0.297148676,
            -0.234677654,
        ],
        -63.29598462810894,
    ),
    (
        RBF,
        100.0,
        "0123022303230120032321230323032201230113",
        [
            4.114052901,
            1.75534816,
            3.138452027,
            -0.018802961,
            -1.166220008,
            0.774799601,
        ],
        -469.7904133717947,
    ),
    (
        CUBIC,
        1.0,
        "0123022303230120032321230323032301230113",
        [
            3.918161857,
            1.990917736,
            3.345543902,
            -0.043859347,
            -0.874461499,
            -1.236145268,
        ],
        -16.908507235781546,
    ),
    (
        CUBIC,
        100.0,
        "0123022301230123032321230323032301230113",
        [
            4.989807863,
            1.990917736,
            3.894076326,
            4.782748056,
            -1.206917912,
            -1.403337976,
        ],
        -53.96048479793074,
    ),
];

#[test]
fn labels_decisions_and_objectives_are_those_of_scikit_learn() {
    let (train, test) = fixed();
    for (kernel, c, labels, decision, objective) in SCIKIT_LEARN {
        let usual = params(kernel, c, 1e-3).train(&train).unwrap();
        assert_eq!(
            digits(&usual.labels(test.view()).unwrap()),
            labels,
            "{kernel:?} {c}"
        );
        let exact = params(kernel, c, 1e-9).train(&train).unwrap();
        let values = exact.decision_values(test.view()).unwrap();
        for (ours, theirs) in values.row(0).iter().zip(decision) {
            assert!(
                (ours - theirs).abs() < near(c),
                "{kernel:?} {c}: {ours} and {theirs}"
            );
        }
        let given = params(kernel, c, 1e-3);
        let dual = |problem: &BinaryProblem| -Worth::new(&given, &train, problem).dual;
        let sum = |problems: &[BinaryProblem]| problems.iter().map(dual).sum::<f64>();
        assert!((sum(exact.problems()) / objective - 1.0).abs() < 1e-8);
        assert!((sum(usual.problems()) / objective - 1.0).abs() < 1e-4);
    }
}

#[test]
fn one_against_the_rest_is_that_of_scikit_learn() {
    // Results of scikit-learn 1.9.1 with SVC(C=1, tol=1e-9) for each class against the rest. The class with the largest decision value is predicted.
    let rbf = Kernel::Rbf {
        gamma: Gamma::Value(0.5),
    };
    let table = [
        (
            Kernel::Linear,
            "0123032101230120032301230123032301230123",
            [0.710870992, -1.916430603, -1.578925286, -1.585987075],
        ),
        (
            rbf,
            "0223032301230120032321230323032301230123",
            [0.755827785, -1.382307847, -1.231978773, -1.493095979],
        ),
    ];
    let (train, test) = fixed();
    for (kernel, labels, decision) in table {
        let params = SvmParams {
            multiclass: Multiclass::OneVsRest,
            ..params(kernel, 1.0, 1e-9)
        };
        let model = params.train(&train).unwrap();
        assert_eq!(digits(&model.labels(test.view()).unwrap()), labels);
        let values = model.decision_values(test.view()).unwrap();
        assert!(
            values
                .row(0)
                .iter()
                .zip(decision)
                .all(|(a, b)| (a - b).abs() < near(1.0))
        );
    }
}

#[test]
fn bad_input_is_refused_before_training() {
    let (train, test) = fixed();
    for c in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(params(Kernel::Linear, c, 1e-3).train(&train).is_err());
        assert!(params(Kernel::Linear, 1.0, c).train(&train).is_err());
    }
    let refusal = |features: Array2<f64>, labels: Array1<usize>| {
        let unchecked = DatasetBase::new(features, labels);
        SvmParams::default()
            .train(&unchecked)
            .unwrap_err()
            .to_string()
    };
    let mut broken = train.records.clone();
    broken[[7, 2]] = f64::NAN;
    let error = refusal(broken, train.targets.clone());
    assert_eq!(
        error,
        "features, row 7, column 2: NaN; only finite numbers are allowed"
    );
    let error = refusal(array![[1.0], [2.0]], array![4, 4]);
    assert_eq!(
        error,
        "labels: the single class 4; at least two classes are needed"
    );
    assert!(refusal(Array2::zeros((0, 2)), Array1::zeros(0)).starts_with("features"));
    assert!(refusal(array![[1.0], [2.0]], array![0]).starts_with("labels"));
    let model = SvmParams::default().train(&train).unwrap();
    assert!(model.labels(test.slice(s![.., ..3])).is_err());
    assert!(
        model
            .labels(array![[0.0, f64::NAN, 0.0, 0.0]].view())
            .is_err()
    );
    assert_eq!(model.labels(Array2::zeros((0, 4)).view()).unwrap().len(), 0);
}
