//! Changes to generated schemas: TOML has no null, and descriptions are plain text.

use serde_json::{Map, Value};

/// Removes nulls, number formats of Rust, and links from a schema.
pub(super) fn tidy(schema: &mut Value) {
    match schema {
        Value::Object(keys) => tidy_object(keys),
        Value::Array(values) => values.iter_mut().for_each(tidy),
        _ => {}
    }
}

fn tidy_object(keys: &mut Map<String, Value>) {
    if keys.get("default").is_some_and(Value::is_null) {
        keys.remove("default");
    }
    // The format of a Rust number. A key of this name is an object.
    if keys.get("format").is_some_and(Value::is_string) {
        keys.remove("format");
    }
    if let Some(Value::Array(types)) = keys.get_mut("type") {
        types.retain(|one| one != "null");
        if let [one] = &types[..] {
            let one = one.clone();
            keys.insert("type".to_owned(), one);
        }
    }
    if let Some(Value::Array(choices)) = keys.get_mut("anyOf") {
        choices.retain(|one| one.get("type").is_none_or(|of| of != "null"));
        if let [Value::Object(only)] = &choices[..] {
            let only = only.clone();
            keys.remove("anyOf");
            for (key, value) in only {
                keys.entry(key).or_insert(value);
            }
        }
    }
    if let Some(Value::Array(names)) = keys.get_mut("enum") {
        names.retain(|name| !name.is_null());
    }
    if let Some(Value::String(words)) = keys.get_mut("description") {
        *words = plain(words);
    }
    keys.values_mut().for_each(tidy);
}

/// Converts a doc comment to plain text: one line per paragraph, without links to items of the library.
pub(super) fn plain(words: &str) -> String {
    let paragraphs = words.split("\n\n").map(|paragraph| {
        let words = paragraph.split_whitespace().collect::<Vec<_>>();
        words.join(" ")
    });
    let words = paragraphs.collect::<Vec<_>>().join("\n\n");
    let mut plain = String::new();
    let mut rest = words.as_str();
    while let Some(start) = rest.find('[') {
        let (before, link) = rest.split_at(start);
        plain.push_str(before);
        let is_escaped = before.ends_with('\\');
        match link_of(link).filter(|_| !is_escaped) {
            Some((words, after)) => {
                plain.push_str(words);
                rest = after;
            }
            None => {
                plain.push('[');
                rest = &link[1..];
            }
        }
    }
    plain.push_str(rest);
    plain.replace("\\[", "[").replace("\\]", "]")
}

/// Splits a text that begins with a documentation link into the words of the link and the rest of the text. A link is [`Type`] or [words](path).
fn link_of(text: &str) -> Option<(&str, &str)> {
    let end = text.find(']')?;
    let (words, after) = (&text[1..end], &text[end + 1..]);
    if let Some(target) = after.strip_prefix('(') {
        let (target, after) = target.split_once(')')?;
        return (!target.starts_with("http")).then_some((words, after));
    }
    let is_item = words.starts_with('`') && words.ends_with('`') && words.len() > 2;
    // `[signal]` in back quotes is the name of a TOML table.
    is_item.then_some((words, after))
}

/// Returns the keys of a table with their schemas.
pub(super) fn properties(schema: &Value) -> impl Iterator<Item = (&String, &Value)> {
    let keys = schema.get("properties").and_then(Value::as_object);
    keys.into_iter().flatten()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_description_keeps_names_of_tables_and_loses_links() {
        for (given, expected) in [
            (
                "`[signal]`: noise\nand [`Noise`](crate::signal::Noise).",
                "`[signal]`: noise and `Noise`.",
            ),
            (
                "a rule of [`PoseSplit`]\n\n[x](y::z) as in \\[BT\\], [CL]",
                "a rule of `PoseSplit`\n\nx as in [BT], [CL]",
            ),
            (
                "see [the page](https://a.b) of [[robots]]",
                "see [the page](https://a.b) of [[robots]]",
            ),
        ] {
            assert_eq!(plain(given), expected);
        }
    }

    #[test]
    fn null_is_no_value_of_toml() {
        let mut schema = json!({
            "type": ["number", "null"], "format": "double", "default": null,
            "properties": { "format": { "anyOf": [{ "enum": ["a", null] }, { "type": "null" }], "description": "b" } },
        });
        tidy(&mut schema);
        let expected = json!({ "type": "number", "properties": { "format": { "enum": ["a"], "description": "b" } } });
        assert_eq!(schema, expected);
    }
}
