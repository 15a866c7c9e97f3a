//! JSON Schemas of study and scene files, used by editors and other programs that check such files.
//!
//! The keys, types, defaults and descriptions come from the specifications, whose doc comments are the descriptions. Ranges come from the descriptions of
//! keys ([`inputs::keys`](crate::inputs)). The pages `guide/reference.md` and `guide/tables.md` are written from the same lists.

mod axes_schema;
mod ranges;
mod reference;
mod scene_ranges;
mod study_schema;
mod tables;
#[cfg(test)]
mod tests;
mod tidy;

pub use reference::reference_page;
pub use study_schema::study_schema;
pub use tables::tables_page;

use crate::scene::SceneSpec;
use crate::schema::scene_ranges::RANGES;
use schemars::SchemaGenerator;
use schemars::generate::SchemaSettings;
use serde_json::Value;

/// Address of the JSON Schema version that the schemas use.
const DIALECT: &str = "https://json-schema.org/draft/2020-12/schema";

/// Returns the JSON Schema of scene files.
pub fn scene_schema() -> Value {
    let mut schema = generator().into_root_schema_for::<SceneSpec>().to_value();
    tidy::tidy(&mut schema);
    for (path, is_allowed) in RANGES {
        ranges::bound(&mut schema, path, is_allowed);
    }
    schema["title"] = "Scene of bubbletouch".into();
    schema
}

/// Returns a schema generator that writes all types inline, without references.
fn generator() -> SchemaGenerator {
    let settings = SchemaSettings::draft2020_12();
    settings
        .with(|settings| settings.inline_subschemas = true)
        .into_generator()
}
