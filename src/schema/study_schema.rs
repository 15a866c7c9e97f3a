//! JSON Schema of study files of all kinds.
//!
//! All kinds use tables such as `[skin]`, so the schema lists each table once. Conditions then state which tables a file of each kind may have and must
//! have. The kind follows from the table that only this kind has.

use super::{DIALECT, axes_schema, properties};
use crate::inputs::keys::KeyAbout;
use crate::studies;
use serde_json::{Map, Value, json};

/// Kind of study with the schema of its files.
pub(super) struct KindSchema {
    /// Name of the table that only study files of this kind contain.
    pub table: &'static str,
    /// Description of the kind of study, in words.
    pub words: &'static str,
    /// Schema of a file of this kind, without conditions.
    pub schema: Value,
    /// Descriptions of all keys.
    pub keys: Vec<KeyAbout>,
}

/// Returns the schema of each kind of study, recognition first.
pub(super) fn kinds() -> Vec<KindSchema> {
    let kinds = studies::entries().rev();
    let kinds = kinds.map(|kind| {
        let mut schema = (kind.schema)();
        if kind.about.table == studies::RECOGNITION_TABLE {
            axes_schema::complete(&mut schema);
        }
        KindSchema {
            table: kind.about.table,
            words: kind.about.words,
            schema,
            keys: (kind.keys)(),
        }
    });
    kinds.collect()
}

/// Returns the JSON Schema of study files.
pub fn study_schema() -> Value {
    let kinds = kinds();
    let mut tables = Map::new();
    for kind in &kinds {
        for (name, table) in properties(&kind.schema) {
            tables.entry(name).or_insert_with(|| table.clone());
        }
    }
    // A key in `[axes]` may be absent from its table.
    let mut without_axes = Map::new();
    for (name, table) in &mut tables {
        let required = table.as_object_mut();
        if let Some(required) = required.and_then(|table| table.remove("required")) {
            without_axes.insert(name.clone(), json!({ "required": required }));
        }
    }
    json!({
        "$schema": DIALECT,
        "title": "Study of bubbletouch",
        "type": "object",
        "properties": tables,
        "additionalProperties": false,
        "allOf": [
            rules_of_kinds(&kinds),
            { "if": { "required": ["axes"] }, "else": { "properties": without_axes } },
        ],
    })
}

/// Returns the conditions by which a schema selects the rules for the kind of a file. A file without a table of another kind is a recognition study.
fn rules_of_kinds(kinds: &[KindSchema]) -> Value {
    let Some((recognition, others)) = kinds.split_first() else {
        return json!({});
    };
    others.iter().fold(recognition.rules(), |otherwise, kind| {
        json!({ "if": { "required": [kind.table] }, "then": kind.rules(), "else": otherwise })
    })
}

impl KindSchema {
    /// Returns the condition that specifies the allowed and the required tables of a file of this kind.
    fn rules(&self) -> Value {
        let names: Vec<&String> = properties(&self.schema).map(|(name, _)| name).collect();
        json!({ "propertyNames": { "enum": names }, "required": self.schema["required"] })
    }
}
