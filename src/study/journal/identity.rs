//! What a study's results depend on.

use crate::error::{Error, Result};
use crate::toml_text;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Everything that decides the bytes of a study's tables.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Program and version.
    pub program: String,
    /// Hash of the program's sources.
    pub source: String,
    /// The study with every default spelt out, as TOML.
    pub study: String,
    /// SHA-256 of what each object is made of, by its name.
    pub objects: BTreeMap<String, String>,
}

impl Identity {
    /// Of a study as it is written out, for this program.
    pub fn new(study: String, objects: BTreeMap<String, String>) -> Self {
        Self {
            program: crate::study::provenance::PROGRAM.to_owned(),
            source: crate::study::provenance::SOURCE.to_owned(),
            study,
            objects,
        }
    }

    /// What another one has that this one has not, and the reverse, a line each.
    pub fn differences(&self, other: &Self) -> Vec<String> {
        let mut lines = Vec::new();
        let parts = [
            ("program", &self.program, &other.program),
            ("program's sources", &self.source, &other.source),
        ];
        for (name, ours, theirs) in parts {
            lines.extend(changed(name, Some(ours), Some(theirs)));
        }
        let (ours, theirs) = (keys(&self.study), keys(&other.study));
        lines.extend(all_changed("", &ours, &theirs));
        lines.extend(all_changed("object ", &self.objects, &other.objects));
        lines
    }

    /// An error that says what differs unless the other is the same; `place` is where this one stands.
    pub fn check_same(&self, other: &Self, place: &str) -> Result<()> {
        if self == other {
            return Ok(());
        }
        let differences = self.differences(other);
        let given = match differences.is_empty() {
            true => "was begun with another study (it differs in its order only)".to_owned(),
            false => format!(
                "was begun with another study\n  {}",
                differences.join("\n  ")
            ),
        };
        Err(Error::input(
            place,
            given,
            "\n  to go on: the same study, objects and program; --fresh starts over and keeps the old results beside the new",
        ))
    }
}

fn all_changed(
    what: &str,
    ours: &BTreeMap<String, String>,
    theirs: &BTreeMap<String, String>,
) -> Vec<String> {
    let mut names: Vec<&String> = ours.keys().chain(theirs.keys()).collect();
    names.sort();
    names.dedup();
    let lines = names
        .into_iter()
        .filter_map(|name| changed(&format!("{what}{name}"), ours.get(name), theirs.get(name)));
    lines.collect()
}

fn changed(name: &str, ours: Option<&String>, theirs: Option<&String>) -> Option<String> {
    let words = |value: Option<&String>| value.map_or("nothing".to_owned(), String::clone);
    (ours != theirs).then(|| format!("{name}: was {}, is {}", words(ours), words(theirs)))
}

/// Every value of a TOML text by its dotted key.
fn keys(text: &str) -> BTreeMap<String, String> {
    let mut values = BTreeMap::new();
    if let Some(table) = toml_text::table(text) {
        add_keys("", &table, &mut values);
    }
    values
}

fn add_keys(prefix: &str, table: &toml::Table, values: &mut BTreeMap<String, String>) {
    for (key, value) in table {
        match value {
            toml::Value::Table(inner) => add_keys(&format!("{prefix}{key}."), inner, values),
            value => {
                values.insert(format!("{prefix}{key}"), value.to_string());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_differs_is_named_by_its_key_and_by_its_object() {
        let identity = |study: &str, objects: &[(&str, &str)]| {
            let objects = objects
                .iter()
                .map(|(name, hash)| (name.to_string(), hash.to_string()));
            Identity::new(study.to_owned(), objects.collect())
        };
        let old = identity(
            "seed = 1\n[skin]\npitch_mm = [1.0, 2.0]",
            &[("mug", "a1"), ("bowl", "b")],
        );
        let new = identity(
            "seed = 1\n[skin]\npitch_mm = 2.0\nstroke_mm = 5.0",
            &[("mug", "a2"), ("bowl", "b")],
        );
        let expected = [
            "skin.pitch_mm: was [1.0, 2.0], is 2.0",
            "skin.stroke_mm: was nothing, is 5.0",
            "object mug: was a1, is a2",
        ];
        assert_eq!(old.differences(&new), expected);
        assert!(old.check_same(&old.clone(), "x").is_ok());
        let said = old.check_same(&new, "results/x").unwrap_err();
        assert_eq!(said.exit_code(), 2);
        assert!(said.to_string().contains(expected[0]), "{said}");
    }
}
