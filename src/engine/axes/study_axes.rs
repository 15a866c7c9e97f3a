//! All axes of a study, and the combinations of their values that become configurations. The key of an axis is a dotted path, such as `skin.stroke_mm`.

use super::study_axis::StudyAxis;
use crate::error::{Error, Result};
use crate::inputs::params::words;
use crate::inputs::toml_value::table_of;
use crate::table::Column;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::borrow::Cow;
use std::sync::Arc;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

words! {
    /// Rule that selects the combinations of axis values that become configurations.
    pub enum CombineSpec = All {
        /// All combinations of the values of the axes are computed.
        All = "all",
        /// A base configuration, and variants in which a single axis has another value than in the base configuration. The base has the first value of each axis;
        /// for `[axes]`, it has the values of the study's own tables.
        OneAtATime = "one_at_a_time",
    }
}

/// Axes of a study; the last axis changes fastest.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StudyAxes {
    /// Axes of the table `[axes]` in the order in which they are written, followed by lists in other tables, in the order of the declarations of their keys.
    pub axes: Vec<StudyAxis>,
    /// Rule that combines the axes of the table `[axes]`. Lists in other tables are combined with all of them.
    pub combine: CombineSpec,
}

/// Values of one configuration on all axes of the study.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AxisValues {
    /// Number of the combination of values, from 0.
    pub number: usize,
    /// Value of each axis that has no separate column in result tables.
    pub values: Arc<[AxisValue]>,
}

/// Value of one configuration on an axis, as it is written in result tables.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisValue {
    /// Column of the result tables that contains the values of the axis.
    pub column: Column,
    /// Number, truth value or text on the axis; lists and tables are converted to text. The field is `None` if the axis keeps the value of the study and the
    /// study has no such value.
    pub value: Option<toml::Value>,
}

impl AxisValues {
    /// Creates the axis values of the combination with this number. The columns of those axes that result tables do not have yet are `columns`.
    pub fn new(
        number: usize,
        (axes, columns): (&StudyAxes, &[Column]),
        values: &[Option<toml::Value>],
    ) -> Self {
        use toml::Value::{Boolean, Float, Integer, String};
        let axes = axes.axes.iter().zip(values);
        let shown = axes.filter(|(axis, _)| !axis.has_column);
        let values = columns.iter().zip(shown);
        let values = values.map(|(column, (_, value))| AxisValue {
            column: column.clone(),
            value: value.as_ref().map(|value| match value {
                Integer(_) | Float(_) | Boolean(_) | String(_) => value.clone(),
                other => other.to_string().into(),
            }),
        });
        Self {
            number,
            values: values.collect(),
        }
    }

    /// Returns the table cells of the axes: the name of the column and the value.
    pub(crate) fn cells(&self) -> impl Iterator<Item = (&'static str, &Option<toml::Value>)> {
        let values = self.values.iter();
        values.filter_map(|axis| match axis.column.name {
            Cow::Borrowed(name) => Some((name, &axis.value)),
            Cow::Owned(_) => None,
        })
    }
}

impl StudyAxes {
    /// Returns whether the study has no axes.
    pub fn is_empty(&self) -> bool {
        self.axes.is_empty()
    }

    /// Returns whether some axes are in the table `[axes]`.
    pub fn has_own_table(&self) -> bool {
        self.axes.iter().any(|axis| !axis.is_of_table)
    }

    /// Returns whether an axis varies the given key.
    pub fn has(&self, key: &str) -> bool {
        let mut axes = self.axes.iter();
        axes.any(|axis| axis.keys().iter().any(|own| own == key))
    }

    /// Returns the number of variants that have the same values of the axes in `[axes]`.
    pub fn n_of_tables(&self) -> usize {
        let of_tables = self.axes.iter().filter(|axis| axis.is_of_table);
        of_tables.map(|axis| axis.values.len()).product()
    }

    /// Returns the number of values of a key in its own table.
    pub(crate) fn n_values(&self, key: &str) -> usize {
        let mut axes = self.axes.iter();
        let axis = axes.find(|axis| axis.is_of_table && axis.key == key);
        axis.map_or(1, |axis| axis.values.len())
    }

    /// Returns one column for each axis that has no column in result tables yet. For a name that another column already has, `is_taken` returns true.
    pub fn columns(&self, is_taken: impl Fn(&str) -> bool) -> Vec<Column> {
        let column = |axis: &StudyAxis| {
            let alike = self.axes.iter().filter(|other| other.name() == axis.name());
            let is_shared = alike.count() > 1;
            axis.column(|name| is_shared || is_taken(name))
        };
        let shown = self.axes.iter().filter(|axis| !axis.has_column);
        shown.map(column).collect()
    }

    /// Returns the number of combinations of axis values that become configurations.
    pub fn n_combinations(&self) -> f64 {
        let (of_tables, of_axes): (Vec<_>, Vec<_>) =
            self.axes.iter().partition(|axis| axis.is_of_table);
        let lengths = of_axes.iter().map(|axis| axis.values.len() as f64);
        let n_first: f64 = match self.combine {
            CombineSpec::All => lengths.product(),
            CombineSpec::OneAtATime => 1.0 + lengths.sum::<f64>(),
        };
        let of_tables = of_tables.iter().map(|axis| axis.values.len() as f64);
        n_first * of_tables.product::<f64>()
    }

    /// Returns all combinations of axis values that become configurations; the last axis changes fastest. An entry of `None` means that the axis keeps its
    /// value in `study`.
    fn combinations(&self, study: &toml::Table) -> Vec<Vec<Option<toml::Value>>> {
        let mut all = vec![Vec::new()];
        let mut combined = &self.axes[..];
        if self.combine == CombineSpec::OneAtATime {
            let n_alone = combined.partition_point(|axis| !axis.is_of_table);
            let (alone, others) = combined.split_at(n_alone);
            combined = others;
            all = vec![vec![None; n_alone]];
            for (place, axis) in alone.iter().enumerate() {
                let others = axis.values.iter().filter(|value| !axis.is_at(study, value));
                all.extend(others.map(|value| {
                    let mut values = vec![None; n_alone];
                    values[place] = Some(value.clone());
                    values
                }));
            }
        }
        for axis in combined {
            let longer = all.iter().flat_map(|values: &Vec<Option<toml::Value>>| {
                let with = |value: &toml::Value| [&values[..], &[Some(value.clone())]].concat();
                axis.values.iter().map(with)
            });
            all = longer.collect();
        }
        all
    }

    /// Returns one study for each combination of axis values, together with these values. If an axis keeps its value, the listed value is the value in `study`.
    ///
    /// # Errors
    /// If a value is invalid for the study; the error names the axis.
    pub fn variants<S: Serialize + DeserializeOwned>(
        &self,
        place: &str,
        study: &S,
    ) -> Result<Vec<(Vec<Option<toml::Value>>, S)>> {
        let base = table_of(study);
        let all = self.combinations(&base).into_iter().map(|mut values| {
            let mut table = base.clone();
            for (axis, value) in self.axes.iter().zip(&mut values) {
                let Some(value) = value else {
                    *value = axis.own(&base);
                    continue;
                };
                for key in axis.keys() {
                    let set = set_value(&mut table, &key, value.clone());
                    set.map_err(|error| axis.error(place, &*value, error))?;
                }
            }
            let study = table.try_into();
            let study = study.map_err(|error: toml::de::Error| {
                let said = error.to_string().trim().replace('\n', " ");
                self.refused(place, &values, &said)
            })?;
            Ok((values, study))
        });
        all.collect()
    }

    /// Returns the error about a combination of axis values that the study's checks reject. The error names the axes whose keys the message `said` mentions, or
    /// all axes of the table `[axes]`.
    pub fn refused(&self, place: &str, values: &[Option<toml::Value>], said: &str) -> Error {
        let all = || {
            let axes = self.axes.iter().zip(values);
            axes.filter_map(|(axis, value)| Some((axis, value.as_ref()?)))
        };
        let names = |axis: &StudyAxis| axis.keys().iter().any(|key| said.contains(key));
        let mut named: Vec<_> = all().filter(|(axis, _)| names(axis)).collect();
        if named.is_empty() {
            named = all().filter(|(axis, _)| !axis.is_of_table).collect();
        }
        let given = |(axis, value): &(&StudyAxis, &toml::Value)| format!("{} = {value}", axis.key);
        let given: Vec<String> = named.iter().map(given).collect();
        let said = said.strip_prefix(place).unwrap_or(said);
        let said = said.trim_start_matches([',', ':', ' ']);
        match named.first() {
            Some((axis, _)) => axis.error(place, given.join(", "), said),
            None => Error::input(place, "a study", said),
        }
    }
}

/// Sets the value at the dotted path `key` of a table. Missing tables along the path are created, and an existing value is replaced.
///
/// # Errors
/// If the path is empty, or if a part of it is not a table.
fn set_value(table: &mut toml::Table, key: &str, value: toml::Value) -> Result<()> {
    match table_at(table, key) {
        Some((inner, last)) if !key.split('.').any(str::is_empty) => {
            inner.insert(last.to_owned(), value);
            Ok(())
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

/// Removes the list at a dotted key path, and returns it with the position of its key in the text. Returns `None` if the key has no list.
pub(super) fn take_list<'i>(
    table: &mut DeTable<'i>,
    key: &str,
) -> Option<(usize, Spanned<DeValue<'i>>)> {
    if let Some((first, rest)) = key.split_once('.') {
        return match table.get_mut(first)?.get_mut() {
            DeValue::Table(inner) => take_list(inner, rest),
            _ => None,
        };
    }
    table.get(key)?.get_ref().as_array()?;
    let (name, list) = table.remove_entry(key)?;
    Some((name.span().start, list))
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
        let with = |key: &str, value: toml::Value| {
            let mut changed = table.clone();
            set_value(&mut changed, key, value).map(|()| changed)
        };
        let changed = with("b.c", 3.into()).unwrap();
        let expected = "a = 1\n[b]\nc = 3".parse().unwrap();
        assert_eq!(changed, expected);
        let made = with("d.e.f", true.into()).unwrap();
        assert_eq!(made["d"]["e"]["f"].as_bool(), Some(true));
        for key in ["a.b", "", "a..b", ".a", "b."] {
            let error = with(key, 3.into()).unwrap_err();
            assert_eq!(error.exit_code(), 2, "{key}");
        }
    }
}
