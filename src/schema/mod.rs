//! JSON Schemas of study and scene files, used by editors and other programs that check such files.
//!
//! The schemas come from the declarations of the keys ([`inputs::params`](crate::inputs)). The pages `guide/reference.md` and `guide/tables.md` are written from the same lists.

mod axes_schema;
mod reference;
mod study_schema;
mod tables;

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

#[cfg(test)]
mod tests {
    use super::study_schema::kinds;
    use super::*;
    use crate::scene::ScenePlan;
    use std::path::Path;

    /// Returns the schema of each kind of file.
    fn files() -> Vec<Value> {
        let studies = kinds().into_iter().map(|kind| kind.schema);
        studies.chain([scene_schema()]).collect()
    }

    /// Calls `visit` for each table of a schema.
    fn each_table(schema: &Value, visit: &mut dyn FnMut(&Value)) {
        if schema.get("properties").is_some() {
            visit(schema);
        }
        for (name, key) in properties(schema) {
            // These tables repeat keys of others.
            if !["axes", "test"].contains(&&name[..]) {
                each_table(key, visit);
            }
        }
        if schema["type"] == "array" {
            each_table(&schema["items"], visit);
        }
        for variant in schema["oneOf"].as_array().into_iter().flatten() {
            for (_, key) in properties(variant) {
                each_table(key, visit);
            }
        }
    }

    #[test]
    fn every_key_and_column_has_a_meaning_and_a_row() {
        let page = reference_page();
        let has_row = |name: &str| page.contains(&format!("| `{name}` |"));
        for schema in files() {
            each_table(&schema, &mut |table| {
                for (name, key) in properties(table) {
                    assert!(
                        key["description"]
                            .as_str()
                            .is_some_and(|words| !words.is_empty()),
                        "{name} in {table}"
                    );
                    assert!(
                        has_row(name) || ["test", "axes"].contains(&&name[..]),
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
        for schema in files() {
            each_table(&schema, &mut |table| {
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

    /// Scenes whose numbers are all allowed. Together they have every number with a range but those of layouts draped over a mesh.
    const SCENES: [&str; 3] = [
        r#"title = "a"
    dt_ms = 1.0
    output_hz = 10.0
    duration_s = 0.1
    robots = [{ name = "r", floating = true, motion = { phases = [{ duration_s = 0.1 }] } }]
    [[patches]]
    name = "p"
    robot = "r"
    layout = { grid = { nx = 4, ny = 4, pitch_mm = 2.0 } }
    taxel_radius_mm = 1.0
    stroke_mm = 2.0
    stiffness_n_per_m = 100.0
    damping_n_s_per_m = 0.0
    friction = 0.5
    shear_stiffness_n_per_m = 50.0
    [[objects]]
    name = "o"
    object = "golf"
    surface_error_mm = 0.5
    at.position_mm = [0.0, 0.0, 40.0]
    motion = { phases = [{ duration_s = 0.1 }] }
    press = { patch = "p", direction = [0.0, 0.0, -1.0], force_n = 1.0, speed_mm_per_s = 1.0, travel_mm = 1.0 }
    "#,
        r#"title = "b"
    duration_s = 0.1
    [[patches]]
    name = "a"
    stroke_mm = 1.0
    layout = { hexagonal = { nx = 3, ny = 3, pitch_mm = 2.0 } }
    [[objects]]
    name = "o"
    object = "golf"
    at.position_mm = [0.0, 0.0, 40.0]
    free = { mass_kg = 0.1 }
    "#,
        r#"title = "c"
    duration_s = 0.1
    patches = [
        { name = "a", stroke_mm = 1.0, layout = { disc = { radius_mm = 5.0, pitch_mm = 2.0 } } },
        { name = "b", stroke_mm = 1.0, layout = { annulus = { inner_mm = 5.0, outer_mm = 9.0, pitch_mm = 2.0 } } },
        { name = "c", stroke_mm = 1.0, layout = { cylinder = { radius_mm = 20.0, length_mm = 9.0, arc_deg = 90.0, pitch_mm = 2.0 } } },
        { name = "d", stroke_mm = 1.0, layout = { sphere_cap = { radius_mm = 20.0, half_angle_deg = 30.0, pitch_mm = 2.0 } } },
    ]
    "#,
    ];

    /// Calls `visit` with the path and the schema of each number of a file, given the schema of the file.
    fn each_number(
        value: &toml::Value,
        schema: &Value,
        path: &[String],
        visit: &mut dyn FnMut(&[String], &Value),
    ) {
        let forms = ["anyOf", "oneOf"].map(|forms| schema[forms].as_array());
        for form in forms.into_iter().flatten().flatten() {
            each_number(value, form, path, visit);
        }
        let below = |name: String| [path, &[name]].concat();
        match value {
            toml::Value::Table(table) => {
                for (name, inner) in table {
                    let schema = &schema["properties"][name];
                    each_number(inner, schema, &below(name.clone()), visit);
                }
            }
            toml::Value::Array(values) => {
                for (number, inner) in values.iter().enumerate() {
                    each_number(inner, &schema["items"], &below(number.to_string()), visit);
                }
            }
            _ if schema["type"] == "number" || schema["type"] == "integer" => visit(path, schema),
            _ => {}
        }
    }

    #[test]
    fn a_scene_has_the_numbers_that_its_schema_allows() {
        let schema = scene_schema();
        let plan = |scene: &toml::Value| {
            let text = toml::to_string(scene).unwrap();
            let spec = SceneSpec::parse("s.toml", &text)?;
            ScenePlan::new("s.toml", Path::new(""), spec)
        };
        let mut n_bounds = 0;
        for text in SCENES {
            let scene = toml::Value::Table(text.parse().unwrap());
            plan(&scene).unwrap();
            each_number(&scene, &schema, &[], &mut |path, schema| {
                for number in [-1.0, 0.0] {
                    let is_above = |least: &str, is_in: fn(f64, f64) -> bool| {
                        schema[least]
                            .as_f64()
                            .is_none_or(|least| is_in(number, least))
                    };
                    let is_allowed = is_above("minimum", |n, least| n >= least)
                        && is_above("exclusiveMinimum", |n, least| n > least);
                    let mut scene = scene.clone();
                    let place =
                        path.iter()
                            .fold(&mut scene, |value, name| match name.parse::<usize>() {
                                Ok(number) if value.is_array() => &mut value[number],
                                _ => &mut value[&name[..]],
                            });
                    *place = match schema["type"] == "integer" {
                        true => toml::Value::Integer(number as i64),
                        false => toml::Value::Float(number),
                    };
                    // A number without bounds may be refused for another reason.
                    if !is_allowed {
                        assert!(plan(&scene).is_err(), "{path:?} = {number}");
                        n_bounds += 1;
                    } else if schema.get("minimum").is_some() {
                        assert!(plan(&scene).is_ok(), "{path:?} = {number}");
                    }
                }
            });
        }
        assert!(n_bounds > 60, "{n_bounds}");
    }
}
