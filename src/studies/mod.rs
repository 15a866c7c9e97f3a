//! The kinds of study: a folder each, and a line each in `KINDS`.
//!
//! A kind says which [work items](crate::engine::work_items) a study has and measures them, and gives tables, charts, pictures and answers
//! ([`Study`]). [`AnyStudy`] is what all commands see of a study: whatever can be done with one kind can be done with all.

pub(crate) mod any_study;
pub(crate) mod ceiling;
pub(crate) mod groups;
pub(crate) mod loaded;
pub(crate) mod median_time;
pub(crate) mod model_recognition;
pub mod object_detail;
pub mod recognition;
pub mod reconstruction;
pub(crate) mod source;
pub mod stability;
pub(crate) mod study;
pub(crate) mod verified;
pub mod whole_body;

pub use crate::studies::any_study::{AnyStudy, Outcome};
pub use crate::studies::loaded::Loaded;
pub use crate::studies::source::Source;
pub use crate::studies::study::{
    About, AnyFile, Facts, Findings, Resumes, Study, TableFiles, run_whole,
};

use crate::studies::groups::{found_and_cost, grouped};

use crate::engine::axes::AxisValues;
use crate::error::{Error, Result};
use crate::files::{OwnedFiles, RUN, with_folder};
use crate::inputs::check::Check;
use crate::report::csv_tables::FAILURES_FILE;
use crate::studies::recognition::plan::study_plan::Plan;
use crate::table::Table;
use crate::toml_numbers::with_line;
use crate::toml_text;
use std::path::Path;

/// A kind, for those who do not know which.
struct Entry {
    about: About,
    load: fn(&Source) -> Result<Box<dyn AnyStudy>>,
    tables: TableFiles,
}

/// All kinds.
const KINDS: &[Entry] = &[
    entry::<object_detail::ObjectDetailStudy>(),
    entry::<reconstruction::ReconstructionStudy>(),
    entry::<stability::StabilityPlan>(),
    entry::<whole_body::WholeBodyPlan>(),
    RECOGNITION,
];

/// The kind of every file that no table makes another.
const RECOGNITION: Entry = entry::<recognition::study::RecognitionStudy>();

const fn entry<K: Study>() -> Entry {
    Entry {
        about: K::ABOUT,
        load: |source| Ok(Box::new(Loaded::<K>::load(source)?)),
        tables: K::TABLES,
    }
}

/// Which kind a study is of; none where no table tells.
pub fn about(text: &str) -> Option<About> {
    find(text).map(|entry| entry.about)
}

/// Reads and checks a study of any kind; one of which no table tells is taken for recognition.
///
/// # Errors
/// Those of its [`Study::load`].
pub fn load(source: &Source) -> Result<Box<dyn AnyStudy>> {
    check_removed(&source.place, &source.text)?;
    let entry = find(&source.text).unwrap_or(&RECOGNITION);
    with_folder(source.folder.clone(), || (entry.load)(source))
}

/// Reads and checks the plans of a recognition study, one for each combination of its own axes.
///
/// # Errors
/// If the study is of another kind, or a key is unknown or out of its range.
pub fn recognition_plans(source: &Source) -> Result<Vec<(AxisValues, Plan)>> {
    check_recognition(source)?;
    recognition::study::read_plans(source)
}

/// Loads a recognition study with its objects.
///
/// # Errors
/// Those of [`recognition_plans`]; an object that cannot be read; touches that memory cannot hold.
pub fn load_recognition_study(source: &Source) -> Result<recognition::study::RecognitionStudy> {
    check_recognition(source)?;
    recognition::study::load_study(source)
}

/// Refuses a study of another kind than recognition.
fn check_recognition(source: &Source) -> Result<()> {
    match about(&source.text) {
        Some(about) if about.table != RECOGNITION.about.table => {
            let recognition = RECOGNITION.about.words;
            let allowed = format!("{recognition} (bubbletouch run runs all kinds)");
            Err(Error::input(&source.place, about.words, allowed))
        }
        _ => Ok(()),
    }
}

/// Checks before a study is loaded that a folder can take its results: no file that the run writes is of somebody else.
///
/// # Errors
/// If the folder has such a file, or one that this command has read; the error names the file.
pub fn check_folder(study: &str, folder: &Path) -> Result<()> {
    let entry = find(study).unwrap_or(&RECOGNITION);
    let tables = entry.tables.names().into_iter().chain([FAILURES_FILE]);
    OwnedFiles::read(folder, RUN)?.check_results(tables)
}

/// The tables of a folder of results of any kind, and which kind that is. Nothing that the study is about is loaded.
///
/// # Errors
/// A folder without a study; a table that cannot be read, or has other columns.
pub fn read_tables(folder: &Path) -> Result<(About, Vec<Table>)> {
    let Source { place, text, .. } = Source::of_results(folder)?;
    check_removed(&place, &text)?;
    let entry = find(&text).unwrap_or(&RECOGNITION);
    Ok((entry.about, entry.tables.read(folder)?))
}

/// Returns the table of the work items of a folder that failed, or `None` if it has no such table or none failed.
///
/// # Errors
/// A table that cannot be read, or has other columns.
pub fn read_failures(folder: &Path) -> Result<Option<Table>> {
    let found = loaded::FAILURES.read_if_there(folder)?;
    Ok(found.filter(|failures| failures.n_rows > 0))
}

/// Tables of studies of a kind that exists no more, and what takes its place.
const REMOVED: [(&str, &str); 2] = [
    (
        "speed_accuracy",
        "a recognition study (pareto.csv: accuracy and its time), [object_detail] (error and time of models of objects) or [stability] \
         (engines and time steps)",
    ),
    (
        "breaking_points",
        "a recognition study with the same keys in [axes] and combine = \"one_at_a_time\" (\"test.touches.depth_mm\" drives test touches alone); \
         robustness.csv says where half of the accuracy is lost",
    ),
];

/// Refuses a study of a kind that exists no more.
fn check_removed(place: &str, text: &str) -> Result<()> {
    let table = toml_text::table(text).unwrap_or_default();
    match REMOVED.iter().find(|(key, _)| table.contains_key(*key)) {
        Some((key, instead)) => {
            let check = Check { place };
            let error = check.error(key, "a kind of study that exists no more", instead);
            Err(with_line(place, text, error))
        }
        None => Ok(()),
    }
}

/// Text that is not TOML is told so by whoever reads the study.
fn find(text: &str) -> Option<&'static Entry> {
    let table = toml_text::table(text)?;
    let mut kinds = KINDS.iter();
    kinds.find(|entry| table.contains_key(entry.about.table))
}
