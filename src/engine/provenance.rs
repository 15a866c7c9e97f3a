//! Provenance of results: the program, the machine, the study and its objects.

use crate::contact::Instructions;
use crate::engine::journal::identity::Identity;
pub use crate::engine::program::{PROGRAM, SOURCE};
use crate::error::{Error, Result};
use chrono::{DateTime, SecondsFormat, Utc};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Git commit of the program's source code: `…-changed` if sources were modified after the commit, `unknown` outside a repository.
const COMMIT: &str = env!("BUBBLETOUCH_COMMIT");

/// Compiler that built the program.
const RUSTC: &str = env!("BUBBLETOUCH_RUSTC");

/// Target platform for which the program was built.
const TARGET: &str = env!("BUBBLETOUCH_TARGET");

pub use crate::files::MANIFEST_FILE;

/// Version of the names and meanings of all table columns. The version increases when a column is renamed or changes its meaning.
pub const SCHEMA: u32 = 1;

/// Name of the subcommand in the manifest of a folder that `bubbletouch report` wrote without a run.
pub const REPORT: &str = "report";

/// Content of `manifest.json`: provenance of the files in a result folder.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Name of the study; empty in manifests of earlier versions.
    #[serde(default)]
    pub study: String,
    /// Command that reproduces the result folder; empty in manifests of earlier versions.
    #[serde(default)]
    pub command: String,
    /// Folder of the study file, to which paths in the study are relative. Empty in manifests of earlier versions.
    #[serde(default)]
    pub paths_from: PathBuf,
    /// Version of the table columns ([`SCHEMA`]); 0 in folders of earlier versions, whose columns have other names.
    #[serde(default)]
    pub schema: u32,
    /// Name and version of the program that computed the results.
    pub program: String,
    /// Hash of the source code of the program that computed the results.
    pub source: String,
    /// Git commit of the source code of the program that computed the results.
    pub commit: String,
    /// Compiler that built the program that computed the results.
    pub rustc: String,
    /// Target platform of the program that computed the results.
    pub target: String,
    /// Name of the processor, or `unknown`.
    pub cpu: String,
    /// Widest vector instructions of the processor, on which the rounding of matrix products depends.
    #[serde(default)]
    pub instructions: Option<Instructions>,
    /// Number of hardware threads of the machine on which the results were computed.
    pub cores: usize,
    /// Number of threads that the last run used.
    pub threads: usize,
    /// Start time of the last run, UTC.
    pub started: String,
    /// End time of the last run, UTC.
    pub ended: String,
    /// Peak memory of the last run, bytes; `None` if the system does not report it.
    #[serde(default)]
    pub peak_memory_bytes: Option<u64>,
    /// Number of work items that were already finished when the last run started.
    pub n_finished_before: usize,
    /// Seed from which all random numbers of the study are derived.
    pub seed: u64,
    /// Number of work items of the study.
    pub n_configurations: usize,
    /// Always 1, because a trial is part of a work item; earlier versions wrote the number of trials.
    pub n_trials: usize,
    /// Number of work items that failed.
    pub n_failed: usize,
    /// SHA-256 hash of the file `study.toml`, which contains the study with all default values written out.
    pub study_sha256: String,
    /// SHA-256 hash of each object's content, by the object's name.
    pub objects_sha256: BTreeMap<String, String>,
    /// SHA-256 hash of each result table without times, by file name.
    pub tables_sha256: BTreeMap<String, String>,
    /// SHA-256 hash of each result table with times, by file name; the hashes differ between runs. Empty in manifests of earlier versions.
    #[serde(default)]
    pub times_sha256: BTreeMap<String, String>,
    /// SHA-256 hash of each chart, picture, page and other file in the folder, by file name, without the manifest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub files_sha256: Option<BTreeMap<String, String>>,
    /// Statistical methods that compute the intervals and p-values, by table and columns.
    #[serde(default)]
    pub methods: BTreeMap<String, String>,
}

impl Manifest {
    /// Returns the manifest of a run on this machine that began at `started` and ends now. Fields that describe the study's results are empty.
    pub fn ended(identity: &Identity, started: SystemTime) -> Self {
        Self {
            schema: SCHEMA,
            program: identity.program.clone(),
            source: identity.source.clone(),
            commit: COMMIT.to_owned(),
            rustc: RUSTC.to_owned(),
            target: TARGET.to_owned(),
            cpu: cpu(),
            instructions: Some(Instructions::Best.resolved()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            threads: rayon::current_num_threads(),
            started: time(started),
            ended: time(SystemTime::now()),
            study_sha256: crate::inputs::content_hash::sha256(&identity.study),
            objects_sha256: identity.objects.clone(),
            ..Self::default()
        }
    }

    /// Returns whether the results were written by a program with the source code of this program.
    pub fn is_of_this_commit(&self) -> bool {
        self.commit == COMMIT
    }

    /// Reads the manifest of a result folder. Returns `None` if there is no manifest, or only one written by `bubbletouch report`.
    ///
    /// # Errors
    /// If the file cannot be read, was not written by this program, or belongs to tables of another [`SCHEMA`].
    pub fn read(folder: &Path) -> Result<Option<Self>> {
        let path = folder.join(MANIFEST_FILE);
        if !path.exists() {
            return Ok(None);
        }
        let text = fs::read_to_string(&path).map_err(|e| Error::io(&path, "read", e))?;
        let not_ours = |e| Error::input(path.display(), e, "a manifest of this program");
        let json: serde_json::Value = serde_json::from_str(&text).map_err(not_ours)?;
        if json["written_by"] == REPORT {
            return Ok(None);
        }
        let schema = json["schema"].as_u64().unwrap_or(0);
        if schema != u64::from(SCHEMA) {
            let given = format!("results with schema = {schema}");
            let allowed = format!(
                "schema = {SCHEMA}, since columns were renamed: run the study again with --fresh"
            );
            return Err(Error::input(path.display(), given, allowed));
        }
        serde_json::from_value(json).map(Some).map_err(not_ours)
    }

    /// Returns the name and the SHA-256 hash of each table, chart, picture and page in the folder.
    pub fn files(&self) -> impl Iterator<Item = (&String, &String)> {
        let tables = self.tables_sha256.iter().chain(&self.times_sha256);
        tables.chain(self.files_sha256.iter().flatten())
    }

    /// Returns the wall-clock time of the last run, seconds; `None` if its start or end is not a valid time.
    pub fn wall_s(&self) -> Option<f64> {
        let time = |text: &str| DateTime::parse_from_rfc3339(text).ok();
        let (start, end) = (time(&self.started)?, time(&self.ended)?);
        Some((end - start).num_milliseconds() as f64 / 1e3)
    }

    /// Returns the manifest as JSON with one value per line.
    pub fn to_json(&self) -> String {
        let json = serde_json::to_string_pretty(self);
        json.expect("every field has a JSON form") + "\n"
    }
}

/// Returns the name of the processor, or `unknown` if the system does not report it.
fn cpu() -> String {
    let of_system = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = of_system.lines().find_map(|line| {
        let (key, value) = line.split_once(':')?;
        (key.trim() == "model name").then(|| value.trim().to_owned())
    });
    name.unwrap_or_else(|| "unknown".to_owned())
}

/// Formats a time as `2026-11-22T06:30:00.250Z`.
fn time(time: SystemTime) -> String {
    DateTime::<Utc>::from(time).to_rfc3339_opts(SecondsFormat::Millis, true)
}
