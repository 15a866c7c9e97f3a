//! Parts of objects as written in object files, in millimetres and degrees.

use super::shape::Wording;
use super::{Part, Shape, Solid};
use crate::error::{Error, Result};
use crate::geometry::{Pose, rotation_from_rpy};
use crate::text::spelling::{known, nearest_names};
use crate::text::toml_text;
use glam::DVec3;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::ops::Range;
use toml::{Spanned, Table, Value};

/// Shapes of object files, with the keys of their lengths.
///
/// The key of a length is the name of the field of [`Shape`] and `_mm`. The corners of a profile are (diameter, height), as in a technical drawing.
const SHAPES: [(&str, &[&str]); 11] = [
    ("ball", &["diameter_mm"]),
    ("box", &["size_mm", "rounding_mm"]),
    ("cylinder", &["diameter_mm", "height_mm"]),
    ("capsule", &["diameter_mm", "length_mm"]),
    (
        "cone_frustum",
        &["bottom_diameter_mm", "top_diameter_mm", "height_mm"],
    ),
    ("torus", &["ring_diameter_mm", "tube_diameter_mm"]),
    (
        "tube",
        &["outer_diameter_mm", "inner_diameter_mm", "height_mm"],
    ),
    ("lathe", &["profile_mm"]),
    ("prism", &["outline_mm", "thickness_mm"]),
    ("hexagonal_prism", &["across_flats_mm", "height_mm"]),
    ("strand", &["points_mm", "diameters_mm"]),
];

/// Any number of entries of a list.
const ANY: usize = 0;

/// Keys of lengths whose value is no number: the numbers of entries of their nested lists, and words for messages.
const LISTS: [(&str, &[usize], &str); 5] = [
    ("size_mm", &[3], "three numbers"),
    ("profile_mm", &[ANY, 2], "a list of pairs of numbers"),
    ("outline_mm", &[ANY, 2], "a list of pairs of numbers"),
    ("points_mm", &[ANY, 3], "a list of points of three numbers"),
    ("diameters_mm", &[ANY], "a list of numbers"),
];

/// Keys of every part: its shape, the position of the shape's origin in the object's frame, and its rotation. The rotation is applied before the position: about
/// the object's fixed x axis, then y, then z (URDF's roll, pitch, yaw).
const COMMON: [&str; 3] = ["shape", "position_mm", "rotation_deg"];

/// Key of a length that may be missing.
const OPTIONAL: &str = "rounding_mm";

/// Length of one millimetre, metres.
const MM: f64 = 1e-3;

/// Part `[[object.part]]` or subtracted shape `[[object.subtract]]` of an object file: the values of its keys.
#[derive(Clone, Debug, Deserialize)]
#[serde(transparent)]
pub(super) struct WrittenPart(BTreeMap<String, Spanned<Value>>);

impl Solid {
    /// Returns the names of the shapes of object files, each with the keys of its lengths.
    pub fn written_shapes() -> impl Iterator<Item = (&'static str, &'static [&'static str])> {
        SHAPES.into_iter()
    }

    /// Reads a solid from the text of `[[part]]` tables, which have the keys of a [catalogue](super::Catalogue) file. The parts keep their written positions.
    ///
    /// # Errors
    /// If the text is invalid; errors begin with `place`.
    pub fn parse_parts(place: &str, text: &str) -> Result<Self> {
        #[derive(Deserialize)]
        struct Written {
            part: Vec<WrittenPart>,
        }
        let written: Written = toml_text::read(place, text)?;
        let parts = parts(&written.part, |number, _| format!("{place}, part {number}"));
        let solid = Self::new(parts?);
        solid.map_err(|error| error.under(format!("{place}: ")))
    }
}

/// Converts written parts and checks them. `place` returns the location of an error, given the number of the part, which counts from 1, and the position of the
/// wrong value in the file.
pub(super) fn parts(
    written: &[WrittenPart],
    place: impl Fn(usize, usize) -> String,
) -> Result<Vec<Part>> {
    let numbered = written.iter().zip(1..);
    let part = |(part, number): (&WrittenPart, usize)| {
        part.part().map_err(|error| match error {
            Error::Input {
                place: key,
                given,
                allowed,
            } => {
                let shape = part.text("shape").map(|name| format!(" ({name})"));
                let place = place(number, part.range(&key).start);
                let equals = if given.parse::<f64>().is_ok() {
                    " ="
                } else {
                    ":"
                };
                Error::input(
                    format!("{place}{}", shape.unwrap_or_default()),
                    format!("{key}{equals} {given}"),
                    allowed,
                )
            }
            other => other,
        })
    };
    numbered.map(part).collect()
}

impl WrittenPart {
    /// Converts the part from millimetres to metres and checks it. The location of an error is a key.
    fn part(&self) -> Result<Part> {
        let name = self.text("shape");
        let name = name.ok_or_else(|| Error::input("shape", "missing", "the name of a shape"))?;
        let (_, keys) = SHAPES[known("shape", name, SHAPES.map(|(name, _)| name))?];
        let is_extra = |key: &&String| !COMMON.iter().chain(keys).any(|known| known == key);
        if let Some(key) = self.0.keys().find(is_extra) {
            let given = format!("given for a {name}");
            let allowed = nearest_names(key, keys.iter().chain(&COMMON).copied());
            return Err(Error::input(key, given, allowed));
        }
        let is_missing = |key: &&&str| **key != OPTIONAL && !self.0.contains_key(**key);
        if let Some(key) = keys.iter().find(is_missing) {
            let allowed = "a value for each length of the shape";
            return Err(Error::input(key, "missing", allowed));
        }
        let given = keys.iter().filter_map(|key| self.0.get_key_value(*key));
        for (key, value) in given {
            let list = LISTS.iter().find(|(list, ..)| list == key);
            let (lengths, allowed) = list.map_or((&[][..], "a number"), |it| (it.1, it.2));
            if !has_form(value.get_ref(), lengths) {
                return Err(Error::input(key, value.get_ref(), allowed));
            }
        }
        let [position, rotation] = [COMMON[1], COMMON[2]].map(|key| match self.0.get(key) {
            Some(value) => {
                let vector = <[f64; 3]>::deserialize(value.get_ref().clone())
                    .ok()
                    .map(DVec3::from);
                let vector = vector.filter(|vector| vector.is_finite());
                vector.ok_or_else(|| Error::input(key, value.get_ref(), "three finite numbers"))
            }
            None => Ok(DVec3::ZERO),
        });
        let pose = Pose::new(
            rotation_from_rpy(rotation?.map(f64::to_radians)),
            position? * MM,
        );
        self.shape(1.0)?.check_worded(Wording::MILLIMETRE_KEYS)?;
        Part::new(self.shape(MM)?, pose)
    }

    /// Returns the shape with its lengths multiplied by `unit`.
    fn shape(&self, unit: f64) -> Result<Shape> {
        let field = |(key, value): (&String, &Spanned<Value>)| {
            let name = key.strip_suffix("_mm").unwrap_or(key);
            (name.to_owned(), scaled(value.get_ref(), unit))
        };
        let table: Table = self.0.iter().map(field).collect();
        let shape = Shape::deserialize(Value::Table(table));
        let mut shape = shape.map_err(|error| Error::input("shape", error.message(), "a shape"))?;
        if let Shape::Lathe { profile } = &mut shape {
            profile.iter_mut().for_each(|corner| corner.x *= 0.5);
        }
        Ok(shape)
    }

    /// Returns the text of a key, if its value is a text.
    fn text(&self, key: &str) -> Option<&str> {
        self.0.get(key)?.get_ref().as_str()
    }

    /// Returns the byte range of the value of `key` in the file, or the range of the name of the shape if the key is missing.
    fn range(&self, key: &str) -> Range<usize> {
        let value = self.0.get(key).or_else(|| self.0.get("shape"));
        value.map_or(0..0, Spanned::span)
    }
}

/// Returns a value in which all numbers are multiplied by `unit`.
fn scaled(value: &Value, unit: f64) -> Value {
    match value {
        Value::Integer(number) => Value::Float(*number as f64 * unit),
        Value::Float(number) => Value::Float(number * unit),
        Value::Array(list) => Value::Array(list.iter().map(|value| scaled(value, unit)).collect()),
        other => other.clone(),
    }
}

/// Returns whether a value is a number or, if there are `lengths`, nested lists of numbers with these numbers of entries.
fn has_form(value: &Value, lengths: &[usize]) -> bool {
    match (value, lengths) {
        (Value::Integer(_) | Value::Float(_), []) => true,
        (Value::Array(list), [length, inner @ ..]) => {
            (*length == ANY || *length == list.len())
                && list.iter().all(|entry| has_form(entry, inner))
        }
        _ => false,
    }
}
