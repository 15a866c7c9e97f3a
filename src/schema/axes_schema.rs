//! Schemas of the tables `[axes]` and `[test]`, which repeat keys of other tables.

use super::properties;
use crate::inputs::keys::{AxisPlace, find};
use crate::inputs::toml_value::is_at;
use crate::studies::recognition::plan::tested::TABLES;
use crate::studies::recognition::spec::keys::recognition_keys;
use serde_json::{Map, Value, json};

/// Adds the tables `[test]` and `[axes]` to the schema of a recognition study.
pub(super) fn complete(schema: &mut Value) {
    let test = test_table(schema);
    schema["properties"]["test"] = test;
    let axes = axes_table(schema);
    schema["properties"]["axes"] = axes;
}

/// Returns the schema of the table `[test]`: the keys of other tables that may differ for test touches, all optional.
fn test_table(schema: &Value) -> Value {
    let tables = TABLES.iter().map(|&name| {
        let path = format!("#/properties/{name}");
        let table = &schema["properties"][name];
        let keys = properties(table).filter(|(key, _)| {
            let about = find(recognition_keys(), &format!("{name}.{key}"));
            about.is_none_or(|about| about.of_all_touches != Some(true))
        });
        let keys =
            keys.map(|(key, _)| (key.clone(), reference(&format!("{path}/properties/{key}"))));
        let keys: Map<String, Value> = keys.collect();
        let description = format!("Keys of `[{name}]` whose values differ for test touches.");
        let table = json!({
            "type": "object",
            "description": description,
            "properties": keys,
            "additionalProperties": false,
        });
        (name.to_owned(), table)
    });
    json!({
        "type": "object",
        "description": schema["properties"]["test"]["description"],
        "properties": Map::from_iter(tables),
        "additionalProperties": false,
    })
}

/// Returns a reference to a part of the schema, given by its JSON pointer.
fn reference(pointer: &str) -> Value {
    json!({ "$ref": pointer })
}

/// Returns the schema of the table `[axes]`. A key is a path in quotes, or a table with the last parts of paths.
fn axes_table(schema: &Value) -> Value {
    let mut axes = Map::new();
    for (name, of_key) in properties(schema) {
        let mut keys = recognition_keys().iter();
        if keys.any(|key| is_at(key.path, name) && key.axis != AxisPlace::Never) {
            let key = Key::new(format!("#/properties/{name}"), of_key, schema);
            let lists = key.add_lists(name, &mut axes);
            axes.insert(name.clone(), lists);
        }
    }
    let several = json!({ "type": "array", "minItems": 1, "uniqueItems": true });
    let mut patterns = Map::new();
    patterns.insert(
        r"^[a-z_.]*\{[a-z_, ]+\}[a-z_.]*$".to_owned(),
        several.clone(),
    );
    // A key whose table has names of the user's own, such as parameters of own classifiers.
    let has_own_names = |list: &Value| {
        let key = list["items"]["$ref"].as_str();
        let key = key.and_then(|pointer| schema.pointer(&pointer[1..]));
        key.is_some_and(|key| key["additionalProperties"].is_object())
    };
    for (path, _) in axes.iter().filter(|(_, list)| has_own_names(list)) {
        let pattern = format!(r"^{}\.", path.replace('.', r"\."));
        patterns.insert(pattern, several.clone());
    }
    let mut combine = schema["properties"]["signal"]["properties"]["combine"].clone();
    combine["description"] = "How the axes are combined with each other.".into();
    axes.insert("combine".to_owned(), combine);
    json!({
        "type": "object",
        "description": "Further axes: the path of a key, such as \"touches.depth_mm\", with a list of its values.",
        "properties": axes,
        "patternProperties": patterns,
        "additionalProperties": false,
    })
}

/// Key with its position in the schema of a study, and the schema of the key.
struct Key<'s> {
    pointer: String,
    schema: &'s Value,
    root: &'s Value,
}

impl<'s> Key<'s> {
    /// Creates a key. If its schema is a reference, the key is the one that is referred to.
    fn new(pointer: String, schema: &'s Value, root: &'s Value) -> Self {
        let other = schema["$ref"].as_str();
        let target = other.and_then(|other| Some((other, root.pointer(&other[1..])?)));
        match target {
            Some((pointer, schema)) => Self::new(pointer.to_owned(), schema, root),
            None => Self {
                pointer,
                schema,
                root,
            },
        }
    }

    /// Adds the paths of a key and of all its subkeys; the schema of each path is a list of its values. Returns the schema of such a list, or of a table with
    /// such lists.
    fn add_lists(&self, path: &str, axes: &mut Map<String, Value>) -> Value {
        let list = self.list();
        axes.extend(list.clone().map(|list| (path.to_owned(), list)));
        let inner = self.inner().into_iter().map(|(name, key)| {
            let lists = key.add_lists(&format!("{path}.{name}"), axes);
            (name, lists)
        });
        let inner: Map<String, Value> = inner.collect();
        let is_value = inner.is_empty();
        let table = json!({ "type": "object", "properties": inner, "additionalProperties": false });
        match list {
            None => table,
            Some(list) if is_value => list,
            Some(list) => json!({ "anyOf": [list, table] }),
        }
    }

    /// Returns the subkeys of a key whose value is, or may be, a table.
    fn inner(&self) -> Vec<(String, Self)> {
        let inner =
            |name: String, schema| Self::new(format!("{}/{name}", self.pointer), schema, self.root);
        let keys = properties(self.schema);
        let mut found: Vec<(String, Self)> = keys
            .map(|(name, schema)| (name.clone(), inner(format!("properties/{name}"), schema)))
            .collect();
        for choice in ["anyOf", "oneOf"] {
            let choices = self.schema[choice].as_array().into_iter().flatten();
            for (place, schema) in choices.enumerate() {
                found.extend(inner(format!("{choice}/{place}"), schema).inner());
            }
        }
        found
    }

    /// Returns the schema of a list of values of the key; `None` for a table.
    fn list(&self) -> Option<Value> {
        if self.schema.get("properties").is_some() {
            return None;
        }
        // A key that accepts a value or a list: an axis lists values.
        let value = match is_axis(self.schema) {
            true => format!("{}/anyOf/0", self.pointer),
            false => self.pointer.clone(),
        };
        Some(json!({
            "type": "array",
            "description": self.schema["description"].as_str().unwrap_or_default(),
            "items": reference(&value),
            "minItems": 1,
            "uniqueItems": true,
        }))
    }
}

/// Returns whether a key accepts a list of values to sweep.
pub(super) fn is_axis(schema: &Value) -> bool {
    let choices = schema["anyOf"].as_array().map(Vec::as_slice);
    matches!(choices, Some([one, list]) if list["items"] == *one && list["uniqueItems"] == true)
}
