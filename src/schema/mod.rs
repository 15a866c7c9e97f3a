//! JSON Schemas of study and scene files, used by editors and other programs that check such files.
//!
//! The keys, types, defaults and descriptions come from the specifications, whose doc comments are the descriptions. Ranges come from the descriptions of
//! keys ([`inputs::keys`](crate::inputs)). [`reference`] writes the pages `guide/reference.md` and `guide/tables.md`.

mod axes_schema;
mod study_schema;
mod tidy;

pub use study_schema::study_schema;

use crate::scene::SceneSpec;
use schemars::SchemaGenerator;
use schemars::generate::SchemaSettings;
use serde_json::Value;

/// Address of the JSON Schema version.
const DIALECT: &str = "https://json-schema.org/draft/2020-12/schema";

/// Returns the JSON Schema of scene files.
pub fn scene_schema() -> Value {
    let mut schema = generator().into_root_schema_for::<SceneSpec>().to_value();
    tidy::tidy(&mut schema);
    schema["title"] = "Scene of bubbletouch".into();
    schema
}

/// Returns a schema generator that writes each type in place, without references.
fn generator() -> SchemaGenerator {
    let settings = SchemaSettings::draft2020_12();
    settings
        .with(|settings| settings.inline_subschemas = true)
        .into_generator()
}
