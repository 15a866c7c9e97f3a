//! Where results come from: the program, the machine, the study and its objects.

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

/// The commit at which sources last changed, `-changed` if they were not those of it, `unknown` outside a repository.
const COMMIT: &str = env!("BUBBLETOUCH_COMMIT");

/// What built the program.
const RUSTC: &str = env!("BUBBLETOUCH_RUSTC");

/// What it was built for.
const TARGET: &str = env!("BUBBLETOUCH_TARGET");

pub use crate::files::MANIFEST_FILE;

/// The subcommand in the manifest of a folder without a run whose charts and page were made again.
pub const REPORT: &str = "report";

/// `manifest.json`: where the files of a folder come from.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// The study's name; empty in manifests of earlier versions.
    #[serde(default)]
    pub study: String,
    /// The command that makes the folder again; empty in manifests of earlier versions.
    #[serde(default)]
    pub command: String,
    /// The folder of the study's file, to which paths in it are relative; empty in manifests of earlier versions.
    #[serde(default)]
    pub paths_from: PathBuf,
    /// Program and version.
    pub program: String,
    /// Hash of its sources.
    pub source: String,
    /// Its commit.
    pub commit: String,
    /// What built it.
    pub rustc: String,
    /// What it was built for.
    pub target: String,
    /// The processor's name, or `unknown`.
    pub cpu: String,
    /// Its best vector instructions, by which products of the learning engine round; none in manifests of earlier versions.
    #[serde(default)]
    pub instructions: Option<Instructions>,
    /// Threads that the machine runs at once.
    pub cores: usize,
    /// Threads that the last run used.
    pub threads: usize,
    /// The last run's start and end, UTC.
    pub started: String,
    /// Its end.
    pub ended: String,
    /// Most bytes of memory that the last run held, where the system tells.
    #[serde(default)]
    pub peak_memory_bytes: Option<u64>,
    /// Cells that the last run found finished, counted once a trial.
    pub n_finished_before: usize,
    /// Root of all randomness.
    pub seed: u64,
    /// Cells of the study, or pieces of its work.
    pub n_cells: usize,
    /// Trials of each; a piece holds its trials.
    pub n_trials: usize,
    /// Cells that failed, counted once a trial.
    pub n_failed: usize,
    /// SHA-256 of `study.toml`: the study with every default spelt out.
    pub study_sha256: String,
    /// SHA-256 of what each object is made of, by its name.
    pub objects_sha256: BTreeMap<String, String>,
    /// SHA-256 of the tables that hold no times, by their file's name.
    pub tables_sha256: BTreeMap<String, String>,
    /// SHA-256 of those that do, which no two runs share; empty in manifests of earlier versions.
    #[serde(default)]
    pub times_sha256: BTreeMap<String, String>,
    /// SHA-256 of all other files of the folder but this one, by name: charts, pictures and the page. `None` in manifests of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub files_sha256: Option<BTreeMap<String, String>>,
    /// How the intervals and p-values of the tables are made, by table and columns.
    #[serde(default)]
    pub methods: BTreeMap<String, String>,
}

impl Manifest {
    /// Of a run that began then and ends now, on this machine: what it is of, which is left open, is empty.
    pub fn ended(identity: &Identity, started: SystemTime) -> Self {
        Self {
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
            peak_memory_bytes: crate::inputs::memory::peak_memory(),
            study_sha256: crate::inputs::content_hash::sha256(&identity.study),
            objects_sha256: identity.objects.clone(),
            ..Self::default()
        }
    }

    /// Reads the manifest of a folder of results. Returns `None` if there is none, or only that of a page made by `bubbletouch report`.
    ///
    /// # Errors
    /// It cannot be read, or is not of this program.
    pub fn read(folder: &Path) -> Result<Option<Self>> {
        let path = folder.join(MANIFEST_FILE);
        if !path.exists() {
            return Ok(None);
        }
        let text = fs::read_to_string(&path).map_err(|e| Error::io(&path, "read", e))?;
        let is_of_page = |json: &serde_json::Value| json["written_by"] == REPORT;
        if serde_json::from_str(&text).is_ok_and(|json| is_of_page(&json)) {
            return Ok(None);
        }
        let read = serde_json::from_str(&text);
        read.map(Some)
            .map_err(|e| Error::input(path.display(), e, "a manifest of this program"))
    }

    /// Seconds from the last run's start to its end; none if they are not times of day.
    pub fn wall_s(&self) -> Option<f64> {
        let time = |text: &str| DateTime::parse_from_rfc3339(text).ok();
        let (start, end) = (time(&self.started)?, time(&self.ended)?);
        Some((end - start).num_milliseconds() as f64 / 1e3)
    }

    /// As JSON with a line a value.
    pub fn to_json(&self) -> String {
        let json = serde_json::to_string_pretty(self);
        json.expect("every field has a JSON form") + "\n"
    }
}

/// The processor's name where the system tells it.
fn cpu() -> String {
    let of_system = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = of_system.lines().find_map(|line| {
        let (key, value) = line.split_once(':')?;
        (key.trim() == "model name").then(|| value.trim().to_owned())
    });
    name.unwrap_or_else(|| "unknown".to_owned())
}

/// `2026-11-22T06:30:00.250Z`
fn time(time: SystemTime) -> String {
    DateTime::<Utc>::from(time).to_rfc3339_opts(SecondsFormat::Millis, true)
}
