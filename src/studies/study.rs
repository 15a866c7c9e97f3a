//! Trait [`Study`], which every kind of study implements, the types that a kind provides, and the type-erased studies that all commands use.

use crate::engine::journal::identity::Identity;
use crate::engine::journal::journal_file::Journal;
use crate::engine::progress::Progress;
use crate::engine::provenance::Manifest;
use crate::engine::work_items::{
    ItemFailure, ItemRows, Part, PendingItems, RunOptions, Scale, WorkItem,
};
use crate::error::{Error, Result};
use crate::files::has_table;
use crate::inputs::keys::{AxisPlace, KeyAbout};
use crate::inputs::params::{Described, keys_of};
use crate::report::chart::Chart;
use crate::report::page::StudyAbout;
use crate::report::study_folder::{Beyond, ChartFormat, first_found, words_of};
use crate::studies::recognition::spec::keys::keys_without_axes;
use crate::studies::source::Source;
use crate::table::{ChartSpec, Columns, File, FileAbout, Table};
use crate::toml_text;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;
use toml::Value;

/// Type-erased study: a loaded and checked study of any kind.
pub trait AnyStudy: Send {
    /// Returns the identity of the study: hashes of all content on which its results depend.
    fn identity(&self) -> &Identity;

    /// Returns the number of work items of the study.
    fn n_all(&self) -> usize;

    /// Returns a text that describes the study before it runs: its question, its size and the memory that it needs.
    ///
    /// # Errors
    /// If the study does not fit into the memory limit.
    fn plan(&self) -> Result<String>;

    /// Returns the number of work items in `part` that have no result in the journal.
    fn n_pending(&self, part: Part, journal: &Journal) -> usize;

    /// Returns the number of work items in `part` without a successful result in the journal.
    fn n_without_success(&self, part: Part, journal: &Journal) -> usize;

    /// Checks what the work items in `part` that have no successful result in the journal need of the running program. Commands call this function before they
    /// write a file.
    ///
    /// # Errors
    /// If the running program cannot compute one of these work items, for example because it does not provide a classifier.
    fn check(&self, part: Part, journal: &Journal) -> Result<()> {
        let missing = self.check_elsewhere(part, journal)?;
        missing.into_iter().next().map_or(Ok(()), Err)
    }

    /// Checks what these work items need if they are computed on other machines. Returns an error for each program that this machine lacks and the other
    /// machines may have.
    ///
    /// # Errors
    /// If the running program cannot compute one of these work items on any machine.
    fn check_elsewhere(&self, part: Part, journal: &Journal) -> Result<Vec<Error>>;

    /// Runs the work items that have no result in the journal.
    ///
    /// # Errors
    /// If the journal cannot be written, or the memory does not suffice for a single item. If an item fails and the first failure ends the run.
    fn run(&self, options: &RunOptions) -> Result<Outcome>;

    /// Writes all files of a run into a result folder: tables, charts, page, study file and manifest.
    ///
    /// # Errors
    /// If a chart cannot be drawn or a file cannot be written.
    fn write(
        &self,
        folder: &Path,
        outcome: &Outcome,
        run: Manifest,
        chart_format: ChartFormat,
    ) -> Result<()>;

    /// Returns the text that the terminal shows at the end of a run, wrapped at `width` characters.
    fn words(&self, outcome: &Outcome, width: usize) -> String;

    /// Re-runs `n` work items, drawn at random with the seed `draw`, and compares their results with the stored ones. Returns a text that lists these items.
    ///
    /// # Errors
    /// If a recomputed row differs from the row in the folder.
    fn verify(&self, folder: &Path, n: usize, draw: u64, progress: &dyn Progress)
    -> Result<String>;

    /// Redraws the charts, pictures and page of a result folder from the tables in the folder. The question and the answers come from the study.
    ///
    /// # Errors
    /// If a table cannot be read or a file cannot be written.
    fn report(&self, folder: &Path, about: StudyAbout) -> Result<()>;
}

/// Result of running a study: its tables, and the number of failed work items.
pub struct Outcome {
    /// All result tables, including the table of failed work items.
    pub tables: Vec<Table>,
    /// Number of work items that failed.
    pub n_failed: usize,
}

/// Description of a kind of study, which is available before any study file is read.
#[derive(Clone, Copy, Debug)]
pub struct About {
    /// Name of the table that identifies study files of this kind.
    pub table: &'static str,
    /// Phrase of the form `a study that …` that describes the purpose of this kind of study.
    pub words: &'static str,
}

/// Content of the study file and of the files to which it refers.
#[derive(Clone, Debug, Default)]
pub struct Facts {
    /// Study as TOML text that contains all default values.
    pub toml: String,
    /// Question that the study answers.
    pub question: String,
    /// Answer that the author expected before the first run; may be empty.
    pub expected: String,
    /// Seed of all random numbers; 0 if the study uses no random numbers.
    pub seed: u64,
    /// SHA-256 hashes of all content outside the study file, such as meshes: by name, the hash of each file or object.
    pub content: BTreeMap<String, String>,
    /// Statistical methods of the intervals and p-values: pairs of the table columns and the method that computes them.
    pub methods: Vec<(&'static str, &'static str)>,
    /// Pairs of the file name of a table and a note about the table.
    pub notes: Vec<(&'static str, String)>,
}

impl Facts {
    /// Creates the facts about a study from its specification and from the hashes of files outside the study file.
    pub fn new(spec: &impl Serialize, content: BTreeMap<String, String>) -> Self {
        Self::of_toml(toml_text::write(spec), content)
    }

    /// Creates the facts of a study from its complete TOML text, which contains the question, the expectation and the seed.
    pub fn of_toml(toml: String, content: BTreeMap<String, String>) -> Self {
        let table = toml_text::table(&toml).unwrap_or_default();
        let words = |key| table.get(key).and_then(Value::as_str);
        let seed = table.get("seed").and_then(Value::as_integer);
        Self {
            question: words("question").unwrap_or_default().to_owned(),
            expected: words("expected").unwrap_or_default().to_owned(),
            seed: seed.map_or(0, |seed| seed as u64),
            toml,
            content,
            ..Self::default()
        }
    }
}

/// Table file without a static row type, so that files of different tables can be in one list.
pub trait AnyFile: Sync {
    /// Returns the description of the table file; see [`File::about`].
    fn about(&self) -> FileAbout;

    /// Reads the table from a result folder.
    ///
    /// # Errors
    /// If the file cannot be read or is not a table of this kind.
    fn read(&self, folder: &Path) -> Result<Table>;
}

impl<R: Columns> AnyFile for File<R> {
    fn about(&self) -> FileAbout {
        self.about()
    }

    fn read(&self, folder: &Path) -> Result<Table> {
        self.read(folder)
    }
}

/// Table files that studies of a kind write.
#[derive(Clone, Copy)]
pub struct TableFiles {
    /// Table files that every study of the kind writes.
    pub always: &'static [&'static dyn AnyFile],
    /// Table files that are written only if the study has certain optional parts.
    pub of_parts: &'static [&'static dyn AnyFile],
}

impl TableFiles {
    /// Creates a list of table files that every study of the kind writes; there are no optional files.
    pub const fn always(always: &'static [&'static dyn AnyFile]) -> Self {
        let of_parts = &[];
        Self { always, of_parts }
    }

    /// Returns the names of all table files that a study may write.
    pub fn names(&self) -> Vec<&'static str> {
        let files = self.always.iter().chain(self.of_parts);
        files.map(|file| file.about().name).collect()
    }

    /// Reads all tables of a result folder, in the order of their files.
    ///
    /// # Errors
    /// If a table cannot be read or has other columns.
    pub fn read(&self, folder: &Path) -> Result<Vec<Table>> {
        let is_there = |file: &&&dyn AnyFile| has_table(folder, file.about().name);
        let of_parts = self.of_parts.iter().filter(is_there);
        let files = self.always.iter().chain(of_parts);
        files.map(|file| file.read(folder)).collect()
    }
}

/// Kind of study, such as recognition studies. The engine runs, resumes, shards, merges, plans, verifies and reports studies of any kind.
pub trait Study: Send + Sized + Sync + 'static {
    /// Description of the kind of study.
    const ABOUT: About;

    /// Version of a kind from outside of this crate, 1 to 64 letters (A–Z, a–z), digits, `_`, `-` and `.`. Results of another version are not continued. Kinds of
    /// this crate have the version of the program.
    const VERSION: &'static str = "";

    /// Table files to which a study writes its results.
    const TABLES: TableFiles;

    /// Charts of the tables, the most important one first.
    const CHARTS: &'static [Chart] = &[];

    /// Specification of a study: the keys that its file may have.
    type Spec: Described + Serialize;

    /// Type of the result rows of a work item.
    type Rows: ItemRows;

    /// Returns the descriptions of all keys of the kind's study files, in the order of a file. Without another implementation, only the keys of the kind's own
    /// table may be swept.
    fn keys() -> Vec<KeyAbout> {
        keys_without_axes(keys_of::<Self::Spec>(), &[Self::ABOUT.table])
    }

    /// Reads and checks a study, and loads its objects.
    ///
    /// # Errors
    /// If a key is unknown or out of its range, or a file cannot be read. The error names the place, the key and the allowed values.
    fn load(source: &Source) -> Result<Self>;

    /// Returns the facts about the study: the content of its file and of the files that it refers to.
    ///
    /// # Errors
    /// If a file that the study depends on cannot be read.
    fn facts(&self) -> Result<Facts>;

    /// Returns the size of the study: numbers of objects, touches and configurations, and memory.
    fn scale(&self) -> Scale;

    /// Lists all work items of the study, in the order of their rows.
    fn work_items(&self) -> Vec<WorkItem>;

    /// Checks what the pending work items need of the running program, such as the code of a classifier. Nothing has been written when this function is called.
    /// Returns an error for each program that this machine lacks and another machine may have.
    ///
    /// # Errors
    /// If the running program cannot compute a pending work item on any machine.
    fn check(&self, _pending: &PendingItems<Self::Rows>) -> Result<Vec<Error>> {
        Ok(Vec::new())
    }

    /// Computes the pending work items, in any order and on any threads. Data that several items share are computed only if one of these items is pending.
    ///
    /// # Errors
    /// If the journal cannot be written, or data that all items need cannot be computed. If a work item fails and the first failure ends the run.
    fn measure(&self, pending: &PendingItems<Self::Rows>) -> Result<()>;

    /// Sets the values in a work item's rows that depend on the item's number, such as configuration numbers. Rows in the journal may come from a run with
    /// other axes, in which the work item had another number.
    fn place(&self, _number: usize, _rows: &mut Self::Rows) {}

    /// Returns a description of the work item with the given number, for failure messages.
    fn item_words(&self, _number: usize, item: &WorkItem) -> String {
        item.name.clone()
    }

    /// Creates the result tables from the rows of all work items that did not fail. Tables that are computed from others, without a file, are last.
    ///
    /// # Errors
    /// If a file that the tables need cannot be read.
    fn tables(&self, rows: Self::Rows) -> Result<Vec<Table>>;

    /// Reads all tables of a result folder, in the order in which [`Study::tables`] creates them.
    ///
    /// # Errors
    /// If a table cannot be read or has other columns.
    fn read_tables(folder: &Path) -> Result<Vec<Table>> {
        Self::TABLES.read(folder)
    }

    /// Returns the charts of the result tables, the most important one first. Without another implementation, these are the constant charts of the kind.
    fn charts(&self, tables: &[Table]) -> Vec<ChartSpec> {
        let specs = Self::CHARTS.iter().map(|chart| chart.specs(tables));
        specs.flatten().collect()
    }

    /// Returns answers as sentences, computed from the result tables. They are shown at the top of the page and at the end of the run.
    fn answers(&self, _tables: &[Table]) -> Vec<String> {
        Vec::new()
    }

    /// Returns the text that the terminal shows at the end of a run, wrapped at `width` characters. Without another implementation, it consists of the first
    /// table that has a value column, and the answers.
    fn summary(&self, tables: &[Table], width: usize) -> String {
        words_of(first_found(tables).as_slice(), &self.answers(tables), width)
    }

    /// Returns further pictures and sections for the page of the results.
    ///
    /// # Errors
    /// If a picture cannot be drawn.
    fn beyond(&self, _tables: &[Table]) -> Result<Beyond> {
        Ok(Beyond::default())
    }
}

/// Returns the settings of a configuration as text, such as `taxels = 8, dt_s = 0.001`; settings without a value are left out.
pub(crate) fn settings_words(configuration: &impl Serialize) -> String {
    let settings = serde_json::to_value(configuration).unwrap_or_default();
    let settings = settings.as_object().into_iter().flatten();
    let settings = settings.filter(|(_, value)| !value.is_null());
    let words =
        settings.map(|(key, value)| format!("{key} = {}", value.to_string().trim_matches('"')));
    words.collect::<Vec<_>>().join(", ")
}

/// Returns one work item for each configuration of a study. The configurations, with the further inputs of their items, contain the values of all swept keys, and
/// no numbers of configurations.
pub fn work_items_of<'a, S: Study, C: Serialize + 'a, I: Serialize>(
    spec: &S::Spec,
    configurations: impl IntoIterator<Item = (&'a C, I)>,
) -> Vec<WorkItem> {
    let shared = shared_inputs(spec, &S::keys());
    let items = configurations.into_iter().enumerate();
    let items = items.map(|(group, (configuration, further))| {
        let inputs = (&shared, configuration, further);
        WorkItem::of(settings_words(configuration), group, &inputs)
    });
    items.collect()
}

/// Returns the keys of a study that are inputs of all its work items. The words of the study are no inputs. Swept keys and lists of tables are inputs of single
/// work items, which have one of their values or entries.
pub fn shared_inputs(spec: &impl Serialize, keys: &[KeyAbout]) -> toml::Table {
    let mut table = toml_text::table(&toml_text::write(spec)).unwrap_or_default();
    for words in ["question", "expected"] {
        table.remove(words);
    }
    for key in keys {
        remove_own(&mut table, key.path, key.axis == AxisPlace::Table);
    }
    table
}

/// Removes a swept key from a table, or the list of tables that contains the key; `path` is the path of the key within the table.
fn remove_own(table: &mut toml::Table, path: &str, is_swept: bool) {
    let (first, rest) = path.split_once('.').unwrap_or((path, ""));
    let is_list = match table.get_mut(first) {
        Some(Value::Table(inner)) if !rest.is_empty() => {
            return remove_own(inner, rest, is_swept);
        }
        value => value.is_some_and(|value| value.is_array()),
    };
    if (rest.is_empty() && is_swept) || (!rest.is_empty() && is_list) {
        table.remove(first);
    }
}

/// Computes the work items of a study that the options select.
///
/// # Errors
/// If the journal cannot be written, a work item fails and the first failure ends the run, or the computation fails as a whole.
pub(crate) fn run_items<S: Study>(
    study: &S,
    items: &[WorkItem],
    options: &RunOptions,
) -> Result<(S::Rows, Vec<ItemFailure>)> {
    let pending = PendingItems::new(items, options);
    options.progress.expect(pending.n());
    if pending.n() > 0 {
        study.check(&pending)?;
        study.measure(&pending)?;
    }
    Ok(pending.into_rows(
        |number, rows| study.place(number, rows),
        |number| study.item_words(number, &items[number]),
    ))
}

/// Runs a whole study without a journal; the first failed work item ends the run.
///
/// # Errors
/// If an item fails; returns the error of the first item that failed.
pub fn run_whole<S: Study>(study: &S, progress: &dyn Progress) -> Result<S::Rows> {
    let items = study.work_items();
    Ok(run_items(study, &items, &RunOptions::whole(progress))?.0)
}
