//! Tests that schemas and generated pages agree with the code that reads files.

use super::study_schema::kinds;
use super::tidy::properties;
use super::*;
use crate::inputs::schema_types::accepted_keys;
use std::collections::BTreeSet;
use std::path::Path;

/// Reader of a file kind: function that returns the keys accepted in the table that contains the probe key `?`.
type Accepts = fn(toml::Value) -> Vec<String>;

/// Returns the schema and the reader of each kind of file.
fn files() -> Vec<(Value, Accepts)> {
    let studies = kinds()
        .into_iter()
        .map(|kind| (kind.schema, kind.accepted_keys));
    let scene: (Value, Accepts) = (scene_schema(), accepted_keys::<SceneSpec>);
    studies.chain([scene]).collect()
}

/// Calls `visit` for each table of a schema, together with an example file that contains the single key `?` in this table.
fn each_table(
    schema: &Value,
    probe: &dyn Fn(toml::Value) -> toml::Value,
    visit: &mut dyn FnMut(&Value, toml::Value),
) {
    let table = |name: &str, value: toml::Value| -> toml::Value {
        toml::Value::Table([(name.to_owned(), value)].into_iter().collect())
    };
    if schema.get("properties").is_some() {
        visit(schema, probe(table("?", 0.into())));
    }
    for (name, key) in properties(schema) {
        // These tables repeat keys of others, and their readers are not serde's.
        if !["axes", "test", "signal"].contains(&&name[..])
            || key["type"] == "object" && name == "signal"
        {
            each_table(key, &|inner| probe(table(name, inner)), visit);
        }
    }
    if schema["type"] == "array" {
        each_table(&schema["items"], &|inner| probe(vec![inner].into()), visit);
    }
    for variant in schema["oneOf"].as_array().into_iter().flatten() {
        for (name, key) in properties(variant) {
            each_table(key, &|inner| probe(table(name, inner)), visit);
        }
    }
}

#[test]
fn a_schema_has_the_keys_that_the_reader_accepts_and_no_other() {
    let mut n_tables = 0;
    for (schema, accepted_keys) in files() {
        each_table(&schema, &|probe| probe, &mut |table, probe| {
            let own: BTreeSet<&str> = properties(table).map(|(name, _)| &name[..]).collect();
            let accepted = accepted_keys(probe.clone());
            let mut accepted: BTreeSet<&str> = accepted.iter().map(String::as_str).collect();
            // The reader of a study takes `[axes]` out before the other tables are read.
            accepted.extend(own.get("axes"));
            if table["additionalProperties"] == false {
                assert_eq!(own, accepted, "{probe}");
            }
            n_tables += 1;
        });
    }
    assert!(n_tables > 40, "{n_tables}");
}

#[test]
fn every_key_and_column_has_a_meaning_and_a_row() {
    let page = reference_page();
    let has_row = |name: &str| page.contains(&format!("| `{name}` |"));
    for (schema, _) in files() {
        each_table(&schema, &|probe| probe, &mut |table, probe| {
            for (name, key) in properties(table) {
                assert!(
                    key["description"]
                        .as_str()
                        .is_some_and(|words| !words.is_empty()),
                    "{name} in {probe}"
                );
                assert!(
                    has_row(name)
                        || key["deprecated"] == true
                        || ["test", "axes"].contains(&&name[..]),
                    "{name}"
                );
            }
        });
    }
    let tables = tables_page();
    let rows = tables.lines().filter(|line| line.starts_with("| `"));
    let without: Vec<&str> = rows.filter(|row| row.ends_with("|  |")).collect();
    assert!(without.is_empty(), "{without:?}");
}

/// Tests that the pages of the guide are up to date; with `BUBBLETOUCH_UPDATE=1`, the test writes them.
#[test]
fn the_pages_of_the_guide_are_those_of_the_program() {
    for (file, page) in [
        ("reference.md", reference_page()),
        ("tables.md", tables_page()),
    ] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("guide")
            .join(file);
        if std::env::var_os("BUBBLETOUCH_UPDATE").is_some() {
            std::fs::write(&path, &page).unwrap();
        }
        let written = std::fs::read_to_string(&path).unwrap_or_default();
        let differs = written
            .lines()
            .zip(page.lines())
            .find(|(written, page)| written != page);
        assert!(
            written == page,
            "{} is stale: BUBBLETOUCH_UPDATE=1 cargo test --lib schema; first difference {differs:?}",
            path.display()
        );
    }
}

/// Returns the number at the start of a text; `None` if there is none. A full stop at the end does not belong to it.
fn leading_number(text: &str) -> Option<f64> {
    let is_digit = |c: char| c.is_ascii_digit() || ".-e".contains(c);
    let end = text.find(|c| !is_digit(c)).unwrap_or(text.len());
    text[..end].trim_end_matches('.').parse().ok()
}

#[test]
fn a_default_in_words_is_the_default_of_the_reader_and_no_choice_of_words_lacks_one() {
    let (mut n_numbers, mut n_words) = (0, 0);
    for (schema, _) in files() {
        each_table(&schema, &|probe| probe, &mut |table, _| {
            let required = table["required"].as_array().into_iter().flatten();
            let required: Vec<&str> = required.filter_map(Value::as_str).collect();
            for (name, key) in properties(table) {
                let meaning = key["description"].as_str().unwrap_or_default();
                let said = meaning.split_once("Default: ").map(|(_, said)| said);
                let number = said.and_then(leading_number);
                if let (Some(number), Some(default)) = (number, key["default"].as_f64()) {
                    assert_eq!(number, default, "{name}: {meaning}");
                    n_numbers += 1;
                }
                let is_other =
                    meaning.starts_with("Another name of") || meaning.contains("instead of");
                let is_choice = key["enum"].is_array() && !is_other;
                if is_choice && key["default"].is_null() && !required.contains(&&name[..]) {
                    let states = meaning.to_lowercase().contains("default");
                    assert!(states, "{name}: {meaning}");
                    n_words += 1;
                }
            }
        });
    }
    assert!(n_numbers > 20 && n_words > 3, "{n_numbers} {n_words}");
}
