//! Study that a command uses: its file, and the values that options replace.

use crate::command::program;
use crate::command::terminal::packings_beside;
use bubbletouch::kinds::{self, AnyStudy, Source};
use bubbletouch::shell_line::shell_line;
use bubbletouch::study::TouchesSpec;
use bubbletouch::study::memory::{GIB, machine_memory};
use bubbletouch::{Error, Result};
use std::path::{Path, PathBuf};

/// Maximum number of threads on machines with fewer cores: further threads need memory and do not reduce the run time.
const MAX_THREADS: usize = 1024;

/// Path of the study that `bubbletouch` runs if it is called without arguments.
pub const QUICKSTART_FILE: &str = "experiments/quickstart.toml";

/// Text of the quickstart study, which is contained in the program, so that the command works in any folder.
const QUICKSTART: &str = include_str!("../../../experiments/quickstart.toml");

#[derive(clap::Args)]
pub struct StudyArgs {
    /// Study, a TOML file
    pub study: PathBuf,
    /// Replace the study's objects by a mesh folder or TOML file
    ///
    /// A folder contains one PLY, OBJ, STL, Collada or glTF mesh for each object. In a study of recorded frames, this is the folder of the recorded files.
    #[arg(long, value_name = "FOLDER|FILE.toml", help_heading = "Input")]
    objects: Option<PathBuf>,
    /// Replace the study's seed
    #[arg(long, value_name = "N", help_heading = "Input")]
    seed: Option<u64>,
    /// Use N threads; results do not depend on N [default: all cores]
    #[arg(long, value_name = "N", help_heading = "Run")]
    pub threads: Option<usize>,
}

impl StudyArgs {
    /// Returns the folder of the study file, to which paths in the study are relative.
    pub fn folder(&self) -> PathBuf {
        self.study.parent().unwrap_or(Path::new("")).to_owned()
    }

    /// Returns the name of the study: the name of its file without the extension.
    pub fn name(&self) -> Result<String> {
        let stem = self.study.file_stem().and_then(|stem| stem.to_str());
        stem.map(str::to_owned)
            .ok_or_else(|| Error::input("study", self.study.display(), "a file with a name"))
    }

    /// Returns the default folder for the results of the study.
    pub fn default_results(&self) -> Result<PathBuf> {
        Ok(Path::new("results").join(self.name()?))
    }

    /// Returns the study and the values replaced by options as arguments of another command.
    pub fn arguments(&self) -> Vec<String> {
        let mut words = vec![self.study.display().to_string()];
        if let Some(objects) = &self.objects {
            words.extend(["--objects".to_owned(), objects.display().to_string()]);
        }
        if let Some(seed) = self.seed {
            words.extend(["--seed".to_owned(), seed.to_string()]);
        }
        words
    }

    /// Returns the shell command that repeats the study and writes its results to the folder `out`, or to the default folder.
    pub fn command(&self, subcommand: &str, out: Option<&Path>) -> String {
        let mut words = vec![program(), subcommand.to_owned()];
        words.extend(self.arguments());
        if let Some(out) = out {
            words.extend(["--out".to_owned(), out.display().to_string()]);
        }
        shell_line(&words)
    }

    /// Reads and checks the study and loads its objects, with a given result folder and memory limit in bytes.
    pub fn load(&self, results: &Path, memory: Option<u64>) -> Result<Box<dyn AnyStudy>> {
        kinds::load(&Source {
            memory,
            ..self.source(results)?
        })
    }

    /// Returns the source of the study: its text, the values replaced by options, and the result folder.
    pub fn source(&self, results: &Path) -> Result<Source> {
        set_threads(self.threads)?;
        Ok(Source {
            packings: Some(packings_beside(results)),
            results: results.to_owned(),
            folder: self.folder(),
            objects: self.objects.clone(),
            seed: self.seed,
            ..Source::of_text(&self.study.display().to_string(), &self.text()?)
        })
    }

    /// Returns a note if a study lists several values in `[touches]`, which are then mixed, and may have meant an axis.
    pub fn mixed_touches(&self) -> Result<Option<String>> {
        let study: Option<toml::Table> = self.text()?.parse().ok();
        let touches = study.and_then(|mut study| study.remove("touches"));
        let touches: Option<TouchesSpec> = touches.and_then(|table| table.try_into().ok());
        let mixed = touches.and_then(|touches| touches.mixed_values());
        Ok(mixed.map(|mixed| format!("note: {mixed}")))
    }

    fn text(&self) -> Result<String> {
        if self.study == Path::new(QUICKSTART_FILE) && !self.study.exists() {
            return Ok(QUICKSTART.to_owned());
        }
        bubbletouch::files::read_to_string(&self.study).map_err(|error| {
            let given = format!("cannot be read ({error})");
            Error::input(self.study.display(), given, "a study in TOML")
        })
    }
}

/// Sets the number of threads that the program uses; the default is the number of cores.
pub fn set_threads(threads: Option<usize>) -> Result<()> {
    let Some(threads) = threads else {
        return Ok(());
    };
    let n_cores = std::thread::available_parallelism().map_or(1, usize::from);
    let most = MAX_THREADS.max(n_cores);
    if !(1..=most).contains(&threads) {
        let allowed = format!("1 to {most} (there are {n_cores} cores)");
        return Err(Error::input("--threads", threads, allowed));
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    match pool.build_global() {
        // An earlier command of this process has started the threads.
        Err(_) if rayon::current_num_threads() == threads => Ok(()),
        started => started.map_err(|error| {
            let allowed = "a number of threads that the system can start";
            Error::input("--threads", format!("{threads} ({error})"), allowed)
        }),
    }
}

/// Memory limit of a study.
#[derive(clap::Args)]
pub struct MemoryLimit {
    /// Limit the memory, GiB [default: the machine's memory]
    ///
    /// Below a small limit, fewer work items run at the same time. If a single one does not fit, the study is refused.
    #[arg(long, value_name = "GIB", help_heading = "Run")]
    memory_gib: Option<f64>,
}

impl MemoryLimit {
    /// Returns the memory limit in bytes: the value of `--memory-gib`, or the machine's memory if the option is not given.
    pub fn bytes(&self) -> Result<Option<u64>> {
        match self.memory_gib {
            None => Ok(machine_memory()),
            Some(gib) if gib.is_finite() && gib > 0.0 => Ok(Some((gib * GIB) as u64)),
            Some(gib) => {
                let allowed = "a positive number of gibibytes";
                Err(Error::input("--memory-gib", gib, allowed))
            }
        }
    }
}
