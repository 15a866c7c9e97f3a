//! Law of keys: each key of a study changes a number or a column of a table, or is refused. Keys that change no number by their meaning are listed.
//!
//! The values are made from the declarations, which the JSON Schema contains. A value that equals the default, and a key that needs another key beside it, count
//! for nothing. `.ci/long engine` runs this law, which takes some minutes.

use crate::command::Case;
use crate::hostile::replaced;
use crate::kinds::Kind;
use serde_json::Value as Json;
use std::fs;
use toml::{Table, Value};

/// Keys that change memory, charts or pages, but no table.
const OF_NO_TABLE: [&str; 4] = [
    "question",
    "recognition.solver_memory_gib",
    "report.pareto",
    "report.samples",
];

/// Keys that act only on other data than that of the small studies: unequal classes, open meshes, sparse codes of many atoms, times of a scan, cylinders with
/// ends, and objects within reach in the first scene.
const OF_OTHER_DATA: [&str; 7] = [
    "recognition.class_weight",
    "objects.close_holes_mm",
    "reconstruction.most_atoms",
    "touches.speed_mm_per_s",
    "whole_body.flat_ends",
    "whole_body.scenes.0.object.motion.oscillation.period_s",
    "whole_body.scenes.0.object.surface_error_mm",
];

/// Keys that describe the skin and the time of a recording, also if no step of the signal chain depends on them.
const OF_RECORDING: [&str; 5] = [
    "recorded.frame_interval_s",
    "recorded.previous_touch",
    "recorded.speed_mm_per_s",
    "skin.stiffness_n_per_m",
    "skin.taxel_radius_mm",
];

/// Values that equal the absent key.
const AS_ABSENT: [(&str, &str); 6] = [
    ("skin.layout", "\"grid\""),
    ("skin.sensed", "\"deflection\""),
    ("skin.sensed", "\"force\""),
    ("signal.adc_bits", "0"),
    ("signal.test_sensor", "\"same_skin\""),
    ("sensing.selection", "\"greedy\""),
];

/// Largest number of values that are tried for a key.
const MOST: usize = 6;

/// Key of a study: its path, and values other than its default.
struct Key {
    path: Vec<String>,
    values: Vec<Value>,
}

/// Returns a schema, or the schema that its `$ref` names.
fn resolved<'s>(whole: &'s Json, schema: &'s Json) -> &'s Json {
    match schema["$ref"].as_str() {
        Some(place) => resolved(whole, whole.pointer(place.trim_start_matches('#')).unwrap()),
        None => schema,
    }
}

/// Adds values that a schema allows, other than the default.
fn add_values(whole: &Json, schema: &Json, default: &Json, found: &mut Vec<Value>) {
    let schema = resolved(whole, schema);
    for choices in ["anyOf", "oneOf"] {
        for choice in schema[choices].as_array().into_iter().flatten() {
            add_values(whole, choice, default, found);
        }
    }
    let words = schema["enum"].as_array().into_iter().flatten();
    let words = words.chain(schema.get("const")).filter_map(Json::as_str);
    found.extend(words.map(Value::from));
    let low = schema["minimum"]
        .as_f64()
        .or(schema["exclusiveMinimum"].as_f64());
    let high = schema["maximum"]
        .as_f64()
        .or(schema["exclusiveMaximum"].as_f64());
    let of_default = default
        .as_f64()
        .into_iter()
        .flat_map(|x| [1.5 * x, x + 1.0, 0.5 * x]);
    let of_range = low.zip(high).map(|(low, high)| low + 0.4 * (high - low));
    let of_low = low.into_iter().flat_map(|low| [low + 1.0, low + 2.5]);
    // Small numbers first: the study with the first number that acts is the only one that runs.
    let numbers = of_default
        .chain(of_low)
        .chain([0.5, 2.0, 3.0])
        .chain(of_range);
    let is_inside = |x: &f64| low.is_none_or(|low| *x > low) && high.is_none_or(|high| *x < high);
    match schema["type"].as_str() {
        Some("number") => found.extend(numbers.filter(is_inside).map(Value::from)),
        Some("integer") => {
            let numbers = numbers.map(f64::trunc).filter(is_inside);
            found.extend(numbers.map(|x| Value::from(x as i64)));
        }
        Some("boolean") => found.extend([true, false].map(Value::from)),
        _ => {}
    }
}

/// Adds the keys of a table and of its tables. An array of tables counts as its first table, `0`.
fn add_keys(whole: &Json, schema: &Json, path: &[String], keys: &mut Vec<Key>) {
    for (name, key) in schema["properties"].as_object().into_iter().flatten() {
        let key = resolved(whole, key);
        let path = [path, std::slice::from_ref(name)].concat();
        let items = resolved(whole, &key["items"]);
        if key["properties"].is_object() {
            add_keys(whole, key, &path, keys);
        } else if items["properties"].is_object() {
            add_keys(whole, items, &[path, vec!["0".to_owned()]].concat(), keys);
        } else {
            let mut values = Vec::new();
            add_values(whole, key, &key["default"], &mut values);
            let default = toml_of(&key["default"]);
            values.retain(|value| Some(value) != default.as_ref());
            values.dedup();
            keys.push(Key { path, values });
        }
    }
}

fn toml_of(json: &Json) -> Option<Value> {
    Value::try_from(json).ok()
}

/// Returns the study with another value of a key; `None` if the study has no table for it or has the value.
fn with(study: &Table, path: &[String], value: &Value) -> Option<String> {
    let changed = replaced(study, path, value)?;
    (changed != toml::to_string(study).unwrap()).then_some(changed)
}

/// Returns the study of the frames that the command `touches` writes for the study of recognition, and the folder of its files.
fn recorded() -> (Case, Table) {
    let kind = Kind::named("recognition");
    let case = kind.case();
    let study = kind.study.replace("[4.0, 8.0]", "8.0");
    case.file("pressed.toml", &study);
    case.succeeds("touches pressed.toml --out touches");
    let mut study: Table = study.parse().unwrap();
    for table in ["objects", "skin", "touches"] {
        study.remove(table);
    }
    let recorded = fs::read_to_string(case.path("touches/recorded.toml")).unwrap();
    let inside = |text: String, name| text.replace(name, &format!("touches/{name}"));
    let files = ["frames.npy", "labels.npy", "depths.npy"];
    let recorded = files.into_iter().fold(recorded, inside);
    study.extend(recorded.parse::<Table>().unwrap());
    (case, study)
}

/// Returns the keys of a study that are accepted, but change no table.
fn silent_keys((case, mut study): (Case, Table)) -> Vec<String> {
    let (schema, _) = case.succeeds("schema study");
    let whole: Json = serde_json::from_str(&schema).unwrap();
    if study.contains_key("trials") {
        study.insert("trials".to_owned(), 1.into());
    }
    let tables = |text: &str| {
        case.file("study.toml", text);
        let _ = fs::remove_dir_all(case.path("out"));
        let output = case.run("run study.toml --out out");
        let code = output.status.code();
        assert!(matches!(code, Some(0..=2)), "{text}\n{output:?}");
        if code == Some(1) {
            // Work items that fail are no silent result.
            return Some(Json::Null);
        }
        let manifest = (code == Some(0)).then(|| case.bytes("out/manifest.json"));
        manifest
            .map(|bytes| serde_json::from_slice::<Json>(&bytes).unwrap()["tables_sha256"].clone())
    };
    let base = tables(&toml::to_string(&study).unwrap());
    assert!(base.is_some(), "{study}");
    let mut keys = Vec::new();
    add_keys(&whole, &whole, &[], &mut keys);
    let is_of_kind = |key: &&Key| {
        let table = &key.path[0];
        let is_own = ["axes", "expected", "test"].contains(&&table[..]);
        // A table of another kind of study is refused.
        !is_own && (key.path.len() == 1 || study.contains_key(table) || table == "report")
    };
    let mut silent = Vec::new();
    for key in keys.iter().filter(is_of_kind) {
        let name = key.path.join(".");
        if OF_NO_TABLE.contains(&&name[..]) || OF_OTHER_DATA.contains(&&name[..]) {
            continue;
        }
        let is_other = |value: &&Value| !AS_ABSENT.contains(&(&name[..], &value.to_string()[..]));
        let values = key.values.iter().filter(is_other).take(MOST);
        let mut accepted = values.filter_map(|value| {
            let found = tables(&with(&study, &key.path, value)?)?;
            Some((value, Some(found)))
        });
        // One value that acts is enough.
        let Some((value, found)) = accepted.next() else {
            continue;
        };
        if found == base && accepted.all(|(_, found)| found == base) {
            silent.push(format!("{name} = {value}"));
        }
    }
    silent
}

#[test]
#[ignore = "some minutes"]
fn every_key_acts_or_is_refused() {
    let all =
        "stability reconstruction object_detail recognition human errors test_touches whole_body";
    for name in all.split(' ') {
        let kind = Kind::named(name);
        let silent = silent_keys((kind.case(), kind.study.parse().unwrap()));
        println!("{name} has {} silent keys", silent.len());
        assert!(silent.is_empty(), "{name}\n{silent:#?}");
    }
}

#[test]
#[ignore = "some minutes"]
fn every_key_of_recorded_frames_acts_or_is_refused_but_those_that_describe_the_recording() {
    let mut silent = silent_keys(recorded());
    silent.retain(|key| !OF_RECORDING.iter().any(|own| key.starts_with(own)));
    assert!(silent.is_empty(), "{silent:#?}");
}
