//! Keys of `[recognition]` that are declared by classifiers, such as `n_trees`.

use crate::inputs::keys::{AxisPlace, KeyAbout};
use crate::inputs::params::{Described, sentence};
use crate::inputs::range::Range;
use crate::learning::classifiers::classifier::Classifier;
use crate::learning::classifiers::parameters::{DefaultValue, declared};
use crate::table::Role;
use serde::de::MapAccess;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// Values of [declared] classifier parameters, by key: those given in the study, and defaults that are always written.
#[derive(Clone, Debug, PartialEq)]
pub struct ClassifierParameters(BTreeMap<&'static str, f64>);

impl Default for ClassifierParameters {
    fn default() -> Self {
        let written = declared().filter(|parameter| parameter.is_always_written);
        let numbers = written.filter_map(|one| Some((one.key, one.default_number()?)));
        Self(numbers.collect())
    }
}

impl ClassifierParameters {
    /// Returns a copy of the classifier in which the parameters of its kind are set.
    ///
    /// # Panics
    /// If a value is out of its range.
    pub fn applied_to(&self, classifier: Classifier) -> Classifier {
        let kind = classifier.kind;
        let used = self.0.iter().filter(|(key, _)| kind.uses(key));
        used.fold(classifier, |classifier, (key, value)| {
            let changed = classifier.with(key, *value);
            changed.expect("the ranges of all keys of a study are checked")
        })
    }
}

/// Writes the parameters as keys of a table, in the order of their declaration; integers have no decimal point.
impl Serialize for ClassifierParameters {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        #[serde(untagged)]
        enum Number {
            Integer(u64),
            Real(f64),
        }
        let given = declared().filter_map(|one| Some((one, *self.0.get(one.key)?)));
        serializer.collect_map(given.map(|(parameter, value)| {
            let number = match parameter.is_integer {
                true => Number::Integer(value as u64),
                false => Number::Real(value),
            };
            (parameter.key, number)
        }))
    }
}

/// The table around the parameters reads their keys.
impl<'de> Deserialize<'de> for ClassifierParameters {
    fn deserialize<D: Deserializer<'de>>(_: D) -> Result<Self, D::Error> {
        Ok(Self::default())
    }
}

impl Described for ClassifierParameters {
    fn schema() -> Value {
        let keys = declared().map(|parameter| {
            let number = |value: f64| match parameter.is_integer {
                true => json!(value as u64),
                false => json!(value),
            };
            let words = sentence(parameter.words);
            let mut key = json!({
                "type": if parameter.is_integer { "integer" } else { "number" },
            });
            let default = match parameter.default {
                DefaultValue::Number(default) => {
                    key["default"] = number(default);
                    default.to_string()
                }
                DefaultValue::Rule(rule, meaning) => format!("'{rule}', {meaning}"),
            };
            key["description"] = format!("{words}. Default: {default}.").into();
            let bounds = Range::Declared(parameter).keywords();
            key.as_object_mut()
                .into_iter()
                .for_each(|key| key.extend(bounds.clone()));
            (parameter.key.to_owned(), key)
        });
        json!({ "properties": Map::from_iter(keys) })
    }

    fn absent() -> Option<Self> {
        Some(Self::default())
    }

    fn describe_keys(_: &str, keys: &mut Vec<KeyAbout>) {
        keys.extend(declared().map(|parameter| {
            let path = format!("recognition.{}", parameter.key).leak();
            KeyAbout::new(
                path,
                AxisPlace::Axes,
                Role::Choice,
                Range::Declared(parameter),
            )
        }));
    }

    fn inner_names() -> &'static [&'static str] {
        static NAMES: LazyLock<Vec<&str>> =
            LazyLock::new(|| declared().map(|one| one.key).collect());
        &NAMES
    }

    fn read_inner<'de, M: MapAccess<'de>>(
        slot: &mut Option<Self>,
        name: &'static str,
        map: &mut M,
    ) -> Result<(), M::Error> {
        let is_integer = declared().any(|one| one.key == name && one.is_integer);
        let value = match is_integer {
            true => map.next_value::<usize>()? as f64,
            false => map.next_value()?,
        };
        slot.get_or_insert_default().0.insert(name, value);
        Ok(())
    }
}
