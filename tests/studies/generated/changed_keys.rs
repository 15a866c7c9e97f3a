//! Law: a changed key changes some byte of the results, or is refused.

use super::generator::{GeneratedStudy, Generator};
use super::outcome::{Row, rows, run};
use bubbletouch::study::all_strengths;
use bubbletouch::study::progress::Silent;
use bubbletouch::study::table::TrialScore;
use bubbletouch::table::Columns;

/// Studies in which a key is tried before it counts as one without effect: a small study may give the same answers by chance.
const MAX_STUDIES: u64 = 12;

/// What a study found: scores and answers, without the columns that repeat settings.
#[derive(PartialEq)]
struct Results {
    scores: Vec<Row>,
    /// `confusion.csv`
    answers: Vec<u8>,
    /// Bits of the numbers that the classifier of the first configuration learns from, and the rows that train it.
    learned: Vec<u64>,
}

/// Returns what a study found; `None` if it is refused.
fn results(study: &GeneratedStudy) -> Option<Results> {
    let loaded = study.load().ok()?;
    let tables = run(&loaded).ok()?;
    let mut scores = rows(&tables["accuracy.csv"]);
    let columns = TrialScore::columns();
    for row in &mut scores {
        row.retain(|name, _| columns.iter().any(|column| column.name == name[..]));
        row.remove("c_used");
    }
    let set = loaded.first().features((0, 0), &Silent).ok()?;
    let values = set.data.records.iter().map(|value| value.to_bits());
    let train = set.split.train.iter().map(|&row| row as u64);
    Some(Results {
        scores,
        answers: tables["confusion.csv"].clone(),
        learned: values.chain(train).collect(),
    })
}

/// Whether another value of `key` is refused or changes results in one of several studies.
fn has_effect(key: &str, steps: &[&str]) -> bool {
    let mut is_refused = true;
    let has_changed = (0..MAX_STUDIES).any(|number| {
        let mut generator = Generator::new(key, number);
        let mut values = generator.values(key);
        assert!(values.len() >= 2, "{key} has values: {values:?}");
        let first = values.swap_remove(0);
        let with_key = |study: &GeneratedStudy| {
            let mut study = study.clone();
            if !steps.is_empty() {
                study.table.remove("signal");
                let steps: Vec<toml::Value> = steps.iter().map(|&step| step.into()).collect();
                // A moving press and a grid, which some sensor errors need.
                study = study
                    .without("skin.layout")
                    .with("signal.steps", steps)
                    .with("touches.frames", 3)
                    .with("touches.speed_mm_per_s", 10.0);
            }
            study.with(key, first.clone())
        };
        let study = with_key(&generator.study(|study| with_key(study).load().is_ok()));
        let Some(before) = results(&study) else {
            return false;
        };
        values.into_iter().any(|value| {
            let after = results(&study.with(key, value));
            is_refused &= after.is_none();
            after.is_some_and(|after| before != after)
        })
    });
    has_changed || is_refused
}

#[test]
fn a_changed_key_changes_some_byte_of_the_results() {
    for key in [
        "seed",
        "skin.pitch_mm",
        "skin.taxels",
        "skin.stroke_mm",
        "skin.layout",
        "touches.depth_mm",
        "touches.frames",
        "touches.per_object",
        "sensing.ensemble",
        "sensing.ratio",
        "recognition.features",
        "recognition.classifier",
        "recognition.scaling",
        "recognition.train_touches",
        "recognition.mislabelled_fraction",
        "recognition.class_imbalance",
        "recognition.fused_touches",
        "recognition.test_fraction",
        "recognition.c",
        "recognition.gamma",
        "recognition.n_neighbours",
        "recognition.n_trees",
        "recognition.over_time",
        "recognition.tilted_copies",
        "recognition.foremost_full_scale",
        "recognition.training_readings",
    ] {
        assert!(has_effect(key, &[]), "{key} has no effect");
    }
    for (key, step) in [
        ("signal.noise_std_full_scale", "noise"),
        ("signal.smoothing_mm", "smoothing"),
        // They change what is read only where forces are.
        ("skin.stiffness_n_per_m", "force"),
        ("skin.damping_n_s_per_m", "force"),
    ] {
        assert!(has_effect(key, &[step]), "{key} has no effect");
    }
}

#[test]
fn a_changed_strength_of_a_sensor_error_changes_some_byte_of_the_results() {
    for (error, strength) in all_strengths() {
        let key = format!("signal.{}", strength.key);
        let step = error.about().step;
        assert!(has_effect(&key, &[step]), "{key} has no effect");
    }
}
