//! Classifiers from outside of the crate give their own labels, and decisions on several touches from their probabilities or votes.

use bubbletouch_svm::classifiers::ClassifierKind;
use bubbletouch_svm::classifiers::classifier::{Classifier, TrainedClassifier};
use bubbletouch_svm::classifiers::foreign::{
    Foreign, ForeignClassifier, ForeignModel, LinfaClassifier,
};
use bubbletouch_svm::dataset::Dataset;
use bubbletouch_svm::{Error, Result};
use ndarray::{Array1, Array2, ArrayView2, array};
use serde_json::{Value, json};
use std::sync::Arc;

/// Rows of three classes with the labels 2, 5, 9; class 2 has twice as many rows.
fn data() -> Dataset {
    let labels: Array1<usize> = (0..60).map(|row| [2, 5, 2, 9][row % 4]).collect();
    let value = |(row, column): (usize, usize)| {
        labels[row] as f64 * (column + 1) as f64 + 4.0 * (1.7 * (row * 3 + column) as f64).sin()
    };
    Dataset::new(Array2::from_shape_fn((60, 3), value), labels.clone())
}

/// Model of this crate, as a program would provide it.
struct Ours {
    kind: ClassifierKind,
    has_probabilities: bool,
}

struct OurModel(TrainedClassifier, bool);

impl ForeignClassifier for Ours {
    fn fit(&self, rows: &Dataset, seed: u32) -> Result<Box<dyn ForeignModel>> {
        let trained = Classifier::new(self.kind).train(rows, &u64::from(seed))?;
        Ok(Box::new(OurModel(trained, self.has_probabilities)))
    }
}

impl ForeignModel for OurModel {
    fn predict(&self, rows: ArrayView2<f64>) -> Result<Vec<usize>> {
        Ok(self.0.labels(rows)?.to_vec())
    }

    fn log_probabilities(&self, rows: ArrayView2<f64>) -> Result<Option<Array2<f64>>> {
        let prior = array![0.5_f64, 0.25, 0.25].mapv(f64::ln);
        Ok(self.1.then_some(self.0.scores(rows)? + prior))
    }
}

fn trained(foreign: Foreign) -> Result<TrainedClassifier> {
    Classifier::new(ClassifierKind::Foreign(foreign)).train(&data(), &7_u64)
}

#[test]
fn a_foreign_classifier_gives_the_labels_and_scores_of_its_code() {
    let kind = ClassifierKind::LogisticRegression;
    let foreign = Foreign::new("ours", "1").unwrap();
    let provided = foreign.provide(Arc::new(Ours {
        kind,
        has_probabilities: true,
    }));
    let (data, ours) = (
        data(),
        Classifier::new(kind).train(&data(), &7_u64).unwrap(),
    );
    let theirs = trained(foreign).unwrap();
    let rows = data.records.view();
    assert_eq!(theirs.labels(rows).unwrap(), ours.labels(rows).unwrap());
    // A decision on three touches of one object adds log-probabilities, whatever prior they contain.
    let fused = |scores: Array2<f64>| {
        Array2::from_shape_fn((20, 3), |(row, class)| {
            let touches = (0..3).map(|touch| (4 * row + touch * 20) % 60);
            touches.map(|touch| scores[[touch, class]]).sum::<f64>()
        })
    };
    let prior = array![0.5_f64, 0.25, 0.25].mapv(f64::ln);
    let sums = fused(ours.scores(rows).unwrap() + prior);
    let largest = sums.outer_iter().map(|sums| {
        let best = (0..3).max_by(|a, b| sums[*a].total_cmp(&sums[*b]));
        [2, 5, 9][best.unwrap()]
    });
    let decided = theirs.labels_of_scores(fused(theirs.scores(rows).unwrap()).view());
    assert_eq!(decided.to_vec(), largest.collect::<Vec<_>>());
    drop(provided);
    let error = trained(foreign).unwrap_err().to_string();
    assert!(
        error.contains("classifier ours: no code for version 1"),
        "{error}"
    );
}

#[test]
fn without_probabilities_labels_are_votes() {
    let kind = ClassifierKind::NearestCentroid;
    let foreign = Foreign::new("votes", "1").unwrap();
    let _provided = foreign.provide(Arc::new(Ours {
        kind,
        has_probabilities: false,
    }));
    let model = trained(foreign).unwrap();
    let scores = model.scores(data().records.view()).unwrap();
    let labels = model.labels(data().records.view()).unwrap();
    assert_eq!(model.labels_of_scores(scores.view()), labels);
    assert!(scores.iter().all(|score| score.is_finite()));
}

/// Model whose log-probabilities all have one value, in arrays of this width.
#[derive(Clone, Copy)]
struct Constant(f64, usize);

impl ForeignClassifier for Constant {
    fn fit(&self, _: &Dataset, _: u32) -> Result<Box<dyn ForeignModel>> {
        Ok(Box::new(*self))
    }
}

impl ForeignModel for Constant {
    fn predict(&self, rows: ArrayView2<f64>) -> Result<Vec<usize>> {
        Ok(vec![2; rows.nrows()])
    }

    fn log_probabilities(&self, rows: ArrayView2<f64>) -> Result<Option<Array2<f64>>> {
        Ok(Some(Array2::from_elem((rows.nrows(), self.1), self.0)))
    }
}

#[test]
fn log_probabilities_are_finite_or_refused() {
    for (value, width, is_allowed) in [
        (f64::NEG_INFINITY, 3, true),
        (f64::NAN, 3, false),
        (-1.0, 2, false),
    ] {
        let foreign = Foreign::new("constant", "1").unwrap();
        let _provided = foreign.provide(Arc::new(Constant(value, width)));
        match trained(foreign).unwrap().scores(data().records.view()) {
            Ok(scores) => assert!(is_allowed && scores.iter().all(|score| score.is_finite())),
            Err(error) => assert!(!is_allowed && error.to_string().contains("without NaN")),
        }
    }
}

#[test]
fn a_name_is_an_identity_with_its_version() {
    let [one, other] = ["1", "2"].map(|version| Foreign::new("same", version).unwrap());
    assert_eq!(one, Foreign::new("same", "1").unwrap());
    assert!(one != other && one < other);
    assert_eq!(
        format!("{:?}", ClassifierKind::Foreign(one)),
        "Foreign(same@1)"
    );
    assert_eq!(Foreign::named("same@2"), Some(other));
    assert_eq!(Foreign::named("same"), None);
    let ours = || {
        Arc::new(Ours {
            kind: ClassifierKind::KNearest,
            has_probabilities: false,
        })
    };
    let outer = one.provide(ours());
    let inner = other.provide(ours());
    assert_eq!(Foreign::named("same"), Some(other));
    assert_eq!(Foreign::given(), [one, other]);
    drop(inner);
    assert_eq!(Foreign::named("same"), Some(one));
    drop(outer);
    assert!(Foreign::given().is_empty() && !one.is_provided());
    for (name, version) in [
        ("", "1"),
        ("a", ""),
        ("a@b", "1"),
        ("a", "1 2"),
        ("rbf_svm", "1"),
    ] {
        assert!(Foreign::new(name, version).is_err(), "{name} {version}");
    }
}

#[test]
fn any_classifier_of_linfa_is_a_foreign_classifier() {
    let neighbours = LinfaClassifier::<_, bubbletouch_svm::Error>::new(Classifier::new(
        ClassifierKind::KNearest,
    ));
    let foreign = Foreign::new("linfa", "1").unwrap();
    let _provided = foreign.provide(Arc::new(neighbours));
    let rows = data().records;
    let ours = Classifier::new(ClassifierKind::KNearest)
        .train(&data(), &0_u64)
        .unwrap();
    assert_eq!(
        trained(foreign).unwrap().labels(rows.view()).unwrap(),
        ours.labels(rows.view()).unwrap()
    );
}

#[test]
fn a_value_of_a_parameter_is_a_version_of_its_own_with_the_code_of_the_value() {
    let neighbours =
        |k: usize| Classifier::new(ClassifierKind::KNearest).with("n_neighbours", k as f64);
    let linfa = LinfaClassifier::<_, Error>::new(neighbours(5).unwrap()).with_parameters(
        move |given| match (given.len(), given.get("k").and_then(Value::as_u64)) {
            (1, Some(k)) => neighbours(k as usize),
            _ => Err(Error::input("parameters", "others", "k")),
        },
    );
    let foreign = Foreign::new("swept", "1").unwrap();
    let of = |values: Value| foreign.with(values.as_object().unwrap());
    let provided = foreign.provide(Arc::new(linfa));
    let rows = data().records;
    let mut answers = Vec::new();
    for k in [1, 5, 59] {
        let own = of(json!({ "k": k }));
        assert_eq!((own.name(), own), ("swept", of(json!({ "k": k }))));
        assert_ne!(own.version(), foreign.version());
        let labels = trained(own).unwrap().labels(rows.view()).unwrap();
        let alone = neighbours(k).unwrap().train(&data(), &0_u64).unwrap();
        assert_eq!(labels, alone.labels(rows.view()).unwrap());
        answers.push(labels);
    }
    assert_ne!(answers[1], answers[2]);
    assert_eq!(
        answers[1],
        trained(foreign).unwrap().labels(rows.view()).unwrap()
    );
    assert_eq!(of(json!({})), foreign);
    for refused in [
        json!({ "j": 3 }),
        json!({ "k": 3, "j": 3 }),
        json!({ "k": 0 }),
    ] {
        assert!(of(refused).check_parameters().is_err());
    }
    let other = Foreign::new("unswept", "1").unwrap();
    let _other = other.provide(Arc::new(LinfaClassifier::<_, Error>::new(
        neighbours(5).unwrap(),
    )));
    let said = other
        .with(json!({ "k": 3 }).as_object().unwrap())
        .check_parameters();
    assert!(
        said.unwrap_err()
            .to_string()
            .contains("parameters: k; none")
    );
    // Without code, nothing can be checked, and nothing is trained.
    drop(provided);
    let own = of(json!({ "j": 3 }));
    assert!(
        own.check_parameters().is_ok() && own.check_provided().is_err() && trained(own).is_err()
    );
}
