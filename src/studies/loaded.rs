//! Conversion of a loaded study of any kind to a type-erased study, which can also be compared with its results.

use crate::engine::journal::identity::Identity;
use crate::engine::journal::journal_file::Journal;
use crate::engine::progress::{Progress, Silent};
use crate::engine::provenance::{Manifest, REPORT};
use crate::engine::work_items::{
    ItemFailure, Part, PendingItems, RunOptions, WorkItem, threads_within, within_memory,
};
use crate::error::{Error, Result};
use crate::files::{DataFolder, MANIFEST_FILE, OwnedFiles, RUN, check_output};
use crate::inputs::content_hash::sha256;
use crate::inputs::memory::peak_memory;
use crate::random::Seed;
use crate::report::csv_tables::{FAILURES_FILE, read_rows};
use crate::report::folder::{NamedFile, table_files, write_files};
use crate::report::page::StudyAbout;
use crate::report::study_folder::{ChartFormat, Found, files_with};
use crate::studies::source::Source;
use crate::studies::study::{AnyStudy, Facts, Outcome, Study, run_items};
use crate::table::{File, Table};
use crate::toml_lines::with_line;
use rand::seq::SliceRandom;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

/// File of the table that lists the failed work items, with the cause of each failure.
pub(super) const FAILURES: File<ItemFailure> = File::new(FAILURES_FILE, "Failed work items", "");

/// Loaded and checked study, with all content on which its results depend.
pub struct Loaded<K> {
    kind: K,
    facts: Facts,
    identity: Identity,
    items: Arc<[WorkItem]>,
    /// Maximum memory that a run may use, bytes; `None` for no limit.
    memory: Option<u64>,
}

impl<K: Study> Loaded<K> {
    /// Reads, checks and loads a study.
    ///
    /// # Errors
    /// If a key is unknown or out of its range, or a file cannot be read.
    pub fn load(source: &Source) -> Result<Self> {
        let kind = K::load(source);
        let kind = kind.map_err(|error| with_line(&source.place, &source.text, error))?;
        threads_within(&kind.scale(), source.memory)?;
        let facts = kind.facts()?;
        let (toml, content) = (facts.toml.clone(), facts.content.clone());
        let items: Arc<[WorkItem]> = kind.work_items().into();
        let mut identity = Identity::new(toml, content, items.clone());
        if !K::VERSION.is_empty() {
            identity.program += &format!(" with {}@{}", K::ABOUT.table, K::VERSION);
        }
        Ok(Self {
            identity,
            items,
            memory: source.memory,
            facts,
            kind,
        })
    }

    /// Returns the work items in `part` that have no result in the journal; failed items are included if `retries` is set.
    fn pending<'a>(
        &'a self,
        part: Part<'a>,
        journal: &'a Journal,
        retries: bool,
    ) -> PendingItems<'a, K::Rows> {
        let options = RunOptions {
            journal,
            part,
            retries,
            ..RunOptions::whole(&Silent)
        };
        PendingItems::new(&self.items, &options)
    }

    /// Computes the work items that the options select, within the memory limit. Returns the tables of all finished items, and the failed items.
    fn tables(&self, options: &RunOptions) -> Result<(Vec<Table>, Vec<ItemFailure>)> {
        within_memory(&self.kind.scale(), self.memory, || {
            let (rows, failures) = run_items(&self.kind, &self.items, options)?;
            Ok((self.kind.tables(rows)?, failures))
        })
    }

    /// Returns the numbers of `n` work items that are drawn at random, with the given seed, from those that did not fail.
    fn drawn(&self, folder: &Path, (n, seed): (usize, u64)) -> Result<BTreeSet<usize>> {
        let failed: Vec<ItemFailure> = read_rows(&folder.join(FAILURES_FILE))?;
        let has_failed = |number: usize| {
            let words = || self.kind.item_words(number, &self.items[number]);
            failed.iter().any(|row| row.work_item == words())
        };
        let numbers = (0..self.items.len()).filter(|&number| !has_failed(number));
        let mut rng = Seed::new(seed).named("verify").rng();
        let numbers: Vec<usize> = numbers.collect();
        Ok(numbers.choose_multiple(&mut rng, n).copied().collect())
    }

    /// Adds the study's notes to its tables.
    fn note(&self, tables: &mut [Table]) {
        for (file, note) in &self.facts.notes {
            if let Some(table) = tables.iter_mut().find(|table| table.file == *file) {
                table.note.clone_from(note);
            }
        }
    }

    /// Returns the charts, pictures and page of a result folder as files in memory.
    fn files_of(&self, of_run: StudyAbout, tables: &[Table]) -> Result<Vec<NamedFile>> {
        let wall_s = of_run.manifest.as_ref().and_then(Manifest::wall_s);
        let about = StudyAbout {
            question: self.facts.question.clone(),
            expected: self.facts.expected.clone(),
            wall_s: wall_s.unwrap_or(f64::NAN),
            program: self.identity.program.clone(),
            ..of_run
        };
        let found = Found {
            tables,
            charts: &self.kind.charts(tables),
            answers: &self.kind.answers(tables),
        };
        files_with(&about, &found, || self.kind.beyond(tables))
    }
}

impl<K: Study> AnyStudy for Loaded<K> {
    fn identity(&self) -> &Identity {
        &self.identity
    }

    fn n_all(&self) -> usize {
        self.items.len()
    }

    fn plan(&self) -> Result<String> {
        let scale = self.kind.scale();
        let n_threads = threads_within(&scale, self.memory)?;
        let lines = scale.describe(self.items.len(), n_threads);
        Ok(format!("{}\n{lines}", self.facts.question))
    }

    fn n_pending(&self, part: Part, journal: &Journal) -> usize {
        self.pending(part, journal, false).n()
    }

    fn n_without_success(&self, part: Part, journal: &Journal) -> usize {
        self.pending(part, journal, true).n()
    }

    fn check_elsewhere(&self, part: Part, journal: &Journal) -> Result<Vec<Error>> {
        self.kind.check(&self.pending(part, journal, true))
    }

    fn run(&self, options: &RunOptions) -> Result<Outcome> {
        let (mut tables, failures) = self.tables(options)?;
        self.note(&mut tables);
        tables.push(FAILURES.table(&failures)?);
        let n_failed = failures.len();
        Ok(Outcome { tables, n_failed })
    }

    fn write(
        &self,
        dir: &Path,
        outcome: &Outcome,
        run: Manifest,
        chart_format: ChartFormat,
    ) -> Result<()> {
        let hashes = |repeats: bool| {
            let tables = outcome.tables.iter();
            let files = tables.filter(|t| t.repeats == repeats && !t.csv.is_empty());
            let hashes = files.map(|table| (table.file.to_owned(), sha256(&table.csv)));
            hashes.collect()
        };
        let words = |&(columns, method): &(&str, &str)| (columns.to_owned(), method.to_owned());
        let mut manifest = Manifest {
            seed: self.facts.seed,
            n_configurations: self.items.len(),
            n_trials: 1,
            n_failed: outcome.n_failed,
            tables_sha256: hashes(true),
            times_sha256: hashes(false),
            methods: self.facts.methods.iter().map(words).collect(),
            ..run
        };
        let of_run = StudyAbout {
            name: manifest.study.clone(),
            command: manifest.command.clone(),
            manifest: Some(manifest.clone()),
            chart_format,
            ..StudyAbout::default()
        };
        let page = self.files_of(of_run, &outcome.tables)?;
        // In a small study, drawing takes the most memory.
        manifest.peak_memory_bytes = peak_memory();
        let mut files = table_files(&outcome.tables);
        files.push(("study.toml".to_owned(), self.facts.toml.clone().into()));
        write_results(dir, manifest, files, page)
    }

    fn words(&self, outcome: &Outcome, width: usize) -> String {
        let summary = self.kind.summary(&outcome.tables, width);
        format!("{}\n\n{summary}", self.facts.question)
    }

    fn verify(
        &self,
        folder: &Path,
        n: usize,
        draw: u64,
        progress: &dyn Progress,
    ) -> Result<String> {
        let chosen = self.drawn(folder, (n, draw))?;
        let options = RunOptions {
            part: Part::Only(&chosen),
            ..RunOptions::whole(progress)
        };
        let (again, _) = self.tables(&options)?;
        progress.finish("");
        let is_whole = chosen.len() == self.items.len();
        let n_rows = same_rows(folder, &again, is_whole)?;
        Ok(format!(
            "{} of {} work items ran again, and {n_rows} rows without times are the same bytes",
            chosen.len(),
            self.items.len(),
        ))
    }

    fn report(&self, folder: &Path, about: StudyAbout) -> Result<()> {
        let mut tables = K::read_tables(folder)?;
        self.note(&mut tables);
        tables.extend(FAILURES.read_if_there(folder)?);
        let manifest = about.manifest.clone();
        let page = self.files_of(about, &tables)?;
        if let Some(manifest) = manifest {
            return write_results(folder, manifest, Vec::new(), page);
        }
        let names = page.iter().map(|(name, _)| name.as_str());
        DataFolder::claim_with(folder, REPORT, names, is_drawn)?.write_manifest()?;
        write_files(folder, page).map(drop)
    }
}

/// Returns whether the bytes are a picture, a page or a chart that this program has written; used if the folder has no manifest.
fn is_drawn(bytes: &[u8]) -> bool {
    let holds = |mark: &str| {
        bytes
            .windows(mark.len())
            .any(|part| part == mark.as_bytes())
    };
    bytes.starts_with(b"\x89PNG") || holds("bubbletouch") || holds("Generated by kuva")
}

/// Removes the files of a former run or report that the manifest of the new results does not list, such as tables of a former version of the study. A file that
/// was changed since stays, and no manifest lists it any more.
fn remove_former(folder: &Path, manifest: &Manifest) -> Result<()> {
    let Some(before) = Manifest::read(folder)? else {
        return Ok(());
    };
    let listed: BTreeMap<&String, &String> = manifest.files().collect();
    let former = before
        .files()
        .filter(|(name, _)| !listed.contains_key(name));
    for (name, hash) in former {
        let path = folder.join(name);
        let is_file = std::fs::symlink_metadata(&path).is_ok_and(|meta| meta.is_file());
        let is_in_folder = path.file_name().is_some_and(|own| own == name.as_str());
        if !(is_file && is_in_folder && check_output(&path).is_ok()) {
            continue;
        }
        let content = std::fs::read(&path).map_err(|e| Error::io(&path, "read", e))?;
        if sha256(content) == *hash {
            std::fs::remove_file(&path).map_err(|e| Error::io(&path, "remove", e))?;
        }
    }
    Ok(())
}

/// Writes the tables, charts and page of a run, and the manifest that lists them. The manifest is written first, so that files of an interrupted run are
/// recognised as files of this program.
fn write_results(
    folder: &Path,
    mut manifest: Manifest,
    of_run: Vec<NamedFile>,
    page: Vec<NamedFile>,
) -> Result<()> {
    let owned = OwnedFiles::read(folder, RUN)?;
    let names = of_run.iter().chain(&page).map(|(name, _)| name.as_str());
    owned.check(names)?;
    let drawn = page
        .iter()
        .map(|(name, bytes)| (name.clone(), sha256(bytes)));
    manifest.files_sha256 = Some(drawn.collect());
    remove_former(folder, &manifest)?;
    let mut files = vec![(MANIFEST_FILE.to_owned(), manifest.to_json().into())];
    files.extend(of_run);
    files.extend(page);
    write_files(folder, files).map(drop)
}

/// Compares recomputed table rows with the rows of a result folder; returns the number of equal rows, without tables of computing times. If `is_whole` is set,
/// all work items were recomputed; missing rows, additional rows and different summaries are then also errors.
///
/// # Errors
/// If a row differs; the error names file and line.
pub fn same_rows(folder: &Path, again: &[Table], is_whole: bool) -> Result<usize> {
    let mut n_rows = 0;
    let of_items = again
        .iter()
        .filter(|table| table.repeats && !table.csv.is_empty());
    for table in of_items.filter(|table| is_whole || !table.is_summary) {
        let path = folder.join(table.file);
        let text = std::fs::read_to_string(&path).map_err(|e| Error::io(&path, "read", e))?;
        let content = String::from_utf8_lossy(&table.csv);
        let header = content.lines().next().unwrap_or_default();
        let same_columns = match is_whole || text.lines().next() == Some(header) {
            true => None,
            false => columns_of(&text, header),
        };
        let lines = same_columns.as_deref().unwrap_or(&text).lines();
        let stands: BTreeSet<&str> = lines.clone().collect();
        for row in content.lines().skip(1) {
            if !stands.contains(row) {
                let nearest = lines.zip(1..).max_by_key(|(other, _)| n_alike(row, other));
                let (nearest, line) = nearest.unwrap_or(("(none)", 1));
                return Err(Error::input(
                    format!("{}:{line}", path.display()),
                    format!("has the row\n  {nearest}"),
                    format!("\n  again it is\n  {row}"),
                ));
            }
            n_rows += 1;
        }
        if is_whole && content != text {
            let given = "differs from the table that all work items give";
            let allowed = "the rows of one run, each once, in their order";
            return Err(Error::input(path.display(), given, allowed));
        }
    }
    Ok(n_rows)
}

/// Returns a table with only the columns of `header`; `None` if the table lacks one of them. The restriction is needed because some columns exist only if a row
/// has a value. For example, a table without groups has no column of group counts.
fn columns_of(text: &str, header: &str) -> Option<String> {
    let mut reader = csv::ReaderBuilder::new();
    let mut reader = reader.has_headers(false).from_reader(text.as_bytes());
    let mut rows = reader.records();
    let names = rows.next()?.ok()?;
    let places = header
        .split(',')
        .map(|column| names.iter().position(|name| name == column));
    let places: Vec<usize> = places.collect::<Option<_>>()?;
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(header.split(',')).ok()?;
    for row in rows {
        let row = row.ok()?;
        writer
            .write_record(places.iter().filter_map(|&place| row.get(place)))
            .ok()?;
    }
    String::from_utf8(writer.into_inner().ok()?).ok()
}

/// Returns the number of equal bytes at the start of two rows. Rows begin with their configuration, so similar configurations have long equal starts.
fn n_alike(a: &str, b: &str) -> usize {
    let pairs = a.bytes().zip(b.bytes());
    pairs.take_while(|(a, b)| a == b).count()
}
