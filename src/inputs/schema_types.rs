//! JSON Schemas of types from crates that do not depend on `schemars`.

use bubbletouch_sim::features::{Features, ImageFeature};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::DeserializeOwned;
use serde::de::value::StrDeserializer;
use std::any::type_name;
use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

/// JSON schema of an enum whose file format is the name of a variant.
pub struct Names<T>(PhantomData<T>);

impl<T: DeserializeOwned> JsonSchema for Names<T> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        type_name::<T>().replace("::", ".").into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "string", "enum": names::<T>() })
    }
}

/// Returns the names of all variants of an enum type. The enum's deserialiser lists them in the error for an unknown name.
pub fn names<T: DeserializeOwned>() -> &'static [&'static str] {
    let found = T::deserialize(StrDeserializer::<Expected>::new("?"));
    found.err().map_or(&[], |Expected(names)| names)
}

/// Deserialisation error that contains the list of accepted names.
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

/// Returns the keys that `T` accepts in the innermost table of `probe`, in the order of their declaration. This table contains the single key `?`. Returns no
/// keys if the table accepts any key.
pub fn accepted_keys<T: DeserializeOwned>(probe: toml::Value) -> Vec<String> {
    let error = T::deserialize(probe).err();
    let message = error.as_ref().map_or("", toml::de::Error::message);
    let names = match message.split_once(", expected ") {
        Some((start, names)) if start.contains("unknown field `?`") => names,
        _ => "",
    };
    let names = names.split('`').skip(1).step_by(2);
    names.map(str::to_owned).collect()
}

/// JSON schema of [`Features`]: a single name, or several names of image features joined by `+`.
pub struct FeatureNames;

impl JsonSchema for FeatureNames {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "FeatureNames".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let of_measurements = [
            Features::Raw,
            Features::Centred,
            Features::UnitNorm,
            Features::CentredUnitNorm,
        ];
        let of_images: Vec<&str> = ImageFeature::ALL.iter().map(|one| one.name()).collect();
        let one = of_images.join("|");
        let names = of_measurements.map(String::from).into_iter();
        let names: Vec<String> = names
            .chain(of_images.into_iter().map(str::to_owned))
            .collect();
        json_schema!({
            "anyOf": [
                { "type": "string", "enum": names },
                { "title": "several image features joined by `+`", "type": "string", "pattern": format!(r"^\s*({one})\s*(\+\s*({one})\s*)+$") },
            ]
        })
    }
}
