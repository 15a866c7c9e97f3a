//! Values in a table of TOML by the path of their key.

/// What a table has at a path of keys.
pub(crate) fn value_at<'t>(table: &'t toml::Table, path: &str) -> Option<&'t toml::Value> {
    let mut names = path.split('.');
    let first = table.get(names.next()?)?;
    names.try_fold(first, |value, name| value.get(name))
}

/// A number, whole or not.
pub(crate) fn number(value: &toml::Value) -> Option<f64> {
    let integer = || value.as_integer().map(|integer| integer as f64);
    value.as_float().or_else(integer)
}

/// Whether a key is one of a name, or below it.
pub(crate) fn is_at(key: &str, name: &str) -> bool {
    let rest = key.strip_prefix(name);
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
}
