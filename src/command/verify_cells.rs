//! Cells of a folder of results that run again.

use super::memory_args::Room;
use super::study_args::LoadedStudy;
use bubbletouch::random::Seed;
use bubbletouch::report::csv_tables::{csv_content, read_tables};
use bubbletouch::study::journal::Journal;
use bubbletouch::study::progress::Progress;
use bubbletouch::study::table::Tables;
use bubbletouch::study::{Manner, Part, run_with};
use bubbletouch::{Error, Result};
use rand::seq::SliceRandom;
use std::collections::BTreeSet;
use std::path::Path;

/// Runs some cells again, as many as are wanted, drawn from a seed, and says so; or which row of `accuracy.csv` is not the same.
pub fn verify_cells(
    loaded: &LoadedStudy,
    room: &Room,
    (folder, progress): (&Path, &dyn Progress),
    wanted: (usize, u64),
) -> Result<String> {
    let tables = read_tables(folder)?;
    let chosen = draw(&tables, wanted);
    let manner = Manner {
        journal: &Journal::none(),
        fail_fast: true,
        retries: false,
        part: Part::Holding(&chosen),
        storage: &room.storage,
        at_once: room.memory.at_once,
    };
    let (plan, sweep, touched) = (&loaded.plan, &loaded.sweep, loaded.touched.as_ref());
    let outcome = run_with(plan, sweep, touched, progress, manner)?;
    progress.finish("");
    let again = rows(&outcome.tables, &chosen)?;
    let before = rows(&tables, &chosen)?;
    let mut pairs = before.iter().zip(&again);
    if let Some((before, again)) = pairs.find(|(before, again)| before != again) {
        return Err(Error::input(
            folder.join("accuracy.csv").display(),
            format!("has the row\n  {before}"),
            format!("\n  again it is\n  {again}"),
        ));
    }
    Ok(format!(
        "{} of {} rows of accuracy.csv ran again, and are the same bytes",
        again.len(),
        tables.accuracy.len()
    ))
}

/// Some rows of the accuracy table: (cell, trial).
fn draw(tables: &Tables, (n, draw): (usize, u64)) -> BTreeSet<(usize, usize)> {
    let all = tables
        .accuracy
        .iter()
        .map(|(cell, score)| (cell.cell, score.trial));
    let all: Vec<_> = all.collect();
    let mut rng = Seed::new(draw).named("verify").rng();
    all.choose_multiple(&mut rng, n).copied().collect()
}

/// Rows of accuracy.csv, those of the chosen cells, as they are written.
fn rows(tables: &Tables, chosen: &BTreeSet<(usize, usize)>) -> Result<Vec<String>> {
    let rows = tables.accuracy.iter().cloned();
    let rows: Vec<_> = rows
        .filter(|(cell, score)| chosen.contains(&(cell.cell, score.trial)))
        .collect();
    let bytes = csv_content(Path::new("accuracy.csv"), &rows)?;
    let text = String::from_utf8_lossy(&bytes);
    Ok(text.lines().skip(1).map(str::to_owned).collect())
}
