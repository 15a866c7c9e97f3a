//! Law: a changed key changes some byte of the results, or the study is rejected.

use super::generator::{GeneratedStudy, Generator, is_sample, keys};
use super::outcome::{Row, rows, run};
use bubbletouch::study::all_strengths;
use bubbletouch::study::progress::Silent;
use bubbletouch::study::table::TrialScore;
use bubbletouch::table::Columns;
use toml::Value;

/// Number of studies in which a key is tried before the key counts as having no effect.
const MAX_STUDIES: u64 = 12;

/// Results of a study: scores and predictions, without the columns that repeat settings.
#[derive(PartialEq)]
struct Results {
    scores: Vec<Row>,
    /// Content of `confusion.csv`.
    answers: Vec<u8>,
    /// Bits of the features of the first configuration, and the training rows.
    learned: Vec<u64>,
}

/// Returns the results of a study; `None` if the study is rejected.
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

/// Returns whether another value of `key` is refused or changes the results of one of several studies with these signal steps and keys.
fn has_effect(key: &str, steps: &[&str], beside: &[(&str, Value)]) -> bool {
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
                let steps: Vec<Value> = steps.iter().map(|&step| step.into()).collect();
                // A grid and several frames, which some sensor errors require.
                study = study
                    .without_all("skin.layout skin.damping_n_s_per_m touches.speed_mm_per_s")
                    .with("signal.steps", steps)
                    .with("touches.frames", 3);
            }
            for (key, value) in beside {
                study = study.with(key, value.clone());
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

/// Keys that every test run tries.
const SAMPLE: [&str; 5] = [
    "recognition.class_imbalance",
    "recognition.scaling",
    "recognition.c",
    "skin.stroke_mm",
    "touches.frames",
];

#[test]
fn a_changed_key_changes_some_byte_of_the_results() {
    let mut tried = SAMPLE.map(str::to_owned).to_vec();
    if !is_sample() {
        // The other keys have no effect without keys beside them, or change the number of rows.
        let is_alone = |key: &String| {
            let needing = "signal damping friction stiffness speed slide trials";
            let mut needing = needing.split(' ');
            !SAMPLE.contains(&&key[..]) && !needing.any(|word| key.contains(word))
        };
        tried.extend(keys().into_iter().filter(is_alone));
    }
    for key in tried {
        assert!(has_effect(&key, &[], &[]), "{key} has no effect");
    }
    let moves = ("touches.speed_mm_per_s", 10.0.into());
    let shear = ("skin.sensed", "shear".into());
    let slide = ("touches.slide_mm", 4.0.into());
    for (key, steps, beside) in [
        ("signal.noise_std_full_scale", &["noise"][..], vec![]),
        ("signal.smoothing_mm", &["smoothing"], vec![]),
        ("skin.stiffness_n_per_m", &["force"], vec![]),
        ("skin.damping_n_s_per_m", &["force"], vec![moves]),
        ("skin.friction", &["noise"], vec![shear, slide]),
    ] {
        assert!(has_effect(key, steps, &beside), "{key} has no effect");
    }
}

#[test]
fn a_changed_strength_of_a_sensor_error_changes_some_byte_of_the_results() {
    for (error, strength) in all_strengths() {
        let key = format!("signal.{}", strength.key);
        let about = error.about();
        let moves = ("touches.speed_mm_per_s", 10.0.into());
        let beside = Vec::from_iter(about.needs_motion.then_some(moves));
        let acts = has_effect(&key, &[about.step], &beside);
        assert!(acts, "{key} has no effect");
    }
}
