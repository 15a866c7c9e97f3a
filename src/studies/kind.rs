//! What a kind of study says of itself.

use crate::engine::work_items::scale::Scale;
use crate::engine::work_items::study_runner::StudyRunner;
use crate::error::Result;
use crate::report::page::Section;
use crate::report::study_content::NamedPicture;
use crate::report::study_folder::{first_found, words_of};
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
    /// Keys, with all below them, that may change while finished work is kept: they are words, or they say which work there is and
    /// not what comes of any of it, since each work item goes by all that it depends on.
    pub may_change: &'static [&'static str],
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

/// Files of tables, in their order.
pub type Files = &'static [&'static dyn AnyFile];

/// A kind of study. The engine does all else: it runs, keeps, resumes, deals out, merges, plans, verifies and reports it.
pub trait Kind: Send + StudyRunner + Findings + Sized + Sync + 'static {
    /// Which it is.
    const ABOUT: About;

    /// The files of [`StudyRunner::tables`].
    const FILES: Files = &[];

    /// Those behind them, of parts that a study may leave out.
    const FILES_OF_PARTS: Files = &[];

    /// Names of all table files that a study of this kind may write.
    fn table_names() -> Vec<&'static str> {
        let files = Self::FILES.iter().chain(Self::FILES_OF_PARTS);
        files.map(|file| file.name()).collect()
    }

    /// Reads and checks a study, and loads its objects.
    ///
    /// # Errors
    /// A key that is not known or out of its range; a file that cannot be read. The error names place, key and what is allowed.
    fn load(source: &Source) -> Result<Self>;

    /// What its file says.
    ///
    /// # Errors
    /// A file that the study depends on cannot be read.
    fn facts(&self) -> Result<Facts>;

    /// How large it is.
    fn scale(&self) -> Scale;

    /// The tables of [`StudyRunner::tables`], from the files of a folder; those of parts that a study may leave out, where there are any.
    ///
    /// # Errors
    /// A table that cannot be read, or has other columns.
    fn read(folder: &Path) -> Result<Vec<Table>> {
        let files = Self::FILES.iter().map(|file| file.read(folder).map(Some));
        let of_parts = Self::FILES_OF_PARTS.iter();
        let of_parts = of_parts.map(|file| file.read_if_there(folder));
        let tables = files.chain(of_parts).filter_map(Result::transpose);
        tables.collect()
    }

    /// The same, with what this study says of them.
    ///
    /// # Errors
    /// Those of [`read`](Self::read).
    fn read_tables(&self, folder: &Path) -> Result<Vec<Table>> {
        Self::read(folder)
    }
}

/// What a study found, for whoever reads it.
pub trait Findings {
    /// What is charted, the most telling first.
    fn charts(&self, tables: &[Table]) -> Vec<ChartSpec>;

    /// Pictures that are no charts: frames, bodies, objects.
    ///
    /// # Errors
    /// What is shown cannot be made again or drawn.
    fn pictures(&self, _tables: &[Table]) -> Result<Vec<NamedPicture>> {
        Ok(Vec::new())
    }

    /// What its page has beside that of any study.
    ///
    /// # Errors
    /// What is shown cannot be made again or drawn.
    fn sections(&self, _tables: &[Table]) -> Result<Vec<Section>> {
        Ok(Vec::new())
    }

    /// What a person reads at the end of a run below the question, in lines of about `width` letters.
    fn summary(&self, tables: &[Table], width: usize) -> String {
        words_of(first_found(tables).as_slice(), &self.answers(tables), width)
    }

    /// What was found, in sentences: at the top of the page and at the end of the run.
    fn answers(&self, tables: &[Table]) -> Vec<String>;
}
