//! JSON Schemas of the tables `[axes]` and `[test]`, which repeat keys of other tables.

use super::study_schema::properties;
use crate::inputs::keys::AxisPlace;
use crate::inputs::toml_value::is_at;
use crate::studies::recognition::plan::tested::{SHARED, TABLES};
use crate::studies::recognition::spec::keys::recognition_keys;
use serde_json::{Map, Value, json};

/// Adds the tables `[test]` and `[axes]` to the schema of a recognition study.
pub(super) fn complete(schema: &mut Value) {
    let test = test_table(schema);
    schema["properties"]["test"] = test;
    let axes = axes_table(schema);
    schema["properties"]["axes"] = axes;
}

/// Returns the schema of `[test]`: all keys of other tables that may differ for test touches. No key is required.
fn test_table(schema: &Value) -> Value {
    let tables = TABLES.iter().map(|&name| {
        let mut table = schema["properties"][name].clone();
        remove_required(&mut table);
        if let Some(keys) = table["properties"].as_object_mut() {
            keys.retain(|key, _| !SHARED.contains(&&format!("{name}.{key}")[..]));
        }
        (name.to_owned(), table)
    });
    json!({
        "type": "object",
        "description": schema["properties"]["test"]["description"],
        "properties": Map::from_iter(tables),
        "additionalProperties": false,
    })
}

/// Removes the lists of required keys and the defaults from the schema of a table.
fn remove_required(table: &mut Value) {
    if let Some(table) = table.as_object_mut() {
        table.remove("required");
        table.remove("default");
    }
    if let Some(keys) = table.get_mut("properties").and_then(Value::as_object_mut) {
        for key in keys.values_mut().filter_map(Value::as_object_mut) {
            key.remove("default");
        }
    }
}

/// Returns the schema of `[axes]`. A key is a path in quotes, or a table with the last parts of paths.
fn axes_table(schema: &Value) -> Value {
    let mut axes = Map::new();
    for (name, of_key) in properties(schema) {
        let mut keys = recognition_keys().iter();
        if keys.any(|key| is_at(key.path, name) && key.axis != AxisPlace::Never) {
            add_paths(name, of_key, &mut axes);
            axes.insert(name.clone(), lists(of_key));
        }
    }
    let mut combine = schema["properties"]["signal"]["properties"]["combine"].clone();
    combine["description"] = "How the axes are combined with each other.".into();
    axes.insert("combine".to_owned(), combine);
    let several = json!({ "type": "array", "minItems": 1, "uniqueItems": true });
    json!({
        "type": "object",
        "description": "Further axes: the path of a key, such as \"touches.depth_mm\", with a list of its values.",
        "properties": axes,
        "patternProperties": { r"^[a-z_.]*\{[a-z_, ]+\}[a-z_.]*$": several },
        "additionalProperties": false,
    })
}

/// Adds the paths of a key and of all keys below it, each with the schema of a list of its values.
fn add_paths(path: &str, schema: &Value, axes: &mut Map<String, Value>) {
    axes.extend(list_of(schema).map(|list| (path.to_owned(), list)));
    for (name, inner) in inner_keys(schema) {
        add_paths(&format!("{path}.{name}"), inner, axes);
    }
}

/// Returns the schema of a list of a key's values, or of a table of such lists.
fn lists(schema: &Value) -> Value {
    let inner = inner_keys(schema).into_iter();
    let inner: Map<String, Value> = inner
        .map(|(name, schema)| (name.clone(), lists(schema)))
        .collect();
    let table = json!({ "type": "object", "properties": inner, "additionalProperties": false });
    match list_of(schema) {
        None => table,
        Some(list) if inner.is_empty() => list,
        Some(list) => json!({ "anyOf": [list, table] }),
    }
}

/// Returns the keys of a table, or of a value that may be a table.
fn inner_keys(schema: &Value) -> Vec<(&String, &Value)> {
    let choices = ["anyOf", "oneOf"].map(|choice| schema[choice].as_array());
    let choices = choices.into_iter().flatten().flatten();
    properties(schema)
        .chain(choices.flat_map(inner_keys))
        .collect()
}

/// Returns the schema of a list of a key's values; `None` for a table.
fn list_of(schema: &Value) -> Option<Value> {
    if schema.get("properties").is_some() {
        return None;
    }
    let mut value = schema.clone();
    let keywords = value.as_object_mut()?;
    keywords.remove("default");
    let description = keywords.remove("description");
    // A key that accepts a value or a list: an axis lists values.
    if let Some([one, list]) = schema["anyOf"].as_array().map(Vec::as_slice)
        && list["items"] == *one
        && list["uniqueItems"] == true
    {
        value = one.clone();
    }
    let mut list = json!({ "type": "array", "items": value, "minItems": 1, "uniqueItems": true });
    if let Some(description) = description {
        list["description"] = description;
    }
    Some(list)
}
