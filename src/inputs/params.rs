//! Declarations of the keys of files: one declaration for each key.
//!
//! [`params!`](params) declares a table: for each key its meaning, type, default, range, role and place among the axes. The struct, its reader, the checks, the
//! columns, the JSON Schema and the reference page follow from the declaration. [`words!`](words) declares an enum by its words, and `variants!` a
//! value that has several forms.

use crate::engine::axis::Axis;
use crate::files::{FilePath, SetName, file_path};
use crate::inputs::check::Check;
use crate::inputs::doc_comment::plain;
use crate::inputs::keys::{AxisPlace, KeyAbout};
use crate::inputs::range::Range;
use serde::de::value::StrDeserializer;
use serde::de::{DeserializeOwned, DeserializeSeed, Deserializer, MapAccess};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use std::any::TypeId;
use std::collections::BTreeMap;
use std::fmt::{self, Display};
use std::marker::PhantomData;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

/// Type of the value of a key.
pub trait Described: DeserializeOwned + 'static {
    /// Reads a value.
    ///
    /// # Errors
    /// If the value has another type.
    fn read<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Self::deserialize(deserializer)
    }

    /// Whether a list may be a value.
    const TAKES_LIST: bool = false;

    /// Returns the JSON Schema of the values.
    fn schema() -> Value;

    /// Returns whether a list in the table of a key of this type is an axis, given the place of the key's axis.
    fn is_swept_in_table(place: AxisPlace) -> bool {
        place == AxisPlace::Table && !Self::TAKES_LIST
    }

    /// Returns the value of a key without default that is not given; `None` if such a key is required.
    fn absent() -> Option<Self> {
        None
    }

    /// Checks the numbers of the value of `key`, and those of the tables in it, against their declared ranges. Without a range, numbers are finite.
    ///
    /// # Errors
    /// If a number is out of its range; the error names the file and the key.
    fn check(&self, _check: &Check, _key: &str, _range: Option<Range>) -> crate::Result<()> {
        Ok(())
    }

    /// Returns the range of a key of the table, given the key's name; `None` for other names, for keys without a range, and for values other than tables.
    fn range(_key: &str) -> Option<Range> {
        None
    }

    /// Returns the key of the value as an entry of the list `key`, given its number from 1.
    fn entry(&self, key: &str, _number: usize) -> String {
        key.to_owned()
    }

    /// Adds the descriptions of the keys of a table, given its path; nothing for other values.
    fn describe_keys(_path: &str, _keys: &mut Vec<KeyAbout>) {}

    /// Returns the keys that the value takes from the table around it; empty for the value of a key.
    fn inner_names() -> &'static [&'static str] {
        &[]
    }

    /// Reads one of the keys that the value takes from the table around it.
    ///
    /// # Errors
    /// If the value of the key has another type.
    fn read_inner<'de, M: MapAccess<'de>>(
        _slot: &mut Option<Self>,
        _name: &'static str,
        map: &mut M,
    ) -> Result<(), M::Error> {
        map.next_value()
    }
}

/// Reads the value of a key by [`Described::read`].
#[doc(hidden)]
pub struct ValueOf<T>(PhantomData<T>);

impl<T> Default for ValueOf<T> {
    fn default() -> Self {
        Self(PhantomData)
    }
}

impl<'de, T: Described> DeserializeSeed<'de> for ValueOf<T> {
    type Value = T;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<T, D::Error> {
        T::read(deserializer)
    }
}

/// Declares a table of keys. Each line has the meaning, the name and the type of a key, its default, and behind `=>` its range, its role in result tables, the
/// place at which it may have a list of values, and other fields of [`KeyAbout`]. A table inside the table has no `=>`. A key without a default is required,
/// unless its type is an `Option`. The part `unread` lists fields that the file does not set.
#[macro_export]
macro_rules! params {
    (
        $(#[doc = $about:literal])+
        $(#[derive($($derive:ident),*)])?
        pub struct $name:ident {
            $(
                $(#[doc = $doc:literal])+
                $(#[serde($($serde:tt)*)])?
                $key:ident: $type:ty $(= $default:expr)? $(=> $range:expr $(, $role:ident, $place:ident $(, $field:ident: $value:expr)*)?)?;
            )*
        }
        $(unread { $($(#[doc = $unread_doc:literal])+ $unread:ident: $unread_type:ty;)* })?
    ) => {
        $(#[doc = $about])+
        #[derive(Clone, Debug, PartialEq, $crate::serde::Serialize $($(, $derive)*)?)]
        #[serde(crate = "bubbletouch::serde")]
        pub struct $name {
            $($(#[doc = $doc])+ $(#[serde($($serde)*)])? pub $key: $type,)*
            $($($(#[doc = $unread_doc])+ #[serde(skip)] pub $unread: $unread_type,)*)?
        }

        impl<'de> $crate::serde::Deserialize<'de> for $name {
            fn deserialize<D: $crate::serde::Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
                use $crate::inputs::params::{KeyName, ValueOf, required};
                struct Keys;
                impl<'de> $crate::serde::de::Visitor<'de> for Keys {
                    type Value = $name;
                    fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
                        f.write_str(concat!("struct ", stringify!($name)))
                    }
                    fn visit_map<M: $crate::serde::de::MapAccess<'de>>(self, mut map: M) -> std::result::Result<$name, M::Error> {
                        $(let mut $key: Option<$type> = None;)*
                        while let Some(name) = map.next_key_seed(KeyName($name::names()))? {
                            $(
                                if <$type as $crate::inputs::params::Described>::inner_names().contains(&name) {
                                    <$type as $crate::inputs::params::Described>::read_inner(&mut $key, name, &mut map)?;
                                    continue;
                                }
                                if name == stringify!($key) {
                                    $key = Some(map.next_value_seed(ValueOf::default())?);
                                    continue;
                                }
                            )*
                        }
                        Ok($name {
                            $($key: match $key {
                                Some(value) => value,
                                None => required(stringify!($key), $crate::params!(@default $type $(, $default)?))?,
                            },)*
                            $($($unread: Default::default(),)*)?
                        })
                    }
                }
                deserializer.deserialize_map(Keys)
            }
        }

        impl $name {
            /// Returns the names of all keys of the table, in the order of their declaration.
            fn names() -> &'static [&'static str] {
                use $crate::inputs::params::own_or_inner;
                static NAMES: std::sync::LazyLock<Vec<&str>> = std::sync::LazyLock::new(|| {
                    [$(own_or_inner(stringify!($key), <$type as $crate::inputs::params::Described>::inner_names())),*].concat()
                });
                &NAMES
            }
        }

        impl $crate::inputs::params::Described for $name {
            fn schema() -> $crate::serde_json::Value {
                use $crate::inputs::params::TableSchema;
                let mut table = TableSchema::new(&[$($about),+]);
                $(table.add::<$type>(
                    stringify!($key),
                    &[$($doc),+],
                    $crate::params!(@range $($range)?),
                    $crate::params!(@default $type $(, $default)?),
                    $crate::params!(@swept $type $($(, $place)?)?),
                );)*
                table.schema()
            }

            fn check(
                &self,
                check: &$crate::studies::prelude::Check,
                key: &str,
                _range: Option<$crate::inputs::range::Range>,
            ) -> $crate::Result<()> {
                use $crate::inputs::params::{Described, joined};
                $(Described::check(&self.$key, check, &joined(key, stringify!($key)), $crate::params!(@range $($range)?))?;)*
                Ok(())
            }

            fn range(key: &str) -> Option<$crate::inputs::range::Range> {
                match key {
                    $(stringify!($key) => $crate::params!(@range $($range)?),)*
                    _ => None,
                }
            }

            fn entry(&self, key: &str, number: usize) -> String {
                $crate::params!(@entry self, key, number, $($key)*)
            }

            fn describe_keys(path: &str, keys: &mut Vec<$crate::inputs::keys::KeyAbout>) {
                let _ = (path, &keys);
                $($crate::params!(@about $type, path, stringify!($key), keys, [$($default)?] $(, $range $(, $role, $place $(, $field: $value)*)?)?);)*
            }
        }
    };
    (@default $type:ty) => { <$type as $crate::inputs::params::Described>::absent() };
    (@default $type:ty, $default:expr) => { Some::<$type>($default) };
    (@entry $table:ident, $key:ident, $number:ident, name $($other:ident)*) => { { let _ = $number; format!("{}.{}", $key, $table.name) } };
    (@entry $table:ident, $key:ident, $number:ident, $($other:ident)*) => { format!("{}[{}]", $key, $number) };
    (@swept $type:ty) => { false };
    (@swept $type:ty, $place:ident) => { <$type as $crate::inputs::params::Described>::is_swept_in_table($crate::inputs::keys::AxisPlace::$place) };
    (@range) => { None };
    (@range $range:expr) => { Some($range) };
    (@about $type:ty, $path:ident, $name:expr, $keys:ident, [$($default:expr)?]) => {
        <$type as $crate::inputs::params::Described>::describe_keys(&$crate::inputs::params::joined($path, $name), $keys);
    };
    (@about $type:ty, $path:ident, $name:expr, $keys:ident, [$($default:expr)?], $range:expr) => {};
    (@about $type:ty, $path:ident, $name:expr, $keys:ident, [$($default:expr)?], $range:expr, $role:ident, $place:ident $(, $field:ident: $value:expr)*) => {
        $keys.push($crate::inputs::keys::KeyAbout {
            $(usual: Some(|| $crate::inputs::params::usual_of::<$type>($default)),)?
            $($field: Some($value),)*
            is_swept_in_table: $crate::params!(@swept $type, $place),
            ..$crate::inputs::keys::KeyAbout::new(
                $crate::inputs::params::joined($path, $name).leak(),
                $crate::inputs::keys::AxisPlace::$place,
                $crate::table::Role::$role,
                $range,
            )
        });
    };
}
pub use crate::params;

/// Declares an enum whose values are words: each variant with its meaning and its word.
#[macro_export]
macro_rules! words {
    (
        $(#[doc = $about:literal])+
        pub enum $name:ident $(= $default:ident)? {
            $($(#[doc = $doc:literal])+ $variant:ident = $word:literal),* $(,)?
        }
    ) => {
        $(#[doc = $about])+
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, $crate::serde::Serialize, $crate::serde::Deserialize)]
        #[serde(crate = "bubbletouch::serde")]
        pub enum $name {
            $($(#[doc = $doc])+ #[serde(rename = $word)] $variant,)*
        }

        impl $name {
            /// Returns the word in files.
            pub const fn word(self) -> &'static str {
                match self {
                    $(Self::$variant => $word,)*
                }
            }
        }

        $(impl Default for $name {
            fn default() -> Self {
                Self::$default
            }
        })?

        impl $crate::inputs::params::Described for $name {
            fn schema() -> $crate::serde_json::Value {
                use $crate::inputs::params::{described, meaning};
                let words = [$(($word, meaning(&[$($doc),+]))),*];
                let words = words.map(|(word, meaning)| $crate::serde_json::json!({ "type": "string", "const": word, "description": meaning }));
                described($crate::serde_json::json!({ "oneOf": words }), &[$($about),+])
            }
        }
    };
}
pub use crate::words;

/// Declares a value that has one of several forms: tables with a single key each, or, if `untagged`, values of different types.
macro_rules! variants {
    (
        $(#[doc = $about:literal])+
        pub enum $name:ident {
            $($(#[doc = $doc:literal])+ $variant:ident = $word:literal ($type:ty)),* $(,)?
        }
    ) => {
        $(#[doc = $about])+
        #[derive(Clone, Debug, PartialEq, $crate::serde::Serialize, $crate::serde::Deserialize)]
        pub enum $name {
            $($(#[doc = $doc])+ #[serde(rename = $word)] $variant($type),)*
        }

        impl $crate::inputs::params::Described for $name {
            fn schema() -> $crate::serde_json::Value {
                use $crate::inputs::params::described;
                let forms = [$(described(
                    $crate::serde_json::json!({
                        "type": "object",
                        "properties": { $word: <$type as $crate::inputs::params::Described>::schema() },
                        "required": [$word],
                        "additionalProperties": false,
                    }),
                    &[$($doc),+],
                )),*];
                described($crate::serde_json::json!({ "oneOf": forms }), &[$($about),+])
            }

            fn check(&self, check: &$crate::inputs::check::Check, key: &str, _range: Option<$crate::inputs::range::Range>) -> $crate::Result<()> {
                match self {
                    $(Self::$variant(value) => $crate::inputs::params::Described::check(value, check, &$crate::inputs::params::joined(key, $word), None),)*
                }
            }
        }
    };
    (
        $(#[doc = $about:literal])+
        $(#[serde(expecting = $expecting:literal)])?
        pub untagged enum $name:ident $(titled $title:literal)? $(, $derive:ident)* {
            $($(#[doc = $doc:literal])+ $(#[serde($($serde:tt)*)])? $variant:ident($type:ty)),* $(,)?
        }
    ) => {
        $(#[doc = $about])+
        #[derive(Clone, Debug, PartialEq, $crate::serde::Serialize $(, $crate::serde::$derive)*)]
        #[serde(untagged $(, expecting = $expecting)?)]
        pub enum $name {
            $($(#[doc = $doc])+ $(#[serde($($serde)*)])? $variant($type),)*
        }

        impl $crate::inputs::params::Described for $name {
            fn schema() -> $crate::serde_json::Value {
                use $crate::inputs::params::described;
                let forms = [$(described(<$type as $crate::inputs::params::Described>::schema(), &[$($doc),+])),*];
                let forms = $crate::serde_json::json!({ "anyOf": forms $(, "title": $title)? });
                described(forms, &[$($about),+])
            }

            fn check(&self, check: &$crate::inputs::check::Check, key: &str, range: Option<$crate::inputs::range::Range>) -> $crate::Result<()> {
                match self {
                    $(Self::$variant(value) => $crate::inputs::params::Described::check(value, check, key, range),)*
                }
            }
        }
    };
}
pub(crate) use variants;

/// Implements [`Described`] for enums of the other crates, whose values are words.
macro_rules! named {
    ($($type:ty),* $(,)?) => {
        $(impl $crate::inputs::params::Described for $type {
            fn schema() -> serde_json::Value {
                serde_json::json!({ "type": "string", "enum": $crate::inputs::params::names::<Self>() })
            }
        })*
    };
}
pub(crate) use named;

/// Returns whether a value is the default of its type, so that files omit it.
pub(crate) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// Returns the path of a key, given the path of its table.
#[doc(hidden)]
pub fn joined(path: &str, name: &str) -> String {
    match path {
        "" => name.to_owned(),
        path => format!("{path}.{name}"),
    }
}

/// Returns the names that a key adds to its table: those that its value takes from the table, or its own.
#[doc(hidden)]
pub fn own_or_inner(name: &'static str, inner: &'static [&'static str]) -> Vec<&'static str> {
    match inner.is_empty() {
        true => vec![name],
        false => inner.to_vec(),
    }
}

/// Returns the value of a key that is not given.
///
/// # Errors
/// If the key is required.
#[doc(hidden)]
pub fn required<T, E: serde::de::Error>(name: &'static str, absent: Option<T>) -> Result<T, E> {
    absent.ok_or_else(|| E::missing_field(name))
}

/// Returns a default as a value of a file.
///
/// # Panics
/// If the default has no TOML form.
#[doc(hidden)]
pub fn usual_of<T: serde::Serialize>(default: T) -> toml::Value {
    toml::Value::try_from(default).expect("a default has a TOML form")
}

/// Returns the table without a given key.
///
/// # Panics
/// If a key of the table is required.
pub(crate) fn empty_table<T: DeserializeOwned>() -> T {
    let empty = toml::Table::new();
    empty.try_into().expect("all keys have defaults")
}

/// Returns the descriptions of all keys of a file.
pub fn keys_of<T: Described>() -> &'static [KeyAbout] {
    static KNOWN: Mutex<BTreeMap<TypeId, &[KeyAbout]>> = Mutex::new(BTreeMap::new());
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    known.entry(TypeId::of::<T>()).or_insert_with(|| {
        let mut keys = Vec::new();
        T::describe_keys("", &mut keys);
        keys.leak()
    })
}

/// Reads the name of a key, one of the given names.
#[doc(hidden)]
pub struct KeyName<'n>(pub &'n [&'static str]);

impl<'de> DeserializeSeed<'de> for KeyName<'_> {
    type Value = &'static str;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<&'static str, D::Error> {
        let given = String::deserialize(deserializer)?;
        let found = self.0.iter().copied().find(|name| *name == given);
        found.ok_or_else(|| serde::de::Error::custom(unknown("field", &given, self.0)))
    }
}

/// Returns the message of an unknown key or word, as serde words it.
pub(crate) fn unknown(what: &str, given: &str, known: &[impl Display]) -> String {
    let known: Vec<String> = known.iter().map(|name| format!("`{name}`")).collect();
    let expected = match &known[..] {
        [] => return format!("unknown {what} `{given}`, there are no {what}s"),
        [one] => one.clone(),
        [one, other] => format!("{one} or {other}"),
        all => format!("one of {}", all.join(", ")),
    };
    format!("unknown {what} `{given}`, expected {expected}")
}

/// Returns the names of all variants of an enum type. The enum's deserialiser lists them in the error for an unknown name.
pub(crate) fn names<T: DeserializeOwned>() -> &'static [&'static str] {
    /// Error that contains the list of accepted names.
    #[derive(Debug)]
    struct Expected(&'static [&'static str]);
    impl fmt::Display for Expected {
        fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
            write!(f, "one of {}", self.0.join(", "))
        }
    }
    impl std::error::Error for Expected {}
    impl serde::de::Error for Expected {
        fn custom<T: fmt::Display>(_: T) -> Self {
            Self(&[])
        }
        fn unknown_variant(_: &str, expected: &'static [&'static str]) -> Self {
            Self(expected)
        }
    }
    let found = T::deserialize(StrDeserializer::<Expected>::new("?"));
    found.err().map_or(&[], |Expected(names)| names)
}

/// Returns a text with a capital first letter.
pub(crate) fn sentence(words: &str) -> String {
    let mut letters = words.chars();
    let first = letters.next().map(|first| first.to_uppercase().to_string());
    first.unwrap_or_default() + letters.as_str()
}

/// Returns the text of a doc comment, given its lines.
#[doc(hidden)]
pub fn meaning(lines: &[&str]) -> String {
    plain(&lines.join("\n"))
}

/// Adds the text of a doc comment to a schema.
#[doc(hidden)]
pub fn described(mut schema: Value, lines: &[&str]) -> Value {
    schema["description"] = meaning(lines).into();
    schema
}

/// Keyword of a schema that lists the keys of a table in the order of their declaration.
pub(crate) const ORDER: &str = "x-order";

/// JSON Schema of a table, to which keys are added.
#[doc(hidden)]
pub struct TableSchema {
    about: String,
    keys: Map<String, Value>,
    order: Vec<&'static str>,
    required: Vec<&'static str>,
}

impl TableSchema {
    pub fn new(about: &[&str]) -> Self {
        Self {
            about: meaning(about),
            keys: Map::new(),
            order: Vec::new(),
            required: Vec::new(),
        }
    }

    /// Adds a key: its name, doc comment, range, the value that it has if it is not given, and whether it may have a list of values instead.
    pub fn add<T: Described + Serialize>(
        &mut self,
        name: &'static str,
        lines: &[&str],
        range: Option<Range>,
        absent: Option<T>,
        is_swept: bool,
    ) {
        let mut schema = T::schema();
        if is_swept {
            schema = one_or_list(schema);
        }
        self.order.extend(own_or_inner(name, T::inner_names()));
        if !T::inner_names().is_empty() {
            let inner = schema["properties"].take();
            self.keys
                .extend(inner.as_object().cloned().unwrap_or_default());
            return;
        }
        schema = key_schema(schema, range, lines);
        match absent {
            None => self.required.push(name),
            Some(value) => {
                // A key that is absent by default has no TOML form.
                let value = toml::Value::try_from(value).ok();
                if let Some(value) = value.filter(|value| !is_empty(value)) {
                    schema["default"] = json!(value);
                }
            }
        }
        self.keys.insert(name.to_owned(), schema);
    }

    pub fn schema(self) -> Value {
        let mut schema = json!({
            "type": "object",
            "description": self.about,
            "properties": self.keys,
            "additionalProperties": false,
            ORDER: self.order,
        });
        if !self.required.is_empty() {
            schema["required"] = json!(self.required);
        }
        schema
    }
}

/// Returns the schema of one value or a list of values to sweep, given the schema of a value.
fn one_or_list(one: Value) -> Value {
    json!({ "anyOf": [one, { "type": "array", "items": one, "minItems": 1, "uniqueItems": true }] })
}

/// Returns the schema of a key, given the schema of its values, its range and its doc comment.
pub(crate) fn key_schema(mut values: Value, range: Option<Range>, lines: &[&str]) -> Value {
    if let Some(range) = range {
        bound(&mut values, &range.keywords());
    }
    described(values, lines)
}

/// Returns whether a value is an empty text, an empty list or an empty table.
fn is_empty(value: &toml::Value) -> bool {
    match value {
        toml::Value::String(text) => text.is_empty(),
        toml::Value::Array(values) => values.is_empty(),
        toml::Value::Table(keys) => keys.is_empty(),
        _ => false,
    }
}

/// Adds the bounds of the allowed numbers to the schema of a key: to single numbers, and to the numbers of lists.
fn bound(schema: &mut Value, bounds: &Map<String, Value>) {
    match schema["type"].as_str() {
        Some("number" | "integer") => {
            if let Some(keywords) = schema.as_object_mut() {
                keywords.extend(bounds.clone());
            }
        }
        Some("array") if schema.get("items").is_some() => bound(&mut schema["items"], bounds),
        _ => {
            let choices = schema.get_mut("anyOf").and_then(Value::as_array_mut);
            for choice in choices.into_iter().flatten() {
                bound(choice, bounds);
            }
        }
    }
}

/// Implements [`Described`] for types with a fixed schema.
macro_rules! simple {
    ($($type:ty: $schema:tt;)*) => {
        $(impl Described for $type {
            fn schema() -> Value {
                json!($schema)
            }
        })*
    };
}

/// Implements [`Described`] for types of numbers.
macro_rules! number {
    ($($type:ty: $schema:tt;)*) => {
        $(impl Described for $type {
            fn schema() -> Value {
                json!($schema)
            }

            fn check(&self, check: &Check, key: &str, range: Option<Range>) -> crate::Result<()> {
                let range = range.unwrap_or(Range::Finite);
                match range.contains(*self as f64) {
                    true => Ok(()),
                    false => Err(check.error(key, self, range.words())),
                }
            }

            fn entry(&self, key: &str, number: usize) -> String {
                format!("{key}, number {number}")
            }
        })*
    };
}

number! {
    f64: { "type": "number" };
    usize: { "type": "integer", "minimum": 0 };
    u64: { "type": "integer", "minimum": 0 };
}

simple! {
    bool: { "type": "boolean" };
    String: { "type": "string" };
    FilePath: { "type": "string" };
    SetName: { "type": "string" };
    toml::Table: { "type": "object", "additionalProperties": true };
}

/// Path that is relative to the folder of its file.
impl Described for PathBuf {
    fn read<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        file_path(deserializer)
    }

    fn schema() -> Value {
        String::schema()
    }
}

impl<T: Described> Described for Option<T> {
    const TAKES_LIST: bool = T::TAKES_LIST;

    fn read<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        T::read(deserializer).map(Some)
    }

    fn schema() -> Value {
        T::schema()
    }

    fn absent() -> Option<Self> {
        Some(None)
    }

    fn check(&self, check: &Check, key: &str, range: Option<Range>) -> crate::Result<()> {
        let check_one = |value: &T| value.check(check, key, range);
        self.as_ref().map_or(Ok(()), check_one)
    }

    fn describe_keys(path: &str, keys: &mut Vec<KeyAbout>) {
        T::describe_keys(path, keys);
    }
}

impl<T: Described> Described for Box<T> {
    const TAKES_LIST: bool = T::TAKES_LIST;

    fn schema() -> Value {
        T::schema()
    }

    fn check(&self, check: &Check, key: &str, range: Option<Range>) -> crate::Result<()> {
        T::check(self, check, key, range)
    }
}

impl<T: Described> Described for Vec<T> {
    const TAKES_LIST: bool = true;

    fn schema() -> Value {
        json!({ "type": "array", "items": T::schema() })
    }

    fn check(&self, check: &Check, key: &str, range: Option<Range>) -> crate::Result<()> {
        let mut values = (1..).zip(self);
        values.try_for_each(|(number, value)| value.check(check, &value.entry(key, number), range))
    }

    fn describe_keys(path: &str, keys: &mut Vec<KeyAbout>) {
        T::describe_keys(path, keys);
    }
}

impl<T: Described, const N: usize> Described for [T; N]
where
    [T; N]: DeserializeOwned,
{
    const TAKES_LIST: bool = true;

    fn schema() -> Value {
        json!({ "type": "array", "items": T::schema(), "minItems": N, "maxItems": N })
    }

    fn check(&self, check: &Check, key: &str, range: Option<Range>) -> crate::Result<()> {
        let mut values = self.iter();
        values.try_for_each(|value| value.check(check, key, range))
    }
}

impl<A: Described, B: Described> Described for (A, B) {
    fn schema() -> Value {
        json!({ "type": "array", "prefixItems": [A::schema(), B::schema()], "minItems": 2, "maxItems": 2 })
    }
}

impl<A: Described, B: Described, C: Described> Described for (A, B, C) {
    fn schema() -> Value {
        json!({ "type": "array", "prefixItems": [A::schema(), B::schema(), C::schema()], "minItems": 3, "maxItems": 3 })
    }
}

impl<T: Described> Described for BTreeMap<String, T> {
    fn schema() -> Value {
        json!({ "type": "object", "additionalProperties": T::schema() })
    }

    fn check(&self, check: &Check, key: &str, range: Option<Range>) -> crate::Result<()> {
        let mut values = self.iter();
        values.try_for_each(|(name, value)| value.check(check, &joined(key, name), range))
    }
}

impl<T: Described> Described for Axis<T> {
    const TAKES_LIST: bool = true;

    fn schema() -> Value {
        one_or_list(T::schema())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inputs::range::Range::{Any, Positive};

    params! {
        /// Table with every kind of key.
        pub struct Example {
            /// Length, mm. Default: 4.
            length_mm: f64 = 4.0 => Positive, Choice, Table, title: "size";
            /// Names.
            names: Option<Vec<String>> => Any, Condition, Never;
            /// Table `[inner]`.
            inner: Inner;
        }
        unread {
            /// Field that the file does not set.
            memory: usize;
        }
    }

    params! {
        /// Table inside the table.
        pub struct Inner {
            /// Form.
            form: Form = Form::Round => Any, Choice, Axes;
            /// Required count.
            n: usize;
        }
    }

    words! {
        /// Forms.
        pub enum Form {
            /// Like a ball.
            Round = "round",
            /// Like a box.
            Square = "square",
        }
    }

    #[test]
    fn a_declaration_is_reader_schema_and_list_of_keys() {
        let read = |text: &str| toml::from_str::<Example>(text);
        let found = read("[inner]\nform = \"square\"\nn = 2").unwrap();
        assert_eq!(
            (found.length_mm, &found.names, found.memory),
            (4.0, &None, 0)
        );
        assert_eq!((found.inner.form, found.inner.n), (Form::Square, 2));
        assert_eq!(found.inner.form.word(), "square");
        for (text, words) in [
            (
                "length_m = 1.0",
                "unknown field `length_m`, expected one of `length_mm`, `names`, `inner`",
            ),
            ("[inner]", "missing field `n`"),
            ("length_mm = 1.0", "missing field `inner`"),
            (
                "length_mm = \"a\"",
                "invalid type: string \"a\", expected f64",
            ),
            (
                "[inner]\nform = \"flat\"",
                "unknown variant `flat`, expected `round` or `square`",
            ),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(words), "{text}: {error}");
        }
        let keys: Vec<&str> = keys_of::<Example>().iter().map(|key| key.path).collect();
        assert_eq!(keys, ["length_mm", "names", "inner.form"]);
        assert_eq!(keys_of::<Example>()[0].title(), "size");
        let schema = Example::schema();
        assert_eq!(schema["required"], json!(["inner"]));
        let one = json!({ "type": "number", "exclusiveMinimum": 0 });
        let list = json!({ "type": "array", "items": one, "minItems": 1, "uniqueItems": true });
        let length = json!({ "anyOf": [one, list], "default": 4.0, "description": "Length, mm. Default: 4." });
        assert_eq!(schema["properties"]["length_mm"], length);
        assert_eq!(
            schema["properties"]["inner"]["properties"]["form"]["default"],
            "round"
        );
    }
}
