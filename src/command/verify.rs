//! `bubbletouch verify`: whether a folder of results comes out again.

use super::memory_args::MemoryArgs;
use super::output::packings_beside;
use super::study_args::StudyArgs;
use bubbletouch::random::Seed;
use bubbletouch::report::csv_tables::{read_tables, sha256_of, to_csv};
use bubbletouch::report::progress;
use bubbletouch::study::journal::Journal;
use bubbletouch::study::provenance::{MANIFEST_FILE, Manifest, SOURCE};
use bubbletouch::study::table::Tables;
use bubbletouch::study::{Manner, Part, run_with};
use bubbletouch::{Error, Result};
use rand::seq::SliceRandom;
use std::collections::BTreeSet;
use std::path::PathBuf;

#[derive(clap::Args)]
pub struct Args {
    /// A folder that `bubbletouch run` wrote
    results: PathBuf,
    /// How many cells to run again, drawn at random
    #[arg(long, value_name = "N", default_value_t = 5)]
    cells: usize,
    /// Which cells are drawn
    #[arg(long, value_name = "N", default_value_t = 0)]
    draw: u64,
    /// Threads; all cores when left out
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    #[command(flatten)]
    memory: MemoryArgs,
}

pub fn verify(args: &Args) -> Result<()> {
    let folder = &args.results;
    let tables = read_tables(folder)?;
    check_manifest(args)?;
    let study = StudyArgs {
        study: folder.join("study.toml"),
        objects: None,
        seed: None,
        threads: args.threads,
    };
    let loaded = study.load(Some(&packings_beside(folder)))?;
    let chosen = draw(&tables, args);
    let room = args.memory.room(&loaded, folder)?;
    let manner = Manner {
        journal: &Journal::none(),
        fail_fast: true,
        retries: false,
        part: Part::Holding(&chosen),
        storage: &room.storage,
        at_once: room.at_once,
    };
    let progress = progress::to_stderr();
    let touched = loaded.touched.as_ref();
    let outcome = run_with(
        &loaded.plan,
        &loaded.sweep,
        touched,
        progress.as_ref(),
        manner,
    )?;
    progress.finish("");
    let again = rows(&outcome.tables, &chosen)?;
    let before = rows(&tables, &chosen)?;
    if let Some(place) = before
        .iter()
        .zip(&again)
        .position(|(before, again)| before != again)
    {
        return Err(Error::input(
            folder.join("accuracy.csv").display(),
            format!("has the row\n  {}", before[place]),
            format!("\n  again it is\n  {}", again[place]),
        ));
    }
    println!(
        "{}: {} of {} rows of accuracy.csv ran again, and are the same bytes",
        folder.display(),
        again.len(),
        tables.accuracy.len()
    );
    Ok(())
}

/// An error if a table is not what the manifest says; a note if the program is another.
fn check_manifest(args: &Args) -> Result<()> {
    let manifest = Manifest::read(&args.results)?.ok_or_else(|| {
        let path = args.results.join(MANIFEST_FILE);
        Error::input(path.display(), "is missing", "the manifest of a run")
    })?;
    for (name, hash) in &manifest.tables_sha256 {
        let place = args.results.join(name);
        if sha256_of(&place)? != *hash {
            let allowed = "the table that the manifest names by its SHA-256";
            return Err(Error::input(
                place.display(),
                "was changed after its run",
                allowed,
            ));
        }
    }
    if manifest.source != SOURCE {
        println!(
            "note: the results were made by {} (commit {}), not by this version",
            manifest.program, manifest.commit
        );
    }
    Ok(())
}

/// Some rows of the accuracy table: (cell, trial).
fn draw(tables: &Tables, args: &Args) -> BTreeSet<(usize, usize)> {
    let all = tables
        .accuracy
        .iter()
        .map(|(cell, score)| (cell.cell, score.trial));
    let all: Vec<_> = all.collect();
    let mut rng = Seed::new(args.draw).named("verify").rng();
    all.choose_multiple(&mut rng, args.cells).copied().collect()
}

/// Rows of accuracy.csv, those of the chosen cells, as they are written.
fn rows(tables: &Tables, chosen: &BTreeSet<(usize, usize)>) -> Result<Vec<String>> {
    let rows = tables.accuracy.iter();
    let rows: Vec<_> = rows
        .filter(|(cell, score)| chosen.contains(&(cell.cell, score.trial)))
        .collect();
    let bytes =
        to_csv(&rows).map_err(|e| Error::io("accuracy.csv", "write", std::io::Error::other(e)))?;
    let text = String::from_utf8_lossy(&bytes);
    Ok(text.lines().skip(1).map(str::to_owned).collect())
}
