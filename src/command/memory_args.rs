//! How much memory a study may take, and what it keeps on disk.

use super::output::touches_beside;
use super::study_args::LoadedStudy;
use bubbletouch::study::memory::{GIB, MemoryPlan, machine_memory};
use bubbletouch::study::{FrameStorage, StudyKind, TouchCache};
use bubbletouch::{Error, Result};
use std::path::Path;

/// Gibibytes of touches that are kept beside results, unless asked otherwise.
pub const CACHE_GIB: f64 = 4.0;

#[derive(Clone, Copy, Debug, Default, clap::Args)]
pub struct CeilingArgs {
    /// Most memory to take, in GiB: less is done at once, frames are read from disk, or the study is refused [default: what the
    /// machine has]
    #[arg(long, value_name = "GIB")]
    pub memory_gib: Option<f64>,
}

#[derive(Clone, Copy, Debug, Default, clap::Args)]
pub struct MemoryArgs {
    #[command(flatten)]
    ceiling: CeilingArgs,
    /// Most disk for touches that took long to make, in GiB: they are kept beside the results for the next run, and those used
    /// longest ago go first; 0 keeps none [default: 4]
    #[arg(long, value_name = "GIB")]
    cache_gib: Option<f64>,
}

/// The error for an option that studies of pieces have not.
pub fn not_of_pieces(option: &str, kind: StudyKind) -> Error {
    let allowed = format!(
        "no such option: it is for {}",
        StudyKind::Recognition.words()
    );
    Error::input(option, kind.words(), allowed)
}

impl CeilingArgs {
    /// What a study may hold at once.
    pub fn plan(&self, loaded: &LoadedStudy) -> Result<MemoryPlan> {
        let n_classes = loaded.touched.class_names().len();
        MemoryPlan::new(&loaded.plan, &loaded.sweep, n_classes, self.bytes()?)
    }

    /// Most bytes to take: what was asked for, or what the machine has, if it tells.
    pub fn bytes(&self) -> Result<Option<u64>> {
        let given = self.memory_gib.map(|gib| bytes("--memory-gib", gib));
        Ok(given.transpose()?.or_else(machine_memory))
    }
}

/// The room that a run has.
pub struct Room {
    /// Where frames come from and are kept.
    pub storage: FrameStorage,
    /// How much of the work is in memory at the same time.
    pub memory: MemoryPlan,
}

impl MemoryArgs {
    /// Of what is planned, not run.
    pub fn within(ceiling: CeilingArgs) -> Self {
        Self {
            ceiling,
            cache_gib: None,
        }
    }

    /// Most bytes to take.
    pub fn bytes(&self) -> Result<Option<u64>> {
        self.ceiling.bytes()
    }

    /// The room of a study whose results go to a folder.
    pub fn room(&self, loaded: &LoadedStudy, folder: &Path) -> Result<Room> {
        let memory = self.ceiling.plan(loaded)?;
        let limit = match self.cache_gib.unwrap_or(CACHE_GIB) {
            0.0 => 0,
            gib => bytes("--cache-gib", gib)?,
        };
        let cache = TouchCache::new(touches_beside(folder), limit);
        Ok(Room {
            storage: FrameStorage::new(cache, memory.frames),
            memory,
        })
    }

    /// The options that were given, by name.
    pub fn given(&self) -> [(&'static str, bool); 2] {
        [
            ("--memory-gib", self.ceiling.memory_gib.is_some()),
            ("--cache-gib", self.cache_gib.is_some()),
        ]
    }
}

/// Gibibytes of an option in bytes.
pub fn bytes(option: &str, gib: f64) -> Result<u64> {
    if gib.is_finite() && gib > 0.0 {
        return Ok((gib * GIB) as u64);
    }
    Err(Error::input(option, gib, "a positive number of gibibytes"))
}
