//! What `run`, `plan` and `touches` have in common: a study file, and what overrides it.

use super::output::packings_beside;
use bubbletouch::kinds::Source;
use bubbletouch::study::TouchesSpec;
use bubbletouch::{Error, Result};
use std::path::{Path, PathBuf};

/// Threads, at most, where there are not more cores: each takes memory of its own, and none is faster than a core.
const MOST_THREADS: usize = 1024;

/// The study that a bare `bubbletouch` runs; it is part of the command, so that it runs in any folder.
const QUICKSTART: &str = include_str!("../../experiments/quickstart.toml");

#[derive(Clone, clap::Args)]
pub struct StudyArgs {
    /// The study, a TOML file
    pub study: PathBuf,
    /// A folder of PLY, OBJ or STL meshes, one object a file, or a TOML file of objects; replaces the study's objects, or the folder
    /// of its scans
    #[arg(long, value_name = "FOLDER or FILE.toml")]
    pub objects: Option<PathBuf>,
    /// Root of all randomness; replaces the study's
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Threads; all cores when left out. Results are the same at any number
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
    /// The folder that paths in the study are relative to; its file's when left out.
    #[arg(skip)]
    pub paths_from: Option<PathBuf>,
    /// Most bytes to hold; no ceiling when left out.
    #[arg(skip)]
    pub memory: Option<u64>,
    /// Where its results go; beside them packings are kept, and in them what memory cannot hold.
    #[arg(skip)]
    pub results: PathBuf,
}

impl StudyArgs {
    pub fn quickstart() -> Self {
        Self {
            study: PathBuf::from("experiments/quickstart.toml"),
            objects: None,
            seed: None,
            threads: None,
            paths_from: None,
            memory: None,
            results: PathBuf::new(),
        }
    }

    /// The study of a folder of results.
    pub fn of_results(folder: &Path, paths_from: Option<PathBuf>) -> Self {
        Self {
            study: folder.join("study.toml"),
            paths_from,
            ..Self::quickstart()
        }
    }

    /// The folder that paths in the study are relative to.
    pub fn folder(&self) -> PathBuf {
        let of_file = self.study.parent().unwrap_or(Path::new(""));
        self.paths_from.clone().unwrap_or(of_file.to_owned())
    }

    /// The name of the study: its file's name without the ending.
    pub fn name(&self) -> Result<String> {
        let stem = self.study.file_stem().and_then(|stem| stem.to_str());
        stem.map(str::to_owned)
            .ok_or_else(|| Error::input("study", self.study.display(), "a file with a name"))
    }

    /// The study's text, and what was asked for beside it.
    pub fn source(&self) -> Result<Source> {
        set_threads(self.threads)?;
        Ok(Source {
            place: self.study.display().to_string(),
            text: self.text()?,
            folder: self.folder(),
            objects: self.objects.clone(),
            seed: self.seed,
            memory: self.memory,
            packings: Some(packings_beside(&self.results)),
            results: self.results.clone(),
        })
    }

    /// What a study of any kind is told that mixes listed values of `[touches]` where an axis may be meant.
    pub fn mixed_touches(&self) -> Result<Option<String>> {
        let study: Option<toml::Table> = self.text()?.parse().ok();
        let touches = study.and_then(|mut study| study.remove("touches"));
        let touches: Option<TouchesSpec> = touches.and_then(|table| table.try_into().ok());
        Ok(touches.and_then(|touches| touches.mixed_values()))
    }

    fn text(&self) -> Result<String> {
        let quickstart = Self::quickstart();
        if self.study == quickstart.study && !self.study.exists() {
            return Ok(QUICKSTART.to_owned());
        }
        std::fs::read_to_string(&self.study).map_err(|error| {
            Error::input(
                self.study.display(),
                format!("cannot be read ({error})"),
                "a study in TOML",
            )
        })
    }
}

/// Sets the number of threads of everything that follows; all cores when left out.
pub fn set_threads(threads: Option<usize>) -> Result<()> {
    let Some(threads) = threads else {
        return Ok(());
    };
    let n_cores = std::thread::available_parallelism().map_or(1, usize::from);
    let most = MOST_THREADS.max(n_cores);
    if !(1..=most).contains(&threads) {
        let allowed = format!("1 to {most} (there are {n_cores} cores)");
        return Err(Error::input("--threads", threads, allowed));
    }
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build_global()
        .map_err(|error| {
            Error::input(
                "--threads",
                format!("{threads} ({error})"),
                "a number of threads that the system can start",
            )
        })
}
