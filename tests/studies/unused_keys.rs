//! Keys without effect: a written default is accepted, and any other value has an effect or is refused with a reason.

use crate::command::says;
use bubbletouch::Result;
use bubbletouch::kinds::Study;
use bubbletouch::kinds::recognition::RecognitionStudy;
use bubbletouch::recognition::ClassifierKind;
use bubbletouch::recognition::svm::classifiers::parameters;
use bubbletouch::study::{Plan, StudySpec};
use toml::{Table, Value};

/// Returns a study with these keys of `[recognition]`.
fn text(recognition: &str) -> String {
    include_str!("../fixtures/texts/unused_keys.toml").to_owned() + recognition
}

fn planned(text: &str) -> Result<()> {
    let spec = StudySpec::parse("x.toml", text)?;
    Plan::variants("x.toml", spec).map(drop)
}

/// Returns another value than the default of a key.
fn other(key: &str, default: &Value) -> Value {
    match (key, default) {
        ("multiclass", _) => "one_vs_rest".into(),
        ("solver", _) => "coordinate_descent".into(),
        ("scaling", _) => "none".into(),
        ("class_weight", _) => "balanced".into(),
        ("split", _) => "unseen_depth".into(),
        ("next_touch", _) => "farthest".into(),
        ("test_fraction" | "mislabelled_fraction", _) => 0.5.into(),
        (_, Value::Integer(n)) => (n + 1).into(),
        (_, Value::Float(number)) => (1.5 * number).into(),
        _ => panic!("{key} = {default} has no other value in this test"),
    }
}

#[test]
fn a_written_default_is_accepted_and_another_value_acts_or_is_refused_with_a_reason() {
    let keys = RecognitionStudy::keys().into_iter();
    let keys = keys.filter(|key| !["features", "parameters"].contains(&key.name()));
    let usual = keys.filter_map(|key| {
        let name = key.path.strip_prefix("recognition.")?;
        Some((name.to_owned(), key.usual_value()?))
    });
    let usual: Table = usual.collect();
    for key in "c n_trees degree cv_folds tilt_augmentation test_fraction".split(' ') {
        assert!(usual.contains_key(key), "{key}");
    }
    for features in ["raw", "polar_harmonics"] {
        for (kind, (name, _)) in ClassifierKind::ALL.iter().zip(ClassifierKind::NAMES) {
            let with = |key: &str, value: &Value| {
                let mut keys = Table::new();
                keys.insert("features".into(), features.into());
                keys.insert("classifier".into(), (*name).into());
                keys.insert(key.to_owned(), value.clone());
                text(&keys.to_string())
            };
            for (key, default) in usual.iter().filter(|(key, _)| *key != "classifier") {
                planned(&with(key, default)).unwrap_or_else(|error| panic!("{name}: {error}"));
                let changed = with(key, &other(key, default));
                let is_of_classifier = parameters::keys().any(|own| own == key);
                match planned(&changed) {
                    Ok(()) => assert!(!is_of_classifier || kind.uses(key), "{name}: {key}"),
                    Err(error) => {
                        let said = error.to_string();
                        let has_reason = [", but ", " without ", "uniform", "linear_svm", "beside"];
                        says(&said, &[&format!("key recognition.{key}")]);
                        let mut reasons = has_reason.iter();
                        assert!(reasons.any(|words| said.contains(words)), "{said}");
                    }
                }
            }
        }
    }
    // A list of the default alone is the default.
    let knn = "classifier = \"k_nearest\"\n";
    planned(&text(&format!("{knn}c = [1.0]"))).unwrap();
    let two = planned(&text(&format!("{knn}c = [1.0, 2.0]")));
    let said = two.unwrap_err().to_string();
    says(&said, &["recognition.c", "no classifier"]);
}
