//! `--json` and `--quiet`: the events of a run have the form that the guide describes.

use crate::command::Case;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

const GUIDE: &str = include_str!("../../guide/events.md");

const STUDY: &str = include_str!("../fixtures/texts/events.toml");

/// Returns the types of each event's fields, from the table of the guide.
fn schema() -> BTreeMap<String, BTreeMap<String, String>> {
    let mut schema: BTreeMap<String, BTreeMap<String, String>> = BTreeMap::new();
    for line in GUIDE.lines().filter(|line| line.starts_with("| `")) {
        let cells = line.split('|').map(|cell| cell.trim().trim_matches('`'));
        let cells: Vec<&str> = cells.collect();
        let fields = schema.entry(cells[1].to_owned()).or_default();
        fields.insert(cells[2].to_owned(), cells[3].to_owned());
    }
    assert_eq!(schema.len(), 4, "{schema:?}");
    schema
}

fn events(text: &str) -> Vec<Value> {
    text.lines()
        .map(|line| serde_json::from_str(line).expect(line))
        .collect()
}

/// Asserts that the guide lists every field of an event with its type.
fn check(event: &Value, schema: &BTreeMap<String, BTreeMap<String, String>>) {
    let fields = &schema[event["event"].as_str().unwrap()];
    for (name, value) in event.as_object().unwrap() {
        let is_right = match fields.get(name).map(String::as_str) {
            None => name == "event",
            Some("string") => value.is_string(),
            Some("integer") => value.is_u64(),
            Some("number") => value.as_f64().is_some_and(|number| number >= 0.0),
            Some(_) => false,
        };
        assert!(is_right, "{name} of {event}");
    }
}

#[test]
fn every_line_of_a_run_is_an_event_as_the_guide_has_it() {
    let case = Case::new();
    case.file("study.toml", STUDY);
    let (said, error) = case.succeeds("run study.toml --json");
    assert_eq!(error, "", "nothing for people");
    let (schema, events) = (schema(), events(&said));
    events.iter().for_each(|event| check(event, &schema));
    let of_kind = |kind: &'static str| events.iter().filter(move |event| event["event"] == *kind);
    // Touches and recognition on two arrays, and the report.
    assert_eq!(of_kind("stage").count(), 5);
    let finished = events.last().unwrap();
    let told = finished.as_object().unwrap().keys().map(String::as_str);
    let told: BTreeSet<&str> = told.collect();
    let fields = schema["finished"].keys().map(String::as_str);
    assert_eq!(told, fields.chain(["event"]).collect(), "{finished}");
    assert_eq!(finished["work_items"], 26);
    assert_eq!(finished["failed"], 0);
    let progress: Vec<&Value> = of_kind("progress").collect();
    let last = progress.last().unwrap();
    assert_eq!(last["run_left_s"], 0.0, "the report is written: {last}");
    let elapsed = |event: &&Value| event["run_elapsed_s"].as_f64().unwrap();
    assert!(progress.is_sorted_by_key(elapsed));
    // In a second run all work items are finished, and the command prints a message about this.
    let again = self::events(&case.succeeds("run study.toml --json").0);
    again.iter().for_each(|event| check(event, &schema));
    assert_eq!(again[0]["event"], "message");
    assert_eq!(again.last().unwrap()["finished_before"], 26);
}
