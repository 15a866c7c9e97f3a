//! Law: the order of configurations and the name of the study file change nothing but the order of rows.

use super::generator::{GeneratedStudy, Generator, n_studies};
use super::outcome::{rows, run, sorted_without};
use bubbletouch::study::progress::Silent;
use toml::Value;

#[test]
fn the_order_of_configurations_changes_nothing_but_their_numbers() {
    for number in 0..n_studies() {
        let mut generator = Generator::new("order of configurations", number);
        let study = generator.study(|_| true);
        let forward = ["signal.noise_std_full_scale", "recognition.classifier"];
        let mut ahead = study.clone();
        let mut back = study.clone();
        for key in forward.iter().filter(|key| study.get(key).is_some()) {
            let mut values = generator.values(key);
            values.truncate(3);
            ahead = ahead.swept(key, values.clone());
            values.reverse();
            back = back.swept(key, values);
        }
        let (Ok(ahead), Ok(back)) = (ahead.load(), back.load()) else {
            continue;
        };
        let (Ok(ahead), Ok(back)) = (run(&ahead), run(&back)) else {
            continue;
        };
        for table in ["accuracy.csv", "summary.csv"] {
            let [ahead, back] =
                [&ahead, &back].map(|tables| sorted_without(rows(&tables[table]), &["cell"]));
            assert_eq!(ahead, back, "{table} of\n{}", study.text());
        }
    }
}

/// The frames of each object's touches, before the signal chain, sorted by the object's name.
fn frames_by_object(study: &GeneratedStudy) -> Vec<(String, Vec<f64>)> {
    let loaded = study.load().unwrap();
    let part = loaded.first();
    let on = (&part.plan.arrays[0], 1);
    let frames = part.touched.simulate(on, &Silent);
    let frames = frames.to_array();
    let mut by_object = Vec::new();
    for (label, name) in part.touched.class_names().into_iter().enumerate() {
        let touches = part.touched.labels();
        let touches = touches.iter().enumerate().filter(|(_, of)| **of == label);
        let values = touches.flat_map(|(touch, _)| frames.row(touch).to_vec());
        by_object.push((name.to_owned(), values.collect()));
    }
    by_object.sort_by(|a, b| a.0.cmp(&b.0));
    by_object
}

#[test]
fn the_order_of_objects_changes_no_touch() {
    for number in 0..n_studies() {
        let study = Generator::new("order of objects", number).study(|_| true);
        let names = study.get("objects.names").and_then(Value::as_array);
        let mut names = names.unwrap().clone();
        names.reverse();
        let back = study.with("objects.names", names);
        let (ahead, back) = (frames_by_object(&study), frames_by_object(&back));
        assert!(
            ahead
                .iter()
                .any(|(_, frames)| frames.iter().any(|&value| value > 0.0))
        );
        assert!(ahead == back, "{}", study.text());
    }
}
