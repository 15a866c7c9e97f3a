//! Kinds of studies: one folder and one entry in `KINDS` for each kind. A program [registers] kinds of its own.
//!
//! [registers]: register
//!
//! A kind of study ([`Study`]) lists the work items of a study, computes them, and makes tables, charts, pictures and answers. All
//! commands use [`AnyStudy`], so that every command works with every kind.

pub(crate) mod loaded;
pub mod object_detail;
pub mod prelude;
pub mod recognition;
pub mod reconstruction;
mod shared_steps;
pub(crate) mod source;
pub mod stability;
pub(crate) mod study;
#[cfg(test)]
mod tests;
pub mod whole_body;

pub use crate::studies::loaded::Loaded;
pub use crate::studies::source::Source;
pub use crate::studies::study::{
    About, AnyFile, AnyStudy, Facts, Outcome, Study, TableFiles, run_whole,
};

use crate::error::{Error, Result};
use crate::files::{OwnedFiles, RUN, with_folder};
use crate::inputs::keys::KeyAbout;
use crate::inputs::params::Described;
use crate::report::csv_tables::FAILURES_FILE;
use crate::table::{FileAbout, Table};
use crate::toml_text;
use bubbletouch_sim::own::{Own, Registry};
use std::path::Path;

/// Registry entry of a kind of study, without static type, so that all kinds are in one list.
pub(crate) struct Entry {
    /// Description of the kind of study.
    pub about: About,
    load: fn(&Source) -> Result<Box<dyn AnyStudy>>,
    /// Table files that a study of the kind writes.
    pub tables: TableFiles,
    read_tables: fn(&Path) -> Result<Vec<Table>>,
    /// Function that returns the JSON Schema of the kind's study files.
    pub schema: fn() -> serde_json::Value,
    /// Function that returns the descriptions of all keys that a study file of the kind may have.
    pub keys: fn() -> Vec<KeyAbout>,
}

/// Kinds of studies of this program.
const KINDS: &[Entry] = &[
    entry::<object_detail::ObjectDetailStudy>(),
    entry::<reconstruction::ReconstructionStudy>(),
    entry::<stability::StabilityPlan>(),
    entry::<whole_body::WholeBodyPlan>(),
    RECOGNITION,
];

/// Kinds of studies that a program has registered.
static OWN: Registry<Entry> = Registry::new("kind of study");

/// Registers a kind of study from outside of this crate, before the first study is read. All functions and commands then know it by the table of its
/// [`About`]. Results of another [`Study::VERSION`] are not continued.
///
/// # Errors
/// If another kind has the table, the version is invalid, or a study was read before.
pub fn register<K: Study>() -> Result<()> {
    let table = K::ABOUT.table;
    let is_taken = KINDS.iter().any(|entry| entry.about.table == table);
    OWN.register(table, K::VERSION, entry::<K>(), is_taken)?;
    Ok(())
}

/// Returns the entries of all kinds, registered ones first and recognition last.
pub(crate) fn entries() -> impl DoubleEndedIterator<Item = &'static Entry> {
    OWN.all().iter().map(Own::about).chain(KINDS)
}

/// Default kind of study: a file without a table of another kind describes a recognition study.
const RECOGNITION: Entry = entry::<recognition::study::RecognitionStudy>();

const fn entry<K: Study>() -> Entry {
    Entry {
        about: K::ABOUT,
        load: |source| Ok(Box::new(Loaded::<K>::load(source)?)),
        tables: K::TABLES,
        read_tables: K::read_tables,
        schema: K::Spec::schema,
        keys: K::keys,
    }
}

/// Returns the description of the table of failed work items, which every study may write.
pub(crate) fn failures_about() -> FileAbout {
    loaded::FAILURES.about()
}

/// Name of the table that only recognition studies have.
pub(crate) const RECOGNITION_TABLE: &str = RECOGNITION.about.table;

/// Returns the description of the kind of a study, given the text of the study file. Returns `None` if the file has no table that identifies a kind.
pub fn about(text: &str) -> Option<About> {
    find(text).map(|entry| entry.about)
}

/// Returns the descriptions of all keys of a kind of study; `kind` is a name such as `recognition` or `stability`. Returns `None` if there is no such kind.
pub fn keys(kind: &str) -> Option<Vec<KeyAbout>> {
    let entry = entries().find(|entry| entry.about.table == kind)?;
    Some((entry.keys)())
}

/// Returns the names of the tables that identify the kinds of studies, such as `stability`. Each name is a valid argument of [`keys`].
pub fn kinds() -> impl Iterator<Item = &'static str> {
    entries().map(|entry| entry.about.table)
}

/// Reads and checks a study of any kind. If its file has no table that identifies a kind, the file is read as a recognition study.
///
/// # Errors
/// If a key is unknown or out of its range, or a file cannot be read.
pub fn load(source: &Source) -> Result<Box<dyn AnyStudy>> {
    let entry = find(&source.text).unwrap_or(&RECOGNITION);
    with_folder(source.folder.clone(), || (entry.load)(source))
}

/// Returns an error if the study is of another kind than recognition.
pub(crate) fn check_recognition(source: &Source) -> Result<()> {
    match about(&source.text) {
        Some(about) if about.table != RECOGNITION.about.table => {
            let recognition = RECOGNITION.about.words;
            let allowed = format!("{recognition} (bubbletouch run runs all kinds)");
            Err(Error::input(&source.place, about.words, allowed))
        }
        _ => Ok(()),
    }
}

/// Checks before a study is loaded that its results can be written to a folder without replacing files that another program or a user wrote.
///
/// # Errors
/// If the folder contains such a file, or a file that this command has read; the error names the file.
pub fn check_folder(study: &str, folder: &Path) -> Result<()> {
    let entry = find(study).unwrap_or(&RECOGNITION);
    let tables = entry.tables.names().into_iter().chain([FAILURES_FILE]);
    OwnedFiles::read(folder, RUN)?.check_results(tables)
}

/// Reads all tables of a result folder of any kind of study; also returns the description of the kind. Files to which the study refers are not loaded.
///
/// # Errors
/// If the folder has no study, or a table cannot be read or has other columns.
pub fn read_tables(folder: &Path) -> Result<(About, Vec<Table>)> {
    let entry = find(&Source::of_results(folder)?.text).unwrap_or(&RECOGNITION);
    Ok((entry.about, (entry.read_tables)(folder)?))
}

/// Returns the table of failed work items in a result folder, or `None` if no item failed.
///
/// # Errors
/// If the table cannot be read or has other columns.
pub fn read_failures(folder: &Path) -> Result<Option<Table>> {
    let found = loaded::FAILURES.read_if_there(folder)?;
    Ok(found.filter(|failures| failures.n_rows > 0))
}

/// Returns the kind of study to which a study file's text belongs; `None` if no table of the file identifies a kind. Also returns `None` for invalid TOML,
/// which the reader of the study reports.
fn find(text: &str) -> Option<&'static Entry> {
    let table = toml_text::table(text)?;
    entries().find(|entry| table.contains_key(entry.about.table))
}
