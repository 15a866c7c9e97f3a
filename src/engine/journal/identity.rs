//! Identity of a study: all content on which its results depend.

use super::line::Records;
use crate::engine::program::{PROGRAM, SOURCE};
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
    /// Work items of the study, whose keys contain all their inputs except objects. They are not stored in the journal.
    #[serde(skip)]
    items: Arc<[WorkItem]>,
}

impl Identity {
    /// Creates the identity of a study, which consists of the TOML text, the objects and this program.
    pub fn new(study: String, objects: BTreeMap<String, String>, items: Arc<[WorkItem]>) -> Self {
        Self {
            program: PROGRAM.to_owned(),
            source: SOURCE.to_owned(),
            study,
            objects,
            items,
        }
    }

    /// Returns the differences between this study and the study that started a journal, one line per difference.
    pub fn differences(&self, (begun, records): (&Self, &Records)) -> Vec<String> {
        let shares_results = self.shares_results(records);
        let [theirs, ours] = [begun, self].map(|identity| identity.facts(shares_results));
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

    /// Returns whether the records of a journal belong to this study: they contain the result of a work item of the study, or no record of another study. A study
    /// that shares no result is another study, because its tables would replace all existing tables.
    fn shares_results(&self, records: &Records) -> bool {
        let known = self.items.iter().filter_map(|item| {
            let (key, _) = records.get_key_value(&item.key())?;
            Some((&key[..], item.is_result))
        });
        let known: HashSet<(&str, bool)> = known.collect();
        let shares = known.iter().any(|(_, is_result)| *is_result);
        shares || known.len() == records.len()
    }

    /// Returns the parts of the identity by name: program, objects, and the keys of the study. Studies that share results may differ in their keys, because the
    /// keys of work items contain their inputs.
    fn facts(&self, shares_results: bool) -> BTreeMap<String, String> {
        let mut facts = BTreeMap::new();
        let table = toml_text::table(&self.study).filter(|_| !shares_results);
        if let Some(table) = table {
            add_keys("", &table, &mut facts);
        }
        facts.insert("program".to_owned(), self.program.clone());
        facts.insert("program's sources".to_owned(), self.source.clone());
        // The names of work items contain the contents of a recording, so its files may differ like other keys.
        let has_to_be_same = |name: &str| !is_at(name, "recorded") || !shares_results;
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
    use serde_json::value::RawValue;

    fn identity(study: &str, objects: &[(&str, &str)], n_items: usize) -> Identity {
        let objects = objects.iter();
        let objects = objects.map(|(name, hash)| (name.to_string(), hash.to_string()));
        let items = (0..n_items).map(|n| WorkItem::of("item".to_owned(), n, &n));
        Identity::new(study.to_owned(), objects.collect(), items.collect())
    }

    /// Returns a journal with the results of the first work items of a study.
    fn records(of: &Identity, n: usize) -> Records {
        let result = RawValue::from_string("1".to_owned()).unwrap();
        let items = of.items[..n].iter();
        items.map(|item| (item.key(), result.clone())).collect()
    }

    #[test]
    fn what_differs_is_named_by_its_key_and_by_its_object() {
        let old = identity(
            "seed = 1\n[skin]\npitch_mm = [1.0, 2.0]\nstiffness_n_per_m = 100.0",
            &[("mug", "a1"), ("bowl", "b")],
            1,
        );
        let new = identity(
            "seed = 1\n[skin]\npitch_mm = [1.0, 2.0]\nstiffness_n_per_m = 200.0\nstroke_mm = 5.0",
            &[("mug", "a2"), ("bowl", "b")],
            0,
        );
        let expected = [
            "object mug: was a1, is a2",
            "skin.stiffness_n_per_m: was 100.0, is 200.0",
            "skin.stroke_mm: was nothing, is 5.0",
        ];
        let records = &records(&old, 1);
        assert_eq!(new.differences((&old, records)), expected);
        assert!(old.check_same((&old, records), "x").is_ok());
        let said = new.check_same((&old, records), "results/x").unwrap_err();
        assert_eq!(said.exit_code(), 2);
        assert!(said.to_string().contains(expected[0]), "{said}");
    }

    #[test]
    fn studies_that_share_a_result_may_differ_in_their_keys_but_not_in_their_objects() {
        let mug = |hash| [("mug", hash)];
        let old = identity("question = \"a\"\ntrials = 1", &mug("a1"), 2);
        let new = identity("question = \"b\"\ntrials = 2", &mug("a1"), 3);
        for n in [0, 1, 2] {
            let records = records(&old, n);
            assert!(new.check_same((&old, &records), "x").is_ok(), "{n}");
            let other = identity(&new.study, &mug("a2"), 3);
            assert!(other.check_same((&old, &records), "x").is_err(), "{n}");
        }
    }
}
