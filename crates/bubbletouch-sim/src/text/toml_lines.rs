//! Lines of TOML texts, and errors that contain them.

use crate::error::Error;
use toml::de::{DeTable, DeValue};

/// Returns the line number of a byte of a text, counted from 1.
pub fn line_of(text: &str, byte: usize) -> usize {
    1 + text[..byte.min(text.len())].matches('\n').count()
}

/// Adds the line of the key, as in `file:12, key skin.stroke_mm`, to an error that contains a key of this text without a line.
pub fn with_line(place: &str, text: &str, error: Error) -> Error {
    let Error::Input {
        place: named,
        given,
        allowed,
    } = &error
    else {
        return error;
    };
    if named.starts_with("key ") {
        let whole = Error::input(format!("{place}, {named}"), given, allowed);
        return with_line(place, text, whole);
    }
    let rest = named.strip_prefix(place);
    let key = rest.and_then(|rest| rest.strip_prefix(", key "));
    let Some(line) = key.and_then(|key| line_of_key(text, key)) else {
        return error;
    };
    let rest = &named[place.len()..];
    Error::input(format!("{place}:{line}{rest}"), given, allowed)
}

/// Returns the line number of a key, or of the innermost existing table on its path. Returns `None` if the first part of the path does not exist. A part of
/// a path is a name, a name with a number from 1 (`parts[2]`), or the name of a table in an array (`objects.ball`).
fn line_of_key(text: &str, path: &str) -> Option<usize> {
    let table = DeTable::parse(text).ok()?;
    position(table.get_ref(), path).map(|start| line_of(text, start))
}

/// Returns the position of the innermost key or table on a path that exists in a table.
fn position(table: &DeTable, path: &str) -> Option<usize> {
    let keys = table.iter();
    let on_path = keys.filter_map(|(key, value)| Some((key, value, after(path, key.get_ref())?)));
    // A key or a name may contain dots.
    let (key, value, rest) = on_path.min_by_key(|(.., rest)| rest.len())?;
    let inner = match value.get_ref() {
        DeValue::Table(inner) => position(inner, rest),
        DeValue::Array(entries) => {
            let on_path = entries.iter().zip(1..).filter_map(|(entry, number)| {
                let name = entry.get_ref().get("name");
                let name = || name?.get_ref().as_str();
                let numbered = after(rest, &format!("[{number}]"));
                Some((entry, numbered.or_else(|| after(rest, name()?))?))
            });
            let entry = on_path.min_by_key(|(_, rest)| rest.len());
            entry.and_then(|(entry, rest)| {
                let table = entry.get_ref().as_table();
                let inner = table.and_then(|table| position(table, rest));
                inner.or(Some(entry.span().start))
            })
        }
        _ => None,
    };
    inner.or(Some(key.span().start))
}

/// Returns the part of a path after its first part, `name`; `None` if the path begins with another part.
fn after<'p>(path: &'p str, name: &str) -> Option<&'p str> {
    let rest = path.strip_prefix(name)?;
    match rest.chars().next() {
        Some('.') => Some(&rest[1..]),
        // A number of an entry, or the end of the path in a message.
        None | Some('[' | ',' | ':' | ' ') => Some(rest),
        Some(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "seed = 9000000000000000000\n[skin]\nstroke_mm = 5\n\n[[objects]]\nname = \"ball\"\nfree = { mass_kg = 1.0 }\n[[objects]]\nname = \"box\"\nat = { position_mm = [\n0.0, 1.0, 2.0] }\n[[objects]]\nname = \"box.2 b\"\nparts = [\n{ size = 1 }, { size = 2 }]\n";

    #[test]
    fn an_error_about_a_key_gets_the_line_of_the_key() {
        for (key, wanted) in [
            ("skin.stroke_mm", "s.toml:3, key skin.stroke_mm"),
            ("skin.pitch_mm", "s.toml:2, key skin.pitch_mm"),
            ("objects.box.at.position_mm", "s.toml:10, key objects.box"),
            ("objects[1].free.mass_kg", "s.toml:7, key objects[1]"),
            ("objects.box, at", "s.toml:8, key objects.box, at"),
            ("objects.box.2 b.parts", "s.toml:14, key objects.box.2 b"),
            ("objects.box.2 b.parts[2].size", "s.toml:15, key objects"),
            ("touches", "s.toml, key touches"),
        ] {
            let error = Error::input(format!("s.toml, key {key}"), 1, 2);
            let said = with_line("s.toml", TEXT, error).to_string();
            assert!(said.starts_with(wanted), "{said}\nis not\n{wanted}");
        }
    }
}
