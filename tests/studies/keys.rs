//! Every key of every kind of study has exactly one description, and every description belongs to a key.

use bubbletouch::inputs::keys::{AxisPlace, find};
use bubbletouch::kinds::{keys, kinds};
use bubbletouch::schema::study_schema;
use bubbletouch::table::Role;
use serde_json::Value;
use std::collections::BTreeSet;

/// Collects the keys of a table and its subtables. A key with a description is not searched for further keys.
fn collect(table: &Value, path: &str, described: &BTreeSet<&str>, found: &mut BTreeSet<String>) {
    for (name, inner) in table["properties"].as_object().into_iter().flatten() {
        let path = match path {
            "" => name.clone(),
            path => format!("{path}.{name}"),
        };
        let n_before = found.len();
        match described.contains(&path[..]) {
            true => drop(found.insert(path.clone())),
            // A table, a list of tables, or a table that may be absent.
            false => {
                let choices = inner["anyOf"].as_array().into_iter().flatten();
                for table in choices.chain([inner, &inner["items"]]) {
                    collect(table, &path, described, found);
                }
            }
        }
        assert!(found.len() > n_before, "{path} has no description");
    }
}

#[test]
fn every_key_of_every_kind_has_one_description() {
    let all: Vec<_> = kinds().map(|kind| (kind, keys(kind).unwrap())).collect();
    assert_eq!(all.len(), 5);
    assert!(keys("other").is_none());
    for (kind, keys) in &all {
        let paths: BTreeSet<&str> = keys.iter().map(|key| key.path).collect();
        assert_eq!(paths.len(), keys.len(), "{kind}: a key twice");
    }
    let described = all
        .iter()
        .flat_map(|(_, keys)| keys.iter().map(|key| key.path));
    let described: BTreeSet<&str> = described.collect();
    let mut schema = study_schema();
    schema["properties"].as_object_mut().unwrap().remove("axes");
    let mut found = BTreeSet::new();
    collect(&schema, "", &described, &mut found);
    let found: BTreeSet<&str> = found.iter().map(String::as_str).collect();
    assert_eq!(described, found);
}

#[test]
fn the_split_and_recorded_data_are_conditions_and_texts_are_no_axes() {
    let known = keys("recognition").unwrap();
    let about = |path: &str| find(&known, path).unwrap();
    for path in [
        "recognition.split",
        "recognition.group_by",
        "recognition.group_by_mm",
        "recognition.group_by_deg",
        "recognition.test_fraction",
        "recognition.folds",
        "recorded.groups",
        "touches.rest",
        "signal.dead_fraction",
    ] {
        assert_eq!(about(path).role, Role::Condition, "{path}");
    }
    for path in ["question", "trials", "report.pareto"] {
        assert_eq!(about(path).axis, AxisPlace::Never, "{path}");
    }
    assert_eq!(about("skin.pitch_mm").axis, AxisPlace::Table);
    assert_eq!(about("skin.stroke_mm").axis, AxisPlace::Axes);
    // Kinds without [axes] sweep only lists in their own tables.
    let other = keys("reconstruction").unwrap();
    let axis = |path: &str| find(&other, path).unwrap().axis;
    assert_eq!(axis("skin.stroke_mm"), AxisPlace::Never);
    assert_eq!(axis("sensing.ratio"), AxisPlace::Table);
}
