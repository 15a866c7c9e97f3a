//! A kind of study: the trait that all of them implement, and what they say of themselves.

use crate::engine::progress::Progress;
use crate::engine::work_items::{
    ItemFailure, ItemRows, PendingItems, RunOptions, Scale, StudyRun, WorkItem,
};
use crate::error::Result;
use crate::report::study_content::Beyond;
use crate::studies::source::Source;
use crate::table::{ChartSpec, Columns, File, Table};
use crate::toml_text;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// What a kind of study is, before any study of it is read.
#[derive(Clone, Copy, Debug)]
pub struct About {
    /// The table of a study's file that only this kind has.
    pub table: &'static str,
    /// In words: `a study that …`.
    pub words: &'static str,
    /// Which studies go on with each other's work.
    pub resumes: Resumes,
}

/// Which studies of a kind go on with each other's work.
#[derive(Clone, Copy, Debug)]
pub enum Resumes {
    /// Studies that differ at most in these keys, with all below them: words, or keys that tell which work there is and not what comes of any of it.
    ButFor(&'static [&'static str]),
    /// Studies that share work items with results: the name of an item is made of all its inputs.
    SharedWork,
}

/// What a study's file says, and what that is about.
#[derive(Clone, Debug, Default)]
pub struct Facts {
    /// The study with every default spelt out, as TOML.
    pub toml: String,
    /// What it asks.
    pub question: String,
    /// What was expected before it ran; may be empty.
    pub expected: String,
    /// Root of all randomness; 0 where nothing is random.
    pub seed: u64,
    /// SHA-256 of what the study's text does not say: objects and other files, by name.
    pub content: BTreeMap<String, String>,
    /// How intervals and p-values are made, by table and columns.
    pub methods: Vec<(&'static str, &'static str)>,
}

impl Facts {
    /// Of a study as it is written, and of what that does not say.
    pub fn of(spec: &impl Serialize, content: BTreeMap<String, String>) -> Self {
        Self::of_toml(toml_text::write(spec), content)
    }

    /// Of its TOML with every default: question, expected and seed stand in it.
    pub fn of_toml(toml: String, content: BTreeMap<String, String>) -> Self {
        let table = toml_text::table(&toml).unwrap_or_default();
        let words = |key| table.get(key).and_then(toml::Value::as_str);
        let seed = table.get("seed").and_then(toml::Value::as_integer);
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

/// A [`File`] of rows of any type.
pub trait AnyFile: Sync {
    /// See [`File::name`].
    fn name(&self) -> &'static str;

    /// See [`File::read`].
    ///
    /// # Errors
    /// Those of it.
    fn read(&self, folder: &Path) -> Result<Table>;

    /// See [`File::read_if_there`].
    ///
    /// # Errors
    /// Those of it.
    fn read_if_there(&self, folder: &Path) -> Result<Option<Table>>;
}

impl<R: Columns> AnyFile for File<R> {
    fn name(&self) -> &'static str {
        self.name()
    }

    fn read(&self, folder: &Path) -> Result<Table> {
        self.read(folder)
    }

    fn read_if_there(&self, folder: &Path) -> Result<Option<Table>> {
        self.read_if_there(folder)
    }
}

/// The files of a study's tables.
#[derive(Clone, Copy)]
pub enum TableFiles {
    /// Files that every study of the kind writes, in their order, and behind them those of parts that a study may leave out.
    Listed {
        /// Files that are always there.
        always: &'static [&'static dyn AnyFile],
        /// Files of parts that a study may leave out.
        of_parts: &'static [&'static dyn AnyFile],
    },
    /// Tables whose columns depend on the study.
    Own {
        /// Names of all files that a study may write.
        names: &'static [&'static str],
        /// Reads the tables of a folder.
        read: fn(&Path) -> Result<Vec<Table>>,
    },
}

impl TableFiles {
    /// Tables in files that every study of the kind writes.
    pub const fn always(always: &'static [&'static dyn AnyFile]) -> Self {
        Self::Listed {
            always,
            of_parts: &[],
        }
    }

    /// Returns the names of all table files that a study may write.
    pub fn names(&self) -> Vec<&'static str> {
        match self {
            Self::Listed { always, of_parts } => {
                let files = always.iter().chain(*of_parts);
                files.map(|file| file.name()).collect()
            }
            Self::Own { names, .. } => names.to_vec(),
        }
    }

    /// Reads the tables of a folder in the order of [`Study::tables`].
    ///
    /// # Errors
    /// If a table cannot be read or has other columns.
    pub fn read(&self, folder: &Path) -> Result<Vec<Table>> {
        match self {
            Self::Listed { always, of_parts } => {
                let files = always.iter().map(|file| file.read(folder).map(Some));
                let of_parts = of_parts.iter().map(|file| file.read_if_there(folder));
                files
                    .chain(of_parts)
                    .filter_map(Result::transpose)
                    .collect()
            }
            Self::Own { read, .. } => read(folder),
        }
    }
}

/// Findings of a study: what the page and the terminal show of its tables.
#[derive(Default)]
pub struct Findings {
    /// Charts, the most important first.
    pub charts: Vec<ChartSpec>,
    /// Answers in sentences: at the top of the page and at the end of the run.
    pub answers: Vec<String>,
    /// Notes of tables, by the name of their file.
    pub notes: Vec<(&'static str, String)>,
    /// Makes the text at the end of a run, wrapped at a number of characters. `None`: the first table with a found value, and the answers.
    pub summary: Option<fn(&[Table], usize) -> String>,
}

/// A kind of study. The engine does the rest: it runs, keeps, resumes, shards, merges, plans, verifies and reports studies.
pub trait Study: Send + Sized + Sync + 'static {
    /// The kind.
    const ABOUT: About;

    /// The files of [`tables`](Self::tables).
    const TABLES: TableFiles;

    /// Rows that a work item gives.
    type Rows: ItemRows;

    /// Reads and checks a study, and loads its objects.
    ///
    /// # Errors
    /// If a key is unknown or out of its range, or a file cannot be read. The error names place, key and what is allowed.
    fn load(source: &Source) -> Result<Self>;

    /// Returns the content of the study's file and of what it refers to.
    ///
    /// # Errors
    /// If a file that the study depends on cannot be read.
    fn facts(&self) -> Result<Facts>;

    /// Returns the size of the study: counts and memory.
    fn scale(&self) -> Scale;

    /// Lists all work items in the order of their rows.
    fn work_items(&self) -> Vec<WorkItem>;

    /// Computes the pending items, in any order and on any threads. What several items need is made for pending items only.
    ///
    /// # Errors
    /// Those of [`PendingItems::finish`], or of what no item can do without.
    fn measure(&self, pending: &PendingItems<Self::Rows>) -> Result<()>;

    /// Sets in the rows of an item what its number decides, such as numbers of configurations: rows in the journal may be of a study with other axes.
    fn place(&self, _number: usize, _rows: &mut Self::Rows) {}

    /// Describes an item, by its number, for failures.
    fn item_words(&self, _number: usize, item: &WorkItem) -> String {
        item.name.clone()
    }

    /// Makes the tables from the rows of all items that did not fail.
    ///
    /// # Errors
    /// If a file that the tables need cannot be read.
    fn tables(&self, rows: Self::Rows) -> Result<Vec<Table>>;

    /// Returns charts and answers for the tables.
    ///
    /// # Errors
    /// If a file that the findings need cannot be read.
    fn findings(&self, tables: &[Table]) -> Result<Findings>;

    /// Returns pictures that are no charts, and further sections of the page.
    ///
    /// # Errors
    /// If a picture cannot be made.
    fn beyond(&self, _tables: &[Table]) -> Result<Beyond> {
        Ok(Beyond::default())
    }
}

/// Computes all items of a study that the options select; see [`StudyRun::run`].
///
/// # Errors
/// Those of [`StudyRun::run`].
pub(crate) fn run_items<S: Study>(
    study: &S,
    items: &[WorkItem],
    options: &RunOptions,
) -> Result<(S::Rows, Vec<ItemFailure>)> {
    StudyRun::new(items, options).run(
        |pending| study.measure(pending),
        |number, rows| study.place(number, rows),
        |number| study.item_words(number, &items[number]),
    )
}

/// Runs a whole study at once without a journal; the first item that fails ends the run.
///
/// # Errors
/// The error of the item that failed.
pub fn run_whole<S: Study>(study: &S, progress: &dyn Progress) -> Result<S::Rows> {
    let items = study.work_items();
    Ok(run_items(study, &items, &RunOptions::whole(progress))?.0)
}
