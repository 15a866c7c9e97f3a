//! A study's folder: everything that people open after a run of recognition.

use crate::error::Result;
use crate::report::folder::Folder;
use crate::report::page::{ReportPage, StudyAbout};
use crate::report::recognition::{answers, charts, sections, tables_of};
use crate::report::snapshots::snapshots;
use crate::report::study_folder::{Found, folder_with};
use crate::study::table::Tables;
use crate::table::Table;
use std::path::{Path, PathBuf};

/// Writes tables, charts, pictures and the page into `dir` (created if missing); returns the paths in the order of
/// writing, tables first.
///
/// Everything is drawn before the first file is written, and each file is whole or not there. Files of other names in the
/// folder are left alone.
///
/// # Errors
/// What cannot be drawn, or written as a table; a file that cannot be written.
pub fn write_all(dir: &Path, tables: &Tables, about: &ReportPage) -> Result<Vec<PathBuf>> {
    all_files(dir, tables, about)?.write()
}

/// What [`write_all`] writes, before it is written.
///
/// # Errors
/// What cannot be drawn, or written as a table.
pub fn all_files<'a>(dir: &'a Path, tables: &Tables, about: &ReportPage) -> Result<Folder<'a>> {
    let tables = tables_of(tables, &about.limits)?;
    let mut folder = Folder::of_tables(dir, &tables);
    folder.append(page_of(dir, &tables, about)?);
    Ok(folder)
}

/// Writes charts, pictures and the page into a folder that has the tables; as [`write_all`].
///
/// # Errors
/// Those of [`write_all`].
pub fn write_page(dir: &Path, tables: &[Table], about: &ReportPage) -> Result<Vec<PathBuf>> {
    page_of(dir, tables, about)?.write()
}

/// Charts, pictures and the page.
fn page_of<'a>(dir: &'a Path, tables: &[Table], about: &ReportPage) -> Result<Folder<'a>> {
    let found = Found {
        tables,
        charts: &charts(tables, about.pareto),
        pictures: &[],
        answers: &answers(tables),
    };
    let study = StudyAbout {
        name: about.name.clone(),
        question: about.question.clone(),
        expected: about.expected.clone(),
        wall_s: about.wall_s.unwrap_or(f64::NAN),
        command: about.command.clone(),
        program: about.program.clone(),
        manifest: about.manifest.clone(),
        all_charts: about.all_charts,
    };
    let mut folder = folder_with(dir, &study, &found, sections(about, tables)?)?;
    if let Some(set) = &about.snapshots {
        let drawing = snapshots(&set.frames, set.pitch_mm, set.quantity, &set.caption)?;
        // As SVG, ten thousand noisy taxels would be a megabyte.
        folder.add_png("snapshots.png", &drawing);
    }
    Ok(folder)
}
