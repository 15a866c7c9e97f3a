//! Keys of `[recognition]` that are declared by classifiers, such as `n_trees`.

use crate::inputs::keys::{Acts, AxisPlace, GivenKey, KeyAbout, NoEffect};
use crate::inputs::params::{Described, key_schema, sentence};
use crate::inputs::range::Range;
use crate::inputs::toml_value::{number, number_value};
use crate::learning::classifiers::classifier::Classifier;
use crate::learning::classifiers::parameters::{DefaultValue, declared, users};
use crate::studies::recognition::plan::Plan;
use crate::table::Role;
use serde::de::MapAccess;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value, json};
use std::any::Any;
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// Values of [declared] classifier parameters, by key: those given in the study, and defaults that are always written.
#[derive(Clone, Debug, PartialEq)]
pub struct ClassifierParameters(BTreeMap<&'static str, toml::Value>);

impl Default for ClassifierParameters {
    fn default() -> Self {
        let written = declared().filter(|parameter| parameter.is_always_written);
        let values =
            written.filter_map(|one| Some((one.key, Range::Declared(one).declared_default()?)));
        Self(values.collect())
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
            let changed = number(value).map(|value| classifier.with(key, value));
            let changed = changed.expect("every parameter is a number");
            changed.expect("the ranges of all keys of a study are checked")
        })
    }
}

/// Condition of the keys of `[recognition]` that some classifiers use.
pub(super) const OF_CLASSIFIER: &[Acts] = &[of_classifier];

/// Returns why a parameter has no effect in a study whose classifiers do not use it.
fn of_classifier(key: GivenKey, seen: &dyn Any) -> Option<NoEffect> {
    let kinds = seen.downcast_ref::<Plan>()?.spec.recognition.kinds();
    let (name, value) = (key.about.name(), key.value);
    let is_used = kinds.iter().any(|kind| kind.uses(name));
    (!is_used).then(|| NoEffect {
        given: format!("{value}, but no classifier of the study uses it"),
        allowed: users(name) + " among recognition.classifier, or no such key",
    })
}

/// Writes the parameters as keys of a table, in the order of their declaration.
impl Serialize for ClassifierParameters {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(declared().filter_map(|one| self.0.get_key_value(one.key)))
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
            let number = match parameter.is_integer {
                true => usize::schema(),
                false => f64::schema(),
            };
            let default = match parameter.default {
                DefaultValue::Number(default) => default.to_string(),
                DefaultValue::Rule(rule, meaning) => format!("'{rule}', {meaning}"),
            };
            let words = format!("{}. Default: {default}.", sentence(parameter.words));
            let range = Range::Declared(parameter);
            let mut key = key_schema(number, Some(range), &[&words]);
            if let Some(default) = range.declared_default() {
                key["default"] = json!(default);
            }
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
            let range = Range::Declared(parameter);
            KeyAbout {
                acts: Some(OF_CLASSIFIER),
                ..KeyAbout::new(path, AxisPlace::Axes, Role::Choice, range)
            }
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
            true => number_value(map.next_value::<usize>()? as f64, true),
            false => number_value(map.next_value()?, false),
        };
        slot.get_or_insert_default().0.insert(name, value);
        Ok(())
    }
}
