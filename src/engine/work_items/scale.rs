//! Size of a study, estimated before it runs.

use crate::inputs::memory::Bytes;
use crate::spelling::counted;

/// Approximate memory of the program without the data of the study, bytes. It contains the program itself, its objects, and the pictures that it draws at
/// the end.
const PROGRAM_BYTES: f64 = 2e8;

/// Size of a study: its numbers of objects, touches and configurations, and its memory.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scale {
    /// Description of the touched objects in words.
    pub objects: String,
    /// Description of the touches in words.
    pub touches: String,
    /// Number of configurations of the study.
    pub n_configurations: usize,
    /// Approximate memory of the data that all work items share, bytes, without the memory of the program itself.
    pub bytes: f64,
    /// Approximate memory of one work item while it is computed, bytes.
    pub item_bytes: f64,
}

impl Scale {
    /// Returns the approximate memory of a run that computes one work item at a time, bytes.
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
        PROGRAM_BYTES + self.bytes + n_items as f64 * self.item_bytes
    }
}
