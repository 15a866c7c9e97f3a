//! Size of a study, estimated before it runs, and the number of threads that a limit of the memory allows.

use crate::error::{Error, Result};
use crate::inputs::memory::{Bytes, GIB, memory_in_use};
use crate::spelling::counted;

/// Approximate memory of the pictures and the page that a study draws at the end, bytes: fonts, pixels, and memory of earlier stages that the allocator has not
/// returned yet.
const DRAWING_BYTES: f64 = 1.75e8;

/// Memory of the program if the system does not report it, bytes.
const PROGRAM_BYTES: f64 = 1.2e8;

/// Size of a study: its numbers of objects, touches and configurations, and its memory.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scale {
    /// Description of the touched objects in words.
    pub objects: String,
    /// Description of the touches in words.
    pub touches: String,
    /// Number of configurations of the study.
    pub n_configurations: usize,
    /// Approximate memory of the data that the whole run keeps, bytes, beside the program and the loaded study.
    pub bytes: f64,
    /// Stages of the run, one after the other. Results are drawn in a further stage.
    pub stages: Vec<Stage>,
}

/// Memory of a stage of a study: nothing of it remains in the next stage.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stage {
    /// Approximate memory of the data that all work items of the stage share, bytes.
    pub bytes: f64,
    /// Approximate memory of each work item while it is computed, bytes.
    pub items: Vec<f64>,
}

impl Stage {
    /// Creates a stage of `bytes` bytes whose work items need no memory of their own.
    pub fn of_bytes(bytes: f64) -> Self {
        let items = Vec::new();
        Self { bytes, items }
    }
}

impl Scale {
    /// Returns the approximate memory of a run that computes one work item at a time, bytes. The memory that the process uses now counts as the memory of the
    /// program and the loaded study.
    pub fn least_bytes(&self) -> f64 {
        self.bytes_at_once(1)
    }

    /// Returns the number of work items that can run concurrently within a memory of `ceiling` bytes, limited to the number of threads. Returns `None` if a
    /// single item does not fit.
    pub fn n_at_once(&self, ceiling: f64) -> Option<usize> {
        let n_threads = (1..=rayon::current_num_threads()).rev();
        let mut within = n_threads.filter(|&n| self.bytes_at_once(n) <= ceiling);
        within.next()
    }

    /// Returns the text that `bubbletouch plan` prints about the size of a study with `n_items` work items on `n_threads` threads.
    pub fn describe(&self, n_items: usize, n_threads: usize) -> String {
        let (objects, touches) = (&self.objects, &self.touches);
        let configurations = counted(self.n_configurations, "configuration");
        let bytes = Bytes(self.bytes_at_once(n_threads));
        let threads = counted(n_threads, "thread");
        [
            format!("  objects  {objects}"),
            format!("  touches  {touches}"),
            format!("  items    {n_items}, of {configurations}"),
            format!("  memory   about {bytes} on {threads}"),
        ]
        .join("\n")
    }

    fn bytes_at_once(&self, n_items: usize) -> f64 {
        let most = self.stages.iter().map(|stage| {
            let mut items = stage.items.clone();
            items.sort_by(|a, b| b.total_cmp(a));
            stage.bytes + items.iter().take(n_items).sum::<f64>()
        });
        let loaded = memory_in_use().map_or(PROGRAM_BYTES, |bytes| bytes as f64);
        loaded + self.bytes + most.fold(DRAWING_BYTES, f64::max)
    }
}

/// Returns the largest number of threads for which the memory of a study stays within the limit `ceiling`, bytes. If there is no limit, returns the number of
/// all threads.
///
/// # Errors
/// If even one work item at a time exceeds the limit.
pub fn threads_within(scale: &Scale, ceiling: Option<u64>) -> Result<usize> {
    let Some(ceiling) = ceiling else {
        return Ok(rayon::current_num_threads());
    };
    scale.n_at_once(ceiling as f64).ok_or_else(|| {
        Error::input(
            "memory",
            format!("a ceiling of {:.2} GiB", ceiling as f64 / GIB),
            format!(
                "at least {:.2} GiB for this study; fewer touches, frames, taxels or measurements take less",
                scale.least_bytes() / GIB
            ),
        )
    })
}

/// Runs `work` on the number of threads that the memory limit allows. The result does not depend on the number of threads.
///
/// # Errors
/// If [`threads_within`] or `work` fails.
pub fn within_memory<T: Send>(
    scale: &Scale,
    ceiling: Option<u64>,
    work: impl FnOnce() -> Result<T> + Send,
) -> Result<T> {
    let n_threads = threads_within(scale, ceiling)?;
    if n_threads == rayon::current_num_threads() {
        return work();
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads);
    let pool = pool
        .build()
        .map_err(|error| Error::input("threads", error, "a number that the system can start"))?;
    pool.install(work)
}
