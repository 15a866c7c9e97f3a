//! Identity of a study: all content on which its results depend.

use super::line::Records;
use crate::engine::work_items::WorkItem;
use crate::error::{Error, Result};
use crate::inputs::toml_value::is_at;
use crate::toml_text;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::sync::Arc;

/// Identity of a study: all inputs that determine the content of its result tables.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Name and version of the program that runs the study.
    pub program: String,
    /// Hash of the program's source code.
    pub source: String,
    /// Study file as TOML, with all default values written out.
    pub study: String,
    /// SHA-256 hash of each object's content, by the object's name.
    pub objects: BTreeMap<String, String>,
    /// Rule that determines which other studies may resume the run. The rule is not stored in the journal.
    #[serde(skip)]
    same: SameStudy,
}

/// Rule that determines which studies of one program with equal objects may resume each other's runs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SameStudy {
    /// Studies may share a journal if they differ only in these keys and in keys of their subtables.
    ButFor(&'static [&'static str]),
    /// Studies may share a journal if it contains a result of one of these work items. The names of the items are derived from all inputs, so results cannot be
    /// confused. A study that shares no result is rejected, because its tables would replace all existing tables.
    SharesWork(Arc<[WorkItem]>),
}

impl Default for SameStudy {
    fn default() -> Self {
        Self::ButFor(&[])
    }
}

impl SameStudy {
    /// Returns a function that returns whether a key of the study file may differ between two studies that share a journal.
    fn may_differ(&self, records: &Records) -> Box<dyn Fn(&str) -> bool> {
        match self {
            Self::ButFor(keys) => Box::new(|key| keys.iter().any(|name| is_at(key, name))),
            Self::SharesWork(items) => {
                let known = items.iter().filter_map(|item| {
                    let (key, _) = records.get_key_value(&item.key())?;
                    Some((&key[..], item.is_result))
                });
                let known: HashSet<(&str, bool)> = known.collect();
                let shares = known.iter().any(|(_, is_result)| *is_result);
                let is_same = shares || known.len() == records.len();
                Box::new(move |_| is_same)
            }
        }
    }
}

impl Identity {
    /// Creates the identity of a study, which consists of the TOML text, the objects and this program.
    pub fn new(study: String, objects: BTreeMap<String, String>, same: SameStudy) -> Self {
        Self {
            program: crate::engine::program::PROGRAM.to_owned(),
            source: crate::engine::program::SOURCE.to_owned(),
            study,
            objects,
            same,
        }
    }

    /// Returns the differences between this study and the study that started a journal, one line per difference.
    pub fn differences(&self, (begun, records): (&Self, &Records)) -> Vec<String> {
        let may_differ = self.same.may_differ(records);
        let [theirs, ours] = [begun, self].map(|identity| identity.facts(&may_differ));
        let mut names: BTreeSet<&String> = ours.keys().chain(theirs.keys()).collect();
        names.retain(|name| ours.get(*name) != theirs.get(*name));
        let words = |value: Option<&String>| value.map_or("nothing".to_owned(), String::clone);
        let line = |name: &String| {
            let (was, is) = (words(theirs.get(name)), words(ours.get(name)));
            format!("{name}: was {was}, is {is}")
        };
        names.into_iter().map(line).collect()
    }

    /// Returns an error if this study must not resume the journal at `place`.
    ///
    /// # Errors
    /// If the journal was started by another study; the error lists the differences.
    pub fn check_same(&self, of: (&Self, &Records), place: &str) -> Result<()> {
        let differences = self.differences(of);
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

    /// Returns the parts of the identity by name: program, objects, and all study keys that may not differ.
    fn facts(&self, may_differ: impl Fn(&str) -> bool) -> BTreeMap<String, String> {
        let mut facts = BTreeMap::new();
        if let Some(table) = toml_text::table(&self.study) {
            add_keys("", &table, &mut facts);
        }
        facts.retain(|key, _| !may_differ(key));
        facts.insert("program".to_owned(), self.program.clone());
        facts.insert("program's sources".to_owned(), self.source.clone());
        // The names of work items contain the contents of a recording, so its files may differ like other keys.
        let has_to_be_same = |name: &str| !is_at(name, "recorded") || !may_differ(name);
        let objects = self.objects.iter();
        let objects = objects.filter(|(name, _)| has_to_be_same(name));
        facts.extend(objects.map(|(name, hash)| (format!("object {name}"), hash.clone())));
        facts
    }
}

/// Adds every value of a TOML table and its subtables to `values`; the name of a value is its dotted key with the prefix `prefix`.
fn add_keys(prefix: &str, table: &toml::Table, values: &mut BTreeMap<String, String>) {
    for (key, value) in table {
        match value {
            toml::Value::Table(inner) => add_keys(&format!("{prefix}{key}."), inner, values),
            value => {
                let key = format!("{prefix}{key}");
                let text = match VERSIONED.contains(&&key[..]) {
                    true => without_versions(&value.to_string()),
                    false => value.to_string(),
                };
                values.insert(key, text);
            }
        }
    }
}

/// Keys whose values contain versions: `mine@1`. Work items of another version have other names, so one journal may contain several versions.
const VERSIONED: [&str; 2] = ["recognition.classifier", "recognition.features"];

/// Returns TOML text in which each string ends before its first `@`.
fn without_versions(text: &str) -> String {
    let parts = text
        .split('"')
        .map(|part| part.split('@').next().unwrap_or(part));
    parts.collect::<Vec<_>>().join("\"")
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
            let same = SameStudy::ButFor(&["question"]);
            Identity::new(study.to_owned(), objects.collect(), same)
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
        let records = &Records::default();
        assert_eq!(new.differences((&old, records)), expected);
        assert!(old.check_same((&old, records), "x").is_ok());
        let said = new.check_same((&old, records), "results/x").unwrap_err();
        assert_eq!(said.exit_code(), 2);
        assert!(said.to_string().contains(expected[0]), "{said}");
    }

    #[test]
    fn words_and_axes_of_a_study_leave_it_the_same() {
        let identity = |study: &str| {
            let same = SameStudy::ButFor(&["question", "trials", "skin.pitch_mm", "report"]);
            Identity::new(study.to_owned(), BTreeMap::new(), same)
        };
        let old = identity("question = \"a\"\ntrials = 1\n[skin]\npitch_mm = 2.0");
        let new = identity(
            "question = \"b\"\ntrials = 2\n[skin]\npitch_mm = [1.0, 2.0]\n[report]\nsamples = [\"mug\"]",
        );
        assert!(new.check_same((&old, &Records::default()), "x").is_ok());
    }
}
