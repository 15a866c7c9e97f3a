//! Values at dotted key paths, such as `skin.stroke_mm`, in tables of TOML.

use crate::error::{Error, Result};
use std::borrow::Cow;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Returns a copy of `table` in which the dotted path `key` has the given value. Missing tables along the path are created, and an existing value is replaced.
///
/// # Errors
/// If the path is empty, or if a part of it is not a table.
pub(super) fn with_value(
    table: &toml::Table,
    key: &str,
    value: toml::Value,
) -> Result<toml::Table> {
    let mut changed = table.clone();
    match table_at(&mut changed, key) {
        Some((inner, last)) if !key.split('.').any(str::is_empty) => {
            inner.insert(last.to_owned(), value);
            Ok(changed)
        }
        _ => {
            let allowed = "names of tables and of a key, with a point between them: skin.stroke_mm";
            Err(Error::input("key", format!("{key:?}"), allowed))
        }
    }
}

/// Returns the table that contains the last key of a dotted path, and the name of this key. Missing tables along the path are created. Returns `None` if a part
/// of the path is not a table.
pub(super) fn table_at<'t, 'k>(
    table: &'t mut toml::Table,
    path: &'k str,
) -> Option<(&'t mut toml::Table, &'k str)> {
    let Some((first, rest)) = path.split_once('.') else {
        return Some((table, path));
    };
    let inner = table.entry(first);
    let inner = inner.or_insert_with(|| toml::Table::new().into());
    table_at(inner.as_table_mut()?, rest)
}

/// Returns the TOML value at a dotted key path; `None` if the path does not exist.
pub(super) fn find<'t, 'i>(table: &'t DeTable<'i>, key: &str) -> Option<&'t Spanned<DeValue<'i>>> {
    match key.split_once('.') {
        None => table.get(key),
        Some((first, rest)) => find(table.get(first)?.get_ref().as_table()?, rest),
    }
}

/// Inserts a TOML value at a dotted key path, with `start` as its position in the text. Returns `None` if the path already has a value or a part of it is not a
/// table.
pub(super) fn insert<'i>(
    table: &mut DeTable<'i>,
    key: &str,
    (start, value): (usize, Spanned<DeValue<'i>>),
) -> Option<()> {
    let name = |name: &str| Spanned::new(start..start, Cow::Owned(name.to_owned()));
    let Some((first, rest)) = key.split_once('.') else {
        return table.insert(name(key), value).is_none().then_some(());
    };
    let empty = || Spanned::new(start..start, DeValue::Table(DeTable::new()));
    match table.entry(name(first)).or_insert_with(empty).get_mut() {
        DeValue::Table(inner) => insert(inner, rest, (start, value)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_at_a_path_takes_the_place_of_what_was_there() {
        let table: toml::Table = "a = 1\n[b]\nc = 2".parse().unwrap();
        let changed = with_value(&table, "b.c", 3.into()).unwrap();
        let expected = "a = 1\n[b]\nc = 3".parse().unwrap();
        assert_eq!(changed, expected);
        let made = with_value(&table, "d.e.f", true.into()).unwrap();
        assert_eq!(made["d"]["e"]["f"].as_bool(), Some(true));
        for key in ["a.b", "", "a..b", ".a", "b."] {
            let error = with_value(&table, key, 3.into()).unwrap_err();
            assert_eq!(error.exit_code(), 2, "{key}");
        }
    }
}
