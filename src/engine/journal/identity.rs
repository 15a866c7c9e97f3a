//! What a study's results depend on.

use crate::error::{Error, Result};
use crate::inputs::toml_value::is_at;
use crate::toml_text;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Everything that decides the bytes of a study's tables.
///
/// Two of them are the same study if they differ at most in keys that may change: axes that only say which work
/// there is, and words.
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
    /// Keys of the study, with all below them, that may change while it stays the same; unknown of one that was read.
    #[serde(skip)]
    may_change: &'static [&'static str],
}

impl Identity {
    /// Of a study as it is written out, for this program; some of its keys may change.
    pub fn new(
        study: String,
        objects: BTreeMap<String, String>,
        may_change: &'static [&'static str],
    ) -> Self {
        Self {
            program: crate::engine::program::PROGRAM.to_owned(),
            source: crate::engine::program::SOURCE.to_owned(),
            study,
            objects,
            may_change,
        }
    }

    /// What another one, of a study that is here, has that this one has not, and the reverse, a line each.
    pub fn differences(&self, other: &Self) -> Vec<String> {
        let [ours, theirs] = [self, other].map(|identity| identity.facts(other.may_change));
        let mut names: BTreeSet<&String> = ours.keys().chain(theirs.keys()).collect();
        names.retain(|name| ours.get(*name) != theirs.get(*name));
        let words = |value: Option<&String>| value.map_or("nothing".to_owned(), String::clone);
        let line = |name: &String| {
            let (was, is) = (words(ours.get(name)), words(theirs.get(name)));
            format!("{name}: was {was}, is {is}")
        };
        names.into_iter().map(line).collect()
    }

    /// Whether the other is the same study; `place` is where this one stands.
    ///
    /// # Errors
    /// It is not; the error says what differs.
    pub fn check_same(&self, other: &Self, place: &str) -> Result<()> {
        let differences = self.differences(other);
        if differences.is_empty() {
            return Ok(());
        }
        let differences = differences.join("\n  ");
        Err(Error::input(
            place,
            format!("was begun with another study\n  {differences}"),
            "\n  to go on: the same study, objects and program (axes may have more values or fewer, and words may change); --fresh starts over and keeps the old results beside the new",
        ))
    }

    /// All that counts, by name: of the study the values of its keys, but for those that may change.
    fn facts(&self, may_change: &[&str]) -> BTreeMap<String, String> {
        let mut facts = BTreeMap::new();
        if let Some(table) = toml_text::table(&self.study) {
            add_keys("", &table, &mut facts);
        }
        facts.retain(|key, _| !may_change.iter().any(|name| is_at(key, name)));
        facts.insert("program".to_owned(), self.program.clone());
        facts.insert("program's sources".to_owned(), self.source.clone());
        let objects = self.objects.iter();
        facts.extend(objects.map(|(name, hash)| (format!("object {name}"), hash.clone())));
        facts
    }
}

/// Every value of a table by its dotted key.
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
            Identity::new(study.to_owned(), objects.collect(), &["question"])
        };
        let old = identity(
            "question = \"a\"\nseed = 1\n[skin]\npitch_mm = [1.0, 2.0]\nstiffness_n_per_m = 100.0",
            &[("mug", "a1"), ("bowl", "b")],
        );
        let new = identity(
            "question = \"b\"\nseed = 1\n[skin]\npitch_mm = [1.0, 2.0]\nstiffness_n_per_m = 200.0\nstroke_mm = 5.0",
            &[("mug", "a2"), ("bowl", "b")],
        );
        let expected = [
            "object mug: was a1, is a2",
            "skin.stiffness_n_per_m: was 100.0, is 200.0",
            "skin.stroke_mm: was nothing, is 5.0",
        ];
        assert_eq!(old.differences(&new), expected);
        assert!(old.check_same(&old.clone(), "x").is_ok());
        let said = old.check_same(&new, "results/x").unwrap_err();
        assert_eq!(said.exit_code(), 2);
        assert!(said.to_string().contains(expected[0]), "{said}");
    }

    #[test]
    fn words_and_axes_of_a_study_leave_it_the_same() {
        let identity = |study: &str| {
            let may_change = &["question", "trials", "skin.pitch_mm", "report"];
            Identity::new(study.to_owned(), BTreeMap::new(), may_change)
        };
        let old = identity("question = \"a\"\ntrials = 1\n[skin]\npitch_mm = 2.0");
        let new = identity(
            "question = \"b\"\ntrials = 2\n[skin]\npitch_mm = [1.0, 2.0]\n[report]\nsamples = [\"mug\"]",
        );
        assert!(old.check_same(&new, "x").is_ok());
    }
}
