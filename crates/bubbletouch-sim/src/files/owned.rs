//! Files of an output folder that the program wrote and may therefore replace.

use super::inputs::check_output;
use super::whole_file::write_bytes;
use crate::error::{Error, Result};
use serde_json::{Map, Value};
use std::collections::BTreeSet;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Name of the manifest in an output folder.
pub const MANIFEST_FILE: &str = "manifest.json";

/// Name of the subcommand that writes the result folders of studies.
pub const RUN: &str = "run";

/// Keys of the file lists in a manifest; the keys of each list are file names.
const LISTS: [&str; 4] = ["tables_sha256", "times_sha256", "files_sha256", "files"];

/// Files that one subcommand wrote into a folder, as listed in the folder's manifest.
#[derive(Clone, Debug)]
pub struct OwnedFiles {
    folder: PathBuf,
    names: BTreeSet<String>,
    /// Whether the folder has a manifest.
    has_manifest: bool,
    /// Whether the manifest has an old version that lists only tables. Charts and the page are then recognised by their extensions.
    lists_tables_only: bool,
}

impl OwnedFiles {
    /// Reads the manifest of a folder for the subcommand `writer`. Without a manifest, no file of the folder is owned.
    ///
    /// # Errors
    /// If the manifest is invalid, or was written by another program or another subcommand.
    pub fn read(folder: &Path, writer: &str) -> Result<Self> {
        let path = folder.join(MANIFEST_FILE);
        let mut owned = Self {
            folder: folder.to_owned(),
            names: BTreeSet::new(),
            has_manifest: false,
            lists_tables_only: false,
        };
        let text = match fs::read(&path) {
            Err(error)
                if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) =>
            {
                return Ok(owned);
            }
            text => text.map_err(|e| Error::unreadable(&path, "a manifest of this program", e))?,
        };
        let allowed = "another folder: this one is not of this program";
        let manifest: Option<Value> = serde_json::from_slice(&text).ok();
        let Some(manifest) = manifest.filter(is_ours) else {
            let given = "is no manifest of bubbletouch";
            return Err(Error::input(path.display(), given, allowed));
        };
        let written_by = manifest.get("written_by").and_then(Value::as_str);
        let written_by = written_by.unwrap_or(RUN);
        if written_by != writer {
            let given = format!("the folder is one of bubbletouch {written_by}");
            let allowed = format!("another folder for bubbletouch {writer}");
            return Err(Error::input(path.display(), given, allowed));
        }
        let lists = LISTS
            .iter()
            .filter_map(|list| manifest.get(*list)?.as_object());
        owned
            .names
            .extend(lists.flat_map(|list| list.keys().cloned()));
        owned.names.insert(MANIFEST_FILE.to_owned());
        if writer == RUN {
            let of_all = ["study.toml", "report.html"];
            owned.names.extend(of_all.map(str::to_owned));
            owned.lists_tables_only = manifest.get("files_sha256").is_none();
        }
        owned.has_manifest = true;
        Ok(owned)
    }

    /// Returns an error unless each file with one of these names is absent or owned by the program.
    ///
    /// # Errors
    /// If a file was not written by the program, is a link, or is an input of this command; the error names the file.
    pub fn check<'a>(&self, names: impl IntoIterator<Item = &'a str>) -> Result<()> {
        for name in names {
            let path = self.folder.join(name);
            let Ok(meta) = fs::symlink_metadata(&path) else {
                continue;
            };
            check_output(&path)?;
            if !self.owns(name) {
                return Err(foreign(&path));
            }
            if !meta.is_file() {
                let given = "is no file of its own, but a link or a folder";
                let allowed = "a file that this program wrote; nothing was written";
                return Err(Error::input(path.display(), given, allowed));
            }
        }
        Ok(())
    }

    /// Checks, before a study runs, that its tables, page and charts can be written.
    ///
    /// The names of charts depend on the results. In a folder without a manifest, any existing picture is therefore an error.
    ///
    /// # Errors
    /// If a file was not written by the program, is a link, or is an input. If a picture exists that the program did not write.
    pub fn check_results<'a>(&self, tables: impl IntoIterator<Item = &'a str>) -> Result<()> {
        self.check(["study.toml", "report.html"])?;
        self.check(tables)?;
        let Some(entries) = fs::read_dir(&self.folder)
            .ok()
            .filter(|_| !self.has_manifest)
        else {
            return Ok(());
        };
        let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
        paths.sort();
        paths.retain(|path| is_picture(path));
        paths.first().map_or(Ok(()), |path| Err(foreign(path)))
    }

    /// Returns whether the program wrote the file with this name.
    pub fn owns(&self, name: &str) -> bool {
        self.names.contains(name) || (self.lists_tables_only && is_picture(Path::new(name)))
    }
}

/// Returns whether this program wrote a manifest.
fn is_ours(manifest: &Value) -> bool {
    let program = manifest["program"].as_str();
    program.is_some_and(|program| program.starts_with("bubbletouch"))
}

/// Returns whether a result folder contains a table of its last run. The manifest of a run lists all tables of the run. In a folder without such a manifest,
/// each file counts.
pub fn has_table(folder: &Path, name: &str) -> bool {
    let manifest = manifest_in(folder);
    let lists: Vec<&Value> = LISTS[..2]
        .iter()
        .filter_map(|list| manifest.get(list))
        .collect();
    let is_listed = lists.is_empty() || lists.iter().any(|list| list.get(name).is_some());
    is_listed && folder.join(name).exists()
}

/// Returns an error unless a single output file can be written. The file must not be an input of this command, nor belong to an output folder of another
/// command.
///
/// # Errors
/// If the file is an input or belongs to another output folder; the error names the file.
pub fn check_single_output(path: &Path) -> Result<()> {
    check_output(path)?;
    let (folder, name) = (
        path.parent(),
        path.file_name().and_then(|name| name.to_str()),
    );
    let (Some(folder), Some(name)) = (folder, name) else {
        return Ok(());
    };
    let manifest = manifest_in(folder);
    let is_listed = LISTS.iter().any(|list| manifest[*list].get(name).is_some());
    if is_ours(&manifest)
        && (is_listed || [MANIFEST_FILE, "study.toml", "report.html"].contains(&name))
    {
        let given = "is part of a folder that another command of bubbletouch wrote";
        let allowed = "another file; nothing was written";
        return Err(Error::input(path.display(), given, allowed));
    }
    Ok(())
}

/// Returns the manifest of a folder; null if there is none, or if it is invalid.
fn manifest_in(folder: &Path) -> Value {
    let manifest = fs::read(folder.join(MANIFEST_FILE)).unwrap_or_default();
    serde_json::from_slice(&manifest).unwrap_or_default()
}

fn foreign(path: &Path) -> Error {
    let given = "stands there, and no manifest.json lists it as written by this program";
    let allowed = "a new folder, or one that this command wrote; nothing was written";
    Error::input(path.display(), given, allowed)
}

fn is_picture(path: &Path) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str());
    ending.is_some_and(|ending| ["svg", "png"].contains(&ending))
}

/// Data folder of a subcommand other than `run`, with a manifest that lists its files.
#[derive(Debug)]
pub struct DataFolder {
    folder: PathBuf,
    writer: &'static str,
    files: Map<String, Value>,
}

impl DataFolder {
    /// Prepares a folder for files with these names without writing anything. `writer` is the subcommand.
    ///
    /// # Errors
    /// If the folder's manifest is invalid or belongs to another subcommand, or a file was not written by the program.
    pub fn claim<'a>(
        folder: &Path,
        writer: &'static str,
        names: impl IntoIterator<Item = &'a str> + Clone,
    ) -> Result<Self> {
        Self::claim_with(folder, writer, names, |_| false)
    }

    /// Prepares a folder for files with these names. Files that no manifest lists are also accepted if their content shows that the program wrote them.
    ///
    /// # Errors
    /// If `claim` fails for these arguments.
    pub fn claim_with<'a>(
        folder: &Path,
        writer: &'static str,
        names: impl IntoIterator<Item = &'a str> + Clone,
        is_ours: impl Fn(&[u8]) -> bool,
    ) -> Result<Self> {
        let mut owned = OwnedFiles::read(folder, writer)?;
        for name in names.clone() {
            if fs::read(folder.join(name)).is_ok_and(|bytes| is_ours(&bytes)) {
                owned.names.insert(name.to_owned());
            }
        }
        owned.check(names.clone())?;
        let absent = |name: &str| fs::symlink_metadata(folder.join(name)).is_err();
        let before = owned.names.into_iter().filter(|name| !absent(name));
        let names = names.into_iter().map(str::to_owned).chain(before);
        let names = names.filter(|name| name != MANIFEST_FILE);
        Ok(Self {
            folder: folder.to_owned(),
            writer,
            files: names
                .map(|name| (name, Value::Object(Map::new())))
                .collect(),
        })
    }

    /// Adds metadata of a file to the manifest, such as its quantity and unit.
    pub fn describe(&mut self, name: &str, facts: Value) {
        self.files.insert(name.to_owned(), facts);
    }

    /// Writes the manifest. Call this function before the files are moved to their paths. The next run may then replace the files even if the process is
    /// killed in between.
    ///
    /// # Errors
    /// If the manifest cannot be written.
    pub fn write_manifest(&self) -> Result<()> {
        let manifest = serde_json::json!({
            "program": concat!("bubbletouch ", env!("CARGO_PKG_VERSION")),
            "written_by": self.writer,
            "files": self.files,
        });
        let text = serde_json::to_string_pretty(&manifest).map_err(std::io::Error::from);
        let path = self.folder.join(MANIFEST_FILE);
        let text = text.map_err(|e| Error::io(&path, "write", e))?;
        write_bytes(&path, (text + "\n").as_bytes())
    }
}
