//! Catalogue of named objects, given as parametric solids with real dimensions.
//!
//! A catalogue file is a list of objects. Each object is a union of parts minus subtracted shapes; the guide lists all shapes and keys. For example:
//!
//! ```toml
//! [[object]]
//! name = "lollipop"
//! source = "measured with a ruler"
//!   [[object.part]]
//!   shape = "ball"
//!   diameter_mm = 30
//!   position_mm = [0, 0, 85]
//!   [[object.part]]
//!   shape = "cylinder"
//!   diameter_mm = 4
//!   height_mm = 70
//!   position_mm = [0, 0, 35]
//! ```
//!
//! After reading, each object is moved so that it rests on z = 0 with the middle of its bounding box on the z axis.

use super::solid_toml::{WrittenPart, parts};
use super::{Hand, Object, Solid, pack};
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::text::toml_lines::line_of;
use crate::text::toml_text;
use glam::DQuat;
use serde::Deserialize;
use std::collections::BTreeSet;
use toml::Spanned;

/// Built-in catalogue files: the name of each object set, and the text of its file.
const BUILTIN: [(&str, &str); 4] = [
    ("balls", include_str!("../../objects/balls.toml")),
    ("boxes", include_str!("../../objects/boxes.toml")),
    ("cans", include_str!("../../objects/cans.toml")),
    ("household", include_str!("../../objects/household.toml")),
];

/// Named objects in named sets. Invariant: object names are unique within a set, and every set has an object.
#[derive(Clone, Debug)]
pub struct Catalogue {
    entries: Vec<Entry>,
}

/// Object of a catalogue.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Name of the object set, such as `balls` or `household`.
    pub set: String,
    /// Name of the object, unique within its set.
    pub name: String,
    /// Source of the object's dimensions.
    pub source: String,
    /// Shape of the object, resting on z = 0 with the middle of its bounding box on the z axis.
    pub solid: Solid,
}

impl Entry {
    /// Packs the object's shape with spheres, with a distance between the surfaces of at most `surface_error` metres.
    ///
    /// # Errors
    /// If the packing fails, for example because the surface error is too small ([`pack`]).
    pub fn build(&self, surface_error: f64) -> Result<Object> {
        Ok(Object {
            name: self.name.clone(),
            model: pack(&self.solid, surface_error)?.into(),
            n_parts: self.solid.parts().len(),
        })
    }
}

impl Catalogue {
    /// Returns the built-in objects: 16 balls, 16 boxes, 9 cans, household objects, and hands.
    ///
    /// # Errors
    /// If a built-in file is invalid, which tests exclude.
    pub fn builtin() -> Result<Self> {
        let mut entries = Vec::new();
        for (set, text) in BUILTIN {
            entries.extend(Self::parse(set, &format!("objects/{set}.toml"), text)?.entries);
        }
        entries.extend(hands()?);
        Ok(Self { entries })
    }

    /// Reads one object set from the text of a catalogue file.
    ///
    /// # Errors
    /// If the text is invalid; errors begin with `place`, the name of the file.
    pub fn parse(set: &str, place: &str, text: &str) -> Result<Self> {
        let file: File = toml_text::read(place, text)?;
        if file.object.is_empty() {
            return Err(Error::input(place, "no objects", "at least one [[object]]"));
        }
        let mut names = BTreeSet::new();
        let mut entries = Vec::new();
        for object in file.object {
            if !names.insert(object.name.get_ref().clone()) {
                let given = "a name that an earlier object has";
                let place = object.place(place, text);
                return Err(Error::input(place, given, "a name of its own"));
            }
            entries.push(object.entry(set, place, text)?);
        }
        Ok(Self { entries })
    }

    /// Returns all objects, set by set, in the order of their files.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Returns the names of the object sets, in order.
    pub fn sets(&self) -> Vec<&str> {
        let mut sets: Vec<&str> = self.entries.iter().map(|e| e.set.as_str()).collect();
        sets.dedup();
        sets
    }

    /// Returns the objects of a set, in the order of its file.
    ///
    /// # Errors
    /// If the set does not exist; the error lists the existing sets.
    pub fn set(&self, set: &str) -> Result<Vec<&Entry>> {
        let entries: Vec<&Entry> = self.entries.iter().filter(|e| e.set == set).collect();
        if entries.is_empty() {
            let allowed = format!("one of {}", self.sets().join(", "));
            return Err(Error::input("object set", format!("`{set}`"), allowed));
        }
        Ok(entries)
    }

    /// Returns the object with this name, in any object set.
    ///
    /// # Errors
    /// If the object does not exist; the error suggests similar names.
    pub fn object(&self, name: &str) -> Result<&Entry> {
        if let Some(entry) = self.entries.iter().find(|e| e.name == name) {
            return Ok(entry);
        }
        let names = self.entries.iter().map(|e| e.name.as_str());
        let close: Vec<&str> = names.filter(|n| resemble(n, name)).collect();
        let allowed = match close.is_empty() {
            true => "a name that `bubbletouch objects` lists".to_string(),
            false => format!("perhaps {}", close.join(", ")),
        };
        Err(Error::input("object", format!("`{name}`"), allowed))
    }
}

/// Returns right hands of an average man in five poses, palm up, so that a patch that comes from above touches the palm.
fn hands() -> Result<Vec<Entry>> {
    let palm_up = Pose::from_rotation(DQuat::from_rotation_y(std::f64::consts::PI));
    let poses = [
        ("hand_flat", Hand::flat()),
        ("hand_spread", Hand::spread()),
        ("hand_relaxed", Hand::curled(0.25)),
        ("hand_pointing", Hand::pointing()),
        ("hand_fist", Hand::curled(1.0)),
    ];
    let entry = |(name, hand): (&str, Hand)| {
        Ok(Entry {
            set: "hands".to_owned(),
            name: name.to_owned(),
            source: "bones: Buryanov, Kotiuk 2010; breadths: our choice".to_owned(),
            solid: hand.solid()?.moved(&palm_up).resting(),
        })
    };
    poses.into_iter().map(entry).collect()
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    object: Vec<WrittenObject>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenObject {
    name: Spanned<String>,
    source: String,
    part: Vec<WrittenPart>,
    #[serde(default)]
    subtract: Vec<WrittenPart>,
}

impl WrittenObject {
    /// Formats the location `FILE, line LINE, object NAME`, with the line of the object's name.
    fn place(&self, place: &str, text: &str) -> String {
        let line = line_of(text, self.name.span().start);
        format!("{place}, line {line}, object `{}`", self.name.get_ref())
    }

    fn entry(self, set: &str, place: &str, text: &str) -> Result<Entry> {
        // Counting lines takes time for each object.
        let here = || self.place(place, text);
        let name = self.name.get_ref();
        if name.trim().is_empty() {
            return Err(Error::input(here(), "an empty name", "a name"));
        }
        let parts = |written: &[WrittenPart], kind: &str| {
            parts(written, |number, at| {
                let line = line_of(text, at);
                format!("{place}, line {line}, object `{name}`, {kind} {number}")
            })
        };
        let solid = Solid::new(parts(&self.part, "part")?);
        let cuts = parts(&self.subtract, "subtract")?;
        let solid = match cuts.is_empty() {
            true => solid,
            false => solid.and_then(|solid| solid.less(cuts)),
        };
        let solid = solid.map_err(|error| error.under(format!("{}: ", here())))?;
        Ok(Entry {
            set: set.to_string(),
            name: name.clone(),
            source: self.source,
            solid: solid.resting(),
        })
    }
}

/// Returns whether two names are similar: one contains the other, or their first three letters are equal.
fn resemble(a: &str, b: &str) -> bool {
    let (a, b) = (a.to_lowercase(), b.to_lowercase());
    let head = |s: &str| s.chars().take(3).collect::<String>();
    !b.is_empty() && (a.contains(&b) || b.contains(&a) || head(&a) == head(&b))
}
