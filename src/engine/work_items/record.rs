//! Record of a work item in the journal.

use serde::Serialize;
use serde::de::DeserializeOwned;

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::journal::identity::Identity;
    use crate::engine::journal::journal_file::{JOURNAL_FILE, Journal};
    use crate::engine::work_items::any_number;
    use crate::engine::work_items::work_item::WorkItem;
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
