//! Law: repeating a trial never increases significance.

use super::generator::{GeneratedStudy, Generator, n_studies};
use super::outcome::{Row, Tables, rows, run};
use toml::Value;

/// Minimum ratio of the widths of two intervals that count as equal. Each trial reorders the training rows, which changes single predictions; ten times as many
/// independent trials would give a ratio of 0.32.
const SAME: f64 = 0.97;

fn number(row: &Row, column: &str) -> Option<f64> {
    row.get(column).and_then(|text| text.parse().ok())
}

#[test]
fn trials_that_are_the_same_make_no_claim_stronger() {
    for number_of_study in 0..n_studies() {
        let mut generator = Generator::new("repeated trials", number_of_study);
        // Two fixed splits and nothing drawn by trial, so every second trial is the same.
        let fixed = |study: &GeneratedStudy| {
            let yaws: Vec<Value> = [0.0, 20.0, 40.0, 60.0].map(Value::from).to_vec();
            let classifiers = ["linear_svm", "nearest_centroid"].map(Value::from);
            let drawn = "recognition.test_fraction recognition.train_touches recognition.mislabelled_fraction \
                         recognition.class_imbalance recognition.readings_per_touch recognition.touches_per_decision \
                         recognition.folds recognition.tilt_augmentation sensing.ratio";
            let mut study = study
                .without_all(drawn)
                .classified_by(classifiers.to_vec())
                .with("sensing.ensemble", "identity")
                .with("recognition.split", "half_of_yaws")
                .with("touches.yaw_deg", yaws);
            study.table.remove("signal");
            study.with("signal.steps", Vec::<Value>::new())
        };
        let study = fixed(&generator.study(|study| fixed(study).load().is_ok()));
        let of_trials = |n: i64| run(&study.with("trials", n).load().unwrap()).unwrap();
        assert_no_stronger(&of_trials(2), &of_trials(20), &study);
    }
}

/// Asserts that with more repetitions of the same trials, no p-value is smaller and no interval is narrower.
fn assert_no_stronger(few: &Tables, many: &Tables, study: &GeneratedStudy) {
    let of = |name: &str| rows(&few[name]).into_iter().zip(rows(&many[name]));
    for (few, many) in of("comparison.csv") {
        let p = [few, many].map(|row| number(&row, "p_value").unwrap_or(1.0));
        assert!(p[1] >= p[0] - 1e-9, "p {p:?} of\n{}", study.text());
    }
    for (few, many) in of("summary.csv") {
        for [low, high] in [
            ["accuracy_low", "accuracy_high"],
            ["bootstrap_low", "bootstrap_high"],
        ] {
            let width = |row: &Row| Some(number(row, high)? - number(row, low)?);
            if let (Some(few), Some(many)) = (width(&few), width(&many)) {
                let widths = format!("{low}: {few} and {many}");
                assert!(many >= SAME * few, "{widths} of\n{}", study.text());
            }
        }
    }
}
