//! Law: the order of configurations and objects, and the names of objects, change only the order of rows and names.

use super::generator::{GeneratedStudy, Generator, n_studies};
use super::outcome::{rows, run, sorted_without};
use crate::command::Case;
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
        let found = |study: &GeneratedStudy| study.load().and_then(|study| run(&study));
        let (Ok(ahead), Ok(back)) = (found(&ahead), found(&back)) else {
            continue;
        };
        for table in ["accuracy.csv", "summary.csv"] {
            let [ahead, back] = [&ahead, &back]
                .map(|tables| sorted_without(rows(&tables[table]), &["configuration"]));
            assert_eq!(ahead, back, "{table} of\n{}", study.text());
        }
    }
}

/// Returns the frames of each object's touches before the signal chain, sorted by the object's name.
fn frames_by_object(study: &GeneratedStudy) -> Vec<(String, Vec<f64>)> {
    let loaded = study.load().unwrap();
    let part = loaded.first();
    let on = (&part.plan.array, 1);
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
        let mut values = ahead.iter().flat_map(|(_, frames)| frames);
        assert!(values.any(|&value| value > 0.0));
        assert!(ahead == back, "{}", study.text());
    }
}

/// Returns the study of three balls with the given names and listed poses, so that no random draw depends on an object's name.
fn of_own_balls(case: &Case, study: &GeneratedStudy, names: [&str; 3]) -> GeneratedStudy {
    let balls = names.iter().zip([40.0, 44.0, 60.0]).map(|(name, diameter)| {
        format!(
            "[[object]]\nname = \"{name}\"\nsource = \"?\"\n[[object.part]]\nshape = \"ball\"\ndiameter_mm = {diameter:?}\n"
        )
    });
    let file = case.file(&format!("{}.toml", names[0]), balls.collect::<String>());
    let mut study = study.clone();
    for table in ["objects", "signal"] {
        study.table.remove(table);
    }
    let listed = |values: &[f64]| values.iter().map(|&v| v.into()).collect::<Vec<Value>>();
    let drawn = "touches.per_object touches.speed_mm_per_s skin.damping_n_s_per_m \
                 skin.stiffness_n_per_m recognition.readings_per_touch";
    let sets = vec![Value::from(file.display().to_string())];
    study
        .without_all(drawn)
        .with("objects.sets", sets)
        .with("signal.steps", Vec::<Value>::new())
        .with("touches.offset_x_mm", listed(&[-4.0, 0.0, 5.0]))
        .with("touches.offset_y_mm", listed(&[-3.0, 0.0, 2.0, 6.0]))
        .with("touches.yaw_deg", listed(&[0.0, 30.0]))
}

#[test]
fn the_names_of_objects_change_nothing_but_names() {
    const NAMES: [&str; 3] = ["first", "second", "third"];
    const OTHERS: [&str; 3] = ["zeta", "alpha", "mu"];
    for number in 0..n_studies() {
        let case = Case::new();
        let mut generator = Generator::new("names of objects", number);
        let study = generator.study(|study| {
            let own = of_own_balls(&case, study, NAMES).load();
            own.is_ok_and(|own| run(&own).is_ok())
        });
        let tables = |names| run(&of_own_balls(&case, &study, names).load().unwrap()).unwrap();
        let (first, others) = (tables(NAMES), tables(OTHERS));
        for table in ["accuracy.csv", "summary.csv", "confusion.csv"] {
            let mut renamed = String::from_utf8(others[table].clone()).unwrap();
            for (name, other) in NAMES.iter().zip(OTHERS) {
                renamed = renamed.replace(other, name);
            }
            let expected = String::from_utf8(first[table].clone()).unwrap();
            assert_eq!(renamed, expected, "{table} of\n{}", study.text());
        }
    }
}
