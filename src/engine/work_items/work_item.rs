//! Work item: a named, independent part of the work of a study, with the rows that it gives and the data that it shares with other items.

use crate::error::Result;
use crate::inputs::content_hash::identity;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::sync::OnceLock;

/// Work item of a study: a named part that is computed, stored and repeated independently of others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WorkItem {
    /// Name of the work item, in words.
    pub name: String,
    /// Identity of the inputs of the work item: the hash of their canonical bytes (JSON). Items with equal names and equal inputs have equal result rows. The
    /// item's number is not an input, because a later study may have more items.
    pub inputs: String,
    /// Number of the group to which the item belongs, from 0 without gaps. Items of a group share preparatory work, so one shard computes all of them if there
    /// are enough groups for every shard.
    pub group: usize,
    /// Whether the rows of the work item are results of the study. If false, the item only prepares data for results; studies that share only preparing items
    /// are different studies.
    pub is_result: bool,
}

impl WorkItem {
    /// Creates a work item whose rows depend on `inputs`; its name only needs to describe it in words. Items with equal names and equal inputs have equal rows.
    pub fn of(name: String, group: usize, inputs: &impl Serialize) -> Self {
        Self {
            name,
            inputs: identity(inputs),
            group,
            is_result: true,
        }
    }

    /// Returns the key under which the journal stores the result of the work item.
    pub(crate) fn key(&self) -> String {
        format!("piece {} [{}]", self.name, self.inputs)
    }
}

/// Type of a work item's results: rows of result tables, and data from which tables are computed. The journal stores them as JSON; fields that may be infinite
/// or NaN need `#[serde(with = "any_number")]`.
pub trait ItemRows: Default + Serialize + DeserializeOwned + Send {
    /// Appends the rows of the next work item.
    fn append(&mut self, next: Self);
}

impl<R: Serialize + DeserializeOwned + Send> ItemRows for Vec<R> {
    fn append(&mut self, next: Self) {
        self.extend(next);
    }
}

impl<A: ItemRows, B: ItemRows> ItemRows for (A, B) {
    fn append(&mut self, next: Self) {
        self.0.append(next.0);
        self.1.append(next.1);
    }
}

impl<A: ItemRows, B: ItemRows, C: ItemRows> ItemRows for (A, B, C) {
    fn append(&mut self, next: Self) {
        self.0.append(next.0);
        self.1.append(next.1);
        self.2.append(next.2);
    }
}

/// Result of a work item: its rows, or an error message.
pub type ItemResult<R> = std::result::Result<R, String>;

/// Data that several work items need, computed by the first item that needs them. Two items that need the data at the same time may both compute them.
#[derive(Debug)]
pub struct Shared<T>(OnceLock<T>);

impl<T> Default for Shared<T> {
    fn default() -> Self {
        Self(OnceLock::new())
    }
}

impl<T> Shared<T> {
    /// Returns the shared data; computes them with `make` if they do not exist yet.
    ///
    /// # Errors
    /// If `make` fails; the next call tries again.
    pub fn get(&self, make: impl FnOnce() -> Result<T>) -> Result<&T> {
        if let Some(made) = self.0.get() {
            return Ok(made);
        }
        let made = make()?;
        Ok(self.0.get_or_init(|| made))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::journal::identity::Identity;
    use crate::engine::journal::journal_file::{JOURNAL_FILE, Journal};
    use crate::engine::work_items::any_number;
    use rand::{Rng, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use serde::Deserialize;

    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    struct Row {
        what: String,
        number: Option<f64>,
        #[serde(with = "any_number")]
        other: Option<f64>,
    }

    #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
    struct Rows {
        rows: Vec<(Row, Row)>,
    }

    impl ItemRows for Rows {
        fn append(&mut self, next: Self) {
            self.rows.extend(next.rows);
        }
    }

    fn row(what: &str, number: Option<f64>, other: Option<f64>) -> Row {
        let what = what.to_owned();
        Row {
            what,
            number,
            other,
        }
    }

    #[test]
    fn rows_come_back_to_the_bit_infinite_and_absent_numbers_too() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut drawn = || loop {
            let number = f64::from_bits(rng.r#gen());
            if number.is_finite() {
                return number;
            }
        };
        let text = "a\n\"b\" = '''c'''\\";
        let pair = |_| (row(text, Some(drawn()), Some(drawn())), row("", None, None));
        let mut rows = Rows {
            rows: (0..500).map(pair).collect(),
        };
        let odd = [-0.0, f64::INFINITY, f64::NEG_INFINITY, 5e-324, f64::NAN];
        for number in odd {
            rows.rows
                .push((row("", None, Some(number)), row("", None, None)));
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(JOURNAL_FILE);
        let identity = Identity::new("a = 1".to_owned(), Default::default(), Default::default());
        let journal = Journal::open(&path, &identity).unwrap();
        let item = |name: &str| WorkItem::of(name.to_owned(), 0, &());
        let keep = |name: &str, result: ItemResult<Rows>| journal.keep(&item(name).key(), &result);
        keep("one", Ok(rows.clone())).unwrap();
        keep("two", Err("no\nroom".to_owned())).unwrap();
        drop(journal);
        let journal = Journal::open(&path, &identity).unwrap();
        let in_journal = |item: WorkItem| -> Option<ItemResult<Rows>> { journal.get(&item.key()) };
        let back = in_journal(item("one")).unwrap().unwrap();
        assert_eq!(back.rows[..500], rows.rows[..500]);
        let bits = |rows: &Rows| -> Vec<Option<u64>> {
            let numbers = rows.rows.iter().map(|(row, _)| row.other);
            numbers.map(|number| number.map(f64::to_bits)).collect()
        };
        assert_eq!(bits(&back), bits(&rows));
        let failed = in_journal(item("two"));
        assert_eq!(failed, Some(Err("no\nroom".to_owned())));
        assert_eq!(in_journal(item("three")), None);
        let of_more = WorkItem::of("one".to_owned(), 0, &"more");
        assert_eq!(in_journal(of_more), None);
    }
}
