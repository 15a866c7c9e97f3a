//! JSON Schemas of study and scene files, used by editors and other programs that check such files.
//!
//! The schemas come from the declarations of the keys ([`inputs::params`](crate::inputs)). The pages `guide/reference.md` and `guide/tables.md` are written from the same lists.

mod axes_schema;
mod reference;
mod study_schema;
mod tables;
#[cfg(test)]
mod tests;

pub use reference::reference_page;
pub use study_schema::study_schema;
pub use tables::tables_page;

use crate::inputs::params::Described;
use crate::scene::SceneSpec;
use serde_json::Value;

/// Address of the JSON Schema version that the schemas use.
const DIALECT: &str = "https://json-schema.org/draft/2020-12/schema";

/// Returns the JSON Schema of scene files.
pub fn scene_schema() -> Value {
    let mut schema = SceneSpec::schema();
    schema["$schema"] = DIALECT.into();
    schema["title"] = "Scene of bubbletouch".into();
    schema
}

/// Returns the keys of a table with their schemas.
fn properties(schema: &Value) -> impl Iterator<Item = (&String, &Value)> {
    let keys = schema.get("properties").and_then(Value::as_object);
    keys.into_iter().flatten()
}
