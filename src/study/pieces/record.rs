//! What a journal keeps of a piece.

use super::NamedPiece;
use crate::error::Result;
use crate::study::journal::Journal;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// Rows of a study's tables, and what else its tables are made of.
pub trait PieceRows: Default + Serialize + DeserializeOwned + Send {
    /// Puts the rows of the next piece behind those that are there.
    fn append(&mut self, next: Self);
}

/// What came of a piece: rows, or what went wrong.
pub type PieceResult<R> = std::result::Result<R, String>;

/// The same as it is written. Rows are TOML within the journal's JSON: JSON has no word for an infinite error.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Record {
    Found(String),
    Failed(String),
}

/// What a journal has of a piece.
pub fn in_journal<R: PieceRows>(journal: &Journal, piece: &NamedPiece) -> Option<PieceResult<R>> {
    match journal.get(&key(piece))? {
        Record::Found(rows) => toml::from_str(&rows).ok().map(Ok),
        Record::Failed(said) => Some(Err(said)),
    }
}

/// Keeps what came of a piece.
pub fn keep<R: PieceRows>(
    journal: &Journal,
    piece: &NamedPiece,
    result: &PieceResult<R>,
) -> Result<()> {
    let record = match result {
        Ok(rows) => Record::Found(toml::to_string(rows).expect("rows of tables have a TOML form")),
        Err(said) => Record::Failed(said.clone()),
    };
    journal.keep(&key(piece), &record)
}

fn key(NamedPiece { name, content, .. }: &NamedPiece) -> String {
    match content.is_empty() {
        true => format!("piece {name}"),
        false => format!("piece {name} [{content}]"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::journal::{Identity, JOURNAL_FILE};
    use crate::study::time_left::Piece;
    use rand::{Rng, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    struct Row {
        what: String,
        number: Option<f64>,
        other: f64,
    }

    #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
    struct Rows {
        rows: Vec<(Row, Row)>,
        more: Vec<f64>,
    }

    impl PieceRows for Rows {
        fn append(&mut self, next: Self) {
            self.rows.extend(next.rows);
            self.more.extend(next.more);
        }
    }

    fn row(what: &str, number: Option<f64>, other: f64) -> Row {
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
        let pair = |_| {
            (
                row(text, Some(drawn()), drawn()),
                row("", None, f64::INFINITY),
            )
        };
        let rows = Rows {
            rows: (0..500).map(pair).collect(),
            more: vec![-0.0, f64::NEG_INFINITY, 5e-324, f64::NAN],
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(JOURNAL_FILE);
        let identity = Identity::new("a = 1".to_owned(), Default::default(), &[]);
        let journal = Journal::open(&path, &identity).unwrap();
        let piece = |name: &str| NamedPiece::new(name.to_owned(), 0, Piece::of_stage(0, 1.0));
        keep(&journal, &piece("one"), &Ok(rows.clone())).unwrap();
        keep::<Rows>(&journal, &piece("two"), &Err("no\nroom".to_owned())).unwrap();
        drop(journal);
        let journal = Journal::open(&path, &identity).unwrap();
        let back: Rows = in_journal(&journal, &piece("one")).unwrap().unwrap();
        assert_eq!(back.rows, rows.rows);
        let bits = |rows: &Rows| rows.more.iter().map(|n| n.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&back), bits(&rows));
        let failed = in_journal::<Rows>(&journal, &piece("two"));
        assert_eq!(failed, Some(Err("no\nroom".to_owned())));
        assert_eq!(in_journal::<Rows>(&journal, &piece("three")), None);
        let of_more = piece("one").made_of("more");
        assert_eq!(in_journal::<Rows>(&journal, &of_more), None);
    }
}
