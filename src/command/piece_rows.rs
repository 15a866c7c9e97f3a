//! Pieces that run again beside the rows that stand in a folder.

use bubbletouch::random::Seed;
use bubbletouch::report::csv_tables::{FAILURES_FILE, read_rows};
use bubbletouch::report::study_tables::StudyTables;
use bubbletouch::study::pieces::{NamedPiece, PieceFailure};
use bubbletouch::{Error, Result};
use rand::seq::SliceRandom;
use std::collections::BTreeSet;
use std::path::Path;

/// Some of the pieces of a folder that did not fail, as [`Part::Only`](bubbletouch::study::pieces::Part) wants them: how many, drawn from a seed.
pub fn draw(
    pieces: &[NamedPiece],
    folder: &Path,
    (n, seed): (usize, u64),
) -> Result<BTreeSet<usize>> {
    let failed: Vec<PieceFailure> = read_rows(&folder.join(FAILURES_FILE))?;
    let has_failed = |piece: &NamedPiece| failed.iter().any(|row| row.piece == piece.name);
    let numbers = (0..pieces.len()).filter(|&number| !has_failed(&pieces[number]));
    let numbers: Vec<usize> = numbers.collect();
    let mut rng = Seed::new(seed).named("verify").rng();
    Ok(numbers.choose_multiple(&mut rng, n).copied().collect())
}

/// How many rows of pieces without times stand in a folder as they came out again, those of others apart; the error names the first that
/// does not.
pub fn compare<T: StudyTables>(folder: &Path, again: &T, of_others: &T) -> Result<usize> {
    let mut n_rows = 0;
    let others = of_others.files()?;
    for (name, content) in again.files()? {
        if !T::OF_PIECES.contains(&name) {
            continue;
        }
        let path = folder.join(name);
        let stands = std::fs::read_to_string(&path).map_err(|e| Error::io(&path, "read", e))?;
        let stands: BTreeSet<&str> = stands.lines().collect();
        let of_others = others.iter().find(|(other, _)| *other == name);
        let of_others = of_others.map(|(_, content)| String::from_utf8_lossy(content));
        let of_others = of_others.unwrap_or_default();
        let of_others: BTreeSet<&str> = of_others.lines().skip(1).collect();
        let content = String::from_utf8_lossy(&content);
        let rows = content.lines().skip(1);
        for row in rows.filter(|row| !of_others.contains(row)) {
            if !stands.contains(row) {
                let nearest = stands.iter().max_by_key(|other| n_alike(row, other));
                return Err(Error::input(
                    path.display(),
                    format!("has the row\n  {}", nearest.unwrap_or(&"(none)")),
                    format!("\n  again it is\n  {row}"),
                ));
            }
            n_rows += 1;
        }
    }
    Ok(n_rows)
}

/// Leading letters that two rows share: rows begin with what they are about.
fn n_alike(a: &str, b: &str) -> usize {
    let pairs = a.bytes().zip(b.bytes());
    pairs.take_while(|(a, b)| a == b).count()
}
