//! Keys of `[recognition]` that are declared by classifiers, such as `n_trees`.

use crate::learning::classifiers::classifier::Classifier;
use crate::learning::classifiers::parameters::{DefaultValue, Parameter, declared};
use schemars::Schema;
use serde::de::value::{Error as TextError, StringDeserializer};
use serde::de::{DeserializeSeed, Error as _, IntoDeserializer, MapAccess};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Value, json};
use std::collections::BTreeMap;

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
    /// Returns the default values of all parameters whose default is a number.
    pub(crate) fn usual() -> Self {
        let numbers = declared().filter_map(|one| Some((one.key, one.default_number()?)));
        Self(numbers.collect())
    }

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

/// Adds the parameters that classifiers declare to the JSON Schema of the table `[recognition]`.
pub(super) fn with_parameters(schema: &mut Schema) {
    let keys = schema.ensure_object().get_mut("properties");
    let Some(keys) = keys.and_then(Value::as_object_mut) else {
        return;
    };
    for parameter in declared() {
        let number = |value: f64| match parameter.is_integer {
            true => json!(value as u64),
            false => json!(value),
        };
        let mut words = parameter.words.chars();
        let first = words.next().map(|first| first.to_uppercase().to_string());
        let words = first.unwrap_or_default() + words.as_str();
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
        keys.insert(parameter.key.to_owned(), key);
    }
}

/// Reader of the table `[recognition]`: the parameters of classifiers are stored, and all other keys are passed on to the fields of the specification.
pub(super) struct OtherKeys<'a, M> {
    pub map: M,
    pub parameters: &'a mut ClassifierParameters,
}

impl<'de, M: MapAccess<'de>> MapAccess<'de> for OtherKeys<'_, M> {
    type Error = M::Error;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        field: K,
    ) -> Result<Option<K::Value>, M::Error> {
        let mut field = Some(field);
        loop {
            match self.map.next_key_seed(KeySeed(&mut field))? {
                None => return Ok(None),
                Some(Key::Field(field)) => return Ok(Some(field)),
                Some(Key::Parameter(parameter)) => {
                    let value = self.map.next_value_seed(ValueSeed(parameter))?;
                    self.parameters.0.insert(parameter.key, value);
                }
            }
        }
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, M::Error> {
        self.map.next_value_seed(seed)
    }
}

/// Key of the table `[recognition]`: a declared parameter of a classifier, or a field of the specification.
enum Key<F> {
    Parameter(&'static Parameter),
    Field(F),
}

/// Reader of a key of the table `[recognition]`. The inner seed reads the key of a field, and is used only if the key is no parameter.
struct KeySeed<'a, K>(&'a mut Option<K>);

impl<'de, K: DeserializeSeed<'de>> DeserializeSeed<'de> for KeySeed<'_, K> {
    type Value = Key<K::Value>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        let key = String::deserialize(deserializer)?;
        if let Some(parameter) = declared().find(|parameter| parameter.key == key) {
            return Ok(Key::Parameter(parameter));
        }
        let field = self.0.take().expect("a key is read once");
        let name: StringDeserializer<TextError> = key.into_deserializer();
        field.deserialize(name).map(Key::Field).map_err(|unknown| {
            let keys: Vec<String> = declared().map(|one| format!("`{}`", one.key)).collect();
            D::Error::custom(format!("{unknown}, {}", keys.join(", ")))
        })
    }
}

/// Reader of the value of a classifier's parameter: an integer or a floating-point number.
struct ValueSeed(&'static Parameter);

impl<'de> DeserializeSeed<'de> for ValueSeed {
    type Value = f64;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<f64, D::Error> {
        match self.0.is_integer {
            true => usize::deserialize(deserializer).map(|value| value as f64),
            false => f64::deserialize(deserializer),
        }
    }
}
