//! The page `guide/reference.md`: all keys of study and scene files.

use super::axes_schema::is_axis;
use super::properties;
use super::scene_schema;
use super::study_schema::{KindSchema, kinds};
use crate::inputs::keys::{AxisPlace, KeyAbout, unit_of};
use crate::inputs::params::{ORDER, sentence};
use bubbletouch_sim::text::numbers::short_literal;
use serde_json::Value;

/// Template of the page; the names in braces stand for the sections of keys.
const TEMPLATE: &str = include_str!("reference_page.md");

/// Returns the page.
pub fn reference_page() -> String {
    let kinds = kinds();
    let mut written = Vec::new();
    let sections = kinds.iter().map(|kind| {
        let mut section = words_of_kind(kind, &kinds[0]);
        let file = FileKind {
            schema: &kind.schema,
            keys: &kind.keys,
        };
        file.write(&mut written, &mut section);
        section
    });
    let sections: Vec<String> = sections.collect();
    let file = FileKind {
        schema: &scene_schema(),
        keys: &[],
    };
    let mut scenes = String::new();
    file.write(&mut Vec::new(), &mut scenes);
    let page = TEMPLATE
        .replace("{recognition}", &sections[0])
        .replace("{other kinds}", &sections[1..].concat())
        .replace("{scenes}", &scenes);
    with_plain_sources(&page)
}

/// Returns the page with each source, such as `[BT]`, escaped. Markdown would read the brackets as a link.
fn with_plain_sources(page: &str) -> String {
    let mut parts = page.split('[');
    let mut plain = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let source = part.split_once(']').filter(|(tag, rest)| {
            let is_tag = !tag.is_empty() && tag.bytes().all(|byte| byte.is_ascii_uppercase());
            is_tag && !rest.starts_with('(')
        });
        match source {
            Some((tag, rest)) => plain.push_str(&format!("\\[{tag}\\]{rest}")),
            None => plain.push_str(&format!("[{part}")),
        }
    }
    plain
}

/// Returns the heading and description of a kind of study, and links to tables that earlier sections describe.
fn words_of_kind(kind: &KindSchema, first: &KindSchema) -> String {
    let is_shared = |name: &str, schema: &Value| {
        kind.table != first.table
            && schema.get("properties").is_some()
            && first.schema["properties"].get(name).is_some()
    };
    let shared = properties(&kind.schema).filter(|(name, schema)| is_shared(name, schema));
    let shared: Vec<String> = shared.map(|(name, _)| link(&format!("[{name}]"))).collect();
    let mut words = format!("\n### Studies with `[{}]`\n\n", kind.table);
    words.push_str(&sentence(&format!("{}.", kind.words)));
    if !shared.is_empty() {
        words.push_str(&format!(" They also have {}.", shared.join(", ")));
    }
    words.push('\n');
    words
}

/// Returns a link to the section with the given heading.
fn link(heading: &str) -> String {
    let anchor = heading.to_lowercase();
    let anchor: String = anchor
        .chars()
        .filter(|c| c.is_alphanumeric() || *c == '_')
        .collect();
    format!("[`{heading}`](#{anchor})")
}

/// Kind of input file, such as a study or a scene.
struct FileKind<'s> {
    schema: &'s Value,
    /// Descriptions of the keys; empty for scene files, whose keys cannot be swept.
    keys: &'s [KeyAbout],
}

/// Step from a table to one of its subtables.
#[derive(Clone)]
struct Step {
    name: String,
    is_list: bool,
}

/// Table of keys in a study or scene file.
#[derive(Clone)]
struct Table<'s> {
    path: Vec<Step>,
    schema: &'s Value,
    description: &'s str,
}

/// Tables that already have a section on the page, with the headings of the sections.
type Written = Vec<(Value, String)>;

impl FileKind<'_> {
    fn write(&self, written: &mut Written, page: &mut String) {
        let table = Table {
            path: Vec::new(),
            schema: self.schema,
            description: "",
        };
        self.write_table(&table, written, page);
    }

    /// Writes the section about a table, followed by its subtables that have no section yet.
    fn write_table(&self, table: &Table, written: &mut Written, page: &mut String) {
        if !table.path.is_empty() {
            page.push_str(&format!(
                "\n#### `{}`\n\n{}\n",
                table.heading(),
                table.description
            ));
        }
        let axis_header = if self.keys.is_empty() { "" } else { " axis |" };
        page.push_str(&format!(
            "\n| key | values | unit | range | default |{axis_header} meaning |\n"
        ));
        page.push_str(&format!(
            "|---|---|---|---|---|{} ---|\n",
            axis_header.replace(" axis ", "---")
        ));
        let required = table.schema["required"]
            .as_array()
            .cloned()
            .unwrap_or_default();
        let mut inner = Vec::new();
        let mut lists = String::new();
        for name in table.names() {
            let key = &table.schema["properties"][name];
            if REPEATED.contains(&name) && table.path.is_empty() {
                continue;
            }
            let nested = table.nested_tables(name, key);
            let values = match &nested[..] {
                [] => values(key),
                tables => {
                    let values =
                        single_values(key).map(|(value, words, _)| format!("{value} ({words})"));
                    let links = std::iter::once(self.links(tables, written));
                    links.chain(values).collect::<Vec<_>>().join(", ")
                }
            };
            let default = match required.contains(&name.into()) {
                true => "required".to_owned(),
                false => default(key),
            };
            let about = table.about(name, self.keys);
            let axis = match self.keys.is_empty() {
                true => String::new(),
                false => format!(" {} |", axis(about)),
            };
            page.push_str(&format!(
                "| `{name}` | {values} | {} | {} | {default} |{axis} {} |\n",
                unit(name, about),
                range(key),
                meaning(key),
            ));
            lists.push_str(&meanings_of_values(name, key));
            inner.extend(nested);
        }
        page.push_str(&lists);
        for table in inner {
            if !written
                .iter()
                .any(|(known, _)| *known == bare(table.schema))
            {
                written.push((bare(table.schema), table.heading()));
                self.write_table(&table, written, page);
            }
        }
    }

    /// Returns links to the sections of the given tables.
    fn links(&self, tables: &[Table], written: &Written) -> String {
        let links = tables.iter().map(|table| {
            let known = written
                .iter()
                .find(|(known, _)| *known == bare(table.schema));
            link(&known.map_or_else(|| table.heading(), |(_, heading)| heading.clone()))
        });
        links.collect::<Vec<_>>().join(", ")
    }
}

/// Names of the tables that repeat keys of other tables.
const REPEATED: [&str; 2] = ["test", "axes"];

impl<'s> Table<'s> {
    /// Returns the name of the table in a file: `[object_detail.recognition]`, or `[[robots]]` for a list of tables.
    fn heading(&self) -> String {
        let names: Vec<&str> = self.path.iter().map(|step| &step.name[..]).collect();
        let is_list = self.path.last().is_some_and(|step| step.is_list);
        match is_list {
            true => format!("[[{}]]", names.join(".")),
            false => format!("[{}]", names.join(".")),
        }
    }

    /// Returns the names of all keys, in the order of their declaration.
    fn names(&self) -> impl Iterator<Item = &'s str> {
        let order = self.schema[ORDER].as_array();
        order.into_iter().flatten().filter_map(Value::as_str)
    }

    /// Returns the description of a key in the table.
    fn about<'k>(&self, name: &str, keys: &'k [KeyAbout]) -> Option<&'k KeyAbout> {
        let names = self.path.iter().map(|step| &step.name[..]).chain([name]);
        let path = names.collect::<Vec<_>>().join(".");
        keys.iter().find(|key| key.path == path)
    }

    /// Returns the tables that are the value of a key: a single table, or one for each variant.
    fn nested_tables(&self, name: &str, key: &'s Value) -> Vec<Self> {
        let is_list = key["type"] == "array";
        let value = if is_list { &key["items"] } else { key };
        let name = name.to_owned();
        let mut path = self.path.clone();
        path.push(Step { name, is_list });
        if value.get("properties").is_some() {
            return vec![Self {
                path,
                schema: value,
                description: key["description"].as_str().unwrap_or_default(),
            }];
        }
        let variants = variants(value).filter_map(|(variant, schema, description)| {
            let name = variant.clone();
            let is_list = false;
            Some(Self {
                path: [&path[..], &[Step { name, is_list }]].concat(),
                schema: choices(schema).find(|choice| choice.get("properties").is_some())?,
                description,
            })
        });
        variants.collect()
    }
}

/// Returns the variants of an enum whose variants are tables with one key: the key, the schema of its value, and the description.
fn variants(schema: &Value) -> impl Iterator<Item = (&String, &Value, &str)> {
    let variants = schema["oneOf"].as_array().into_iter().flatten();
    variants.flat_map(|variant| {
        let description = variant["description"].as_str().unwrap_or_default();
        properties(variant).map(move |(name, schema)| (name, schema, description))
    })
}

/// Returns the schemas of which a value fulfils one: the elements of `anyOf`, or the schema itself.
fn choices(schema: &Value) -> impl Iterator<Item = &Value> {
    let choices = schema["anyOf"].as_array();
    let own = choices.is_none().then_some(schema);
    choices.into_iter().flatten().chain(own)
}

/// Returns the variants of an enum whose value may be a word or a number instead of a table. Each variant has its name as written, its values, and its
/// description.
fn single_values(schema: &Value) -> impl Iterator<Item = (String, String, &str)> {
    variants(schema).flat_map(|(name, value, description)| {
        let single = choices(value).filter(|choice| choice.get("properties").is_none());
        single.map(move |choice| (format!("`{{ {name} = … }}`"), values(choice), description))
    })
}

/// Returns a schema without the texts that depend on its position in the document.
fn bare(schema: &Value) -> Value {
    let mut bare = schema.clone();
    if let Some(keywords) = bare.as_object_mut() {
        keywords.remove("description");
        keywords.remove("default");
        keywords.remove("required");
    }
    bare
}

/// Describes the values that a key may have: `number`, or a list of names.
fn values(schema: &Value) -> String {
    if let Some(title) = schema["title"].as_str() {
        return title.to_owned();
    }
    if is_axis(schema) {
        return values(&schema["anyOf"][0]);
    }
    if let Some(name) = schema["const"].as_str() {
        return format!("`{name}`");
    }
    if let Some(names) = schema["enum"].as_array() {
        let names = names.iter().filter_map(Value::as_str);
        return names
            .map(|name| format!("`{name}`"))
            .collect::<Vec<_>>()
            .join(", ");
    }
    for choice in ["anyOf", "oneOf"] {
        if let Some(choices) = schema[choice].as_array() {
            return choices.iter().map(values).collect::<Vec<_>>().join(", ");
        }
    }
    match schema["type"].as_str() {
        Some("boolean") => "`true`, `false`".to_owned(),
        Some("string") => "text".to_owned(),
        Some("array") => list_words(schema),
        Some("object") => {
            let keys: Vec<String> = properties(schema)
                .map(|(name, value)| format!("`{{ {name} = … }}` ({})", values(value)))
                .collect();
            match keys.is_empty() {
                true => "table".to_owned(),
                false => keys.join(", "),
            }
        }
        Some(other) => other.to_owned(),
        None => "any".to_owned(),
    }
}

/// Describes a list: `list of 3 numbers`.
fn list_words(schema: &Value) -> String {
    let items = match schema["prefixItems"].as_array() {
        Some(_) => "number".to_owned(),
        None => values(&schema["items"]),
    };
    let items = match &items[..] {
        "number" | "integer" | "text" | "table" => format!("{items}s"),
        _ => items,
    };
    match (schema["minItems"].as_u64(), schema["maxItems"].as_u64()) {
        (Some(least), Some(most)) if least == most => format!("list of {least} {items}"),
        _ => format!("list of {items}"),
    }
}

/// Describes the range of numbers that a key allows.
fn range(schema: &Value) -> String {
    let choices = ["anyOf", "oneOf"].map(|choice| schema[choice].as_array());
    let choices = choices.into_iter().flatten().flatten();
    let inner = std::iter::once(&schema["items"]).chain(choices);
    let own = |keyword: &str| schema[keyword].as_f64().map(short_literal);
    let least = own("minimum").map(|number| format!("≥ {number}"));
    let above = own("exclusiveMinimum").map(|number| format!("> {number}"));
    let most = own("maximum").map(|number| format!("≤ {number}"));
    let below = own("exclusiveMaximum").map(|number| format!("< {number}"));
    let ends: Vec<String> = [least.or(above), most.or(below)]
        .into_iter()
        .flatten()
        .collect();
    match ends.is_empty() {
        true => inner
            .filter(|one| !one.is_null())
            .map(range)
            .find(|words| !words.is_empty())
            .unwrap_or_default(),
        false => ends.join(", "),
    }
}

/// Returns the default value of a key, as it is written in a file.
fn default(schema: &Value) -> String {
    match &schema["default"] {
        Value::Null | Value::Object(_) => String::new(),
        Value::Number(number) => format!(
            "`{}`",
            number.as_f64().map_or_else(String::new, short_literal)
        ),
        Value::Array(values) if values.is_empty() => String::new(),
        Value::String(text) if text.is_empty() => String::new(),
        other => format!(
            "`{}`",
            toml::Value::try_from(other).map_or_else(|_| String::new(), |value| value.to_string())
        ),
    }
}

/// Describes the tables in which a key may have a list of values to sweep.
fn axis(about: Option<&KeyAbout>) -> &'static str {
    match about.map(|about| about.axis) {
        Some(AxisPlace::Table) => "list",
        Some(AxisPlace::Axes) => "`[axes]`",
        Some(AxisPlace::Never) | None => "",
    }
}

/// Returns the unit of a key's numbers. Charts show fractions as percent.
fn unit(name: &str, about: Option<&KeyAbout>) -> &'static str {
    match about.map_or_else(|| unit_of(name), KeyAbout::unit) {
        "%" | ":1" => "",
        unit => unit,
    }
}

/// Returns the meaning of a key in one line.
fn meaning(schema: &Value) -> String {
    let words = schema["description"].as_str().unwrap_or_default();
    let words = words
        .strip_prefix("Axis: ")
        .map_or_else(|| words.to_owned(), sentence);
    words.replace("\n\n", " ").replace('|', "\\|")
}

/// Returns a list of the names that a key may have as value, each with its meaning.
fn meanings_of_values(name: &str, schema: &Value) -> String {
    let one = if is_axis(schema) {
        &schema["anyOf"][0]
    } else {
        schema
    };
    let one = if one["type"] == "array" {
        &one["items"]
    } else {
        one
    };
    let choices = one["oneOf"].as_array().into_iter().flatten();
    let names = choices.filter_map(|choice| {
        let value = choice["const"].as_str()?;
        Some((format!("`{value}`"), choice["description"].as_str()?))
    });
    let values = single_values(one).map(|(value, _, description)| (value, description));
    let lines = names
        .chain(values)
        .map(|(value, words)| format!("- {value}: {}\n", words.replace("\n\n", " ")));
    // Blank lines between the values separate their sentences.
    let lines = lines.collect::<Vec<String>>().join("\n");
    match lines.is_empty() {
        true => lines,
        false => format!("\nValues of `{name}`:\n\n{lines}"),
    }
}
