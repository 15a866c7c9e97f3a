//! How large a study of items is, told before it runs.

use crate::inputs::memory::Bytes;
use crate::spelling::counted;

/// Bytes of the program, its objects and the pictures that it draws at the end, about.
const PROGRAM_BYTES: f64 = 2e8;

/// What a kind of study knows of its size.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scale {
    /// What is touched, in words.
    pub objects: String,
    /// Touches, in words.
    pub touches: String,
    /// Combinations of settings.
    pub n_configurations: usize,
    /// Bytes held at once beside those of every program, about.
    pub bytes: f64,
    /// Bytes more of each work item that is under way, about.
    pub item_bytes: f64,
}

impl Scale {
    /// Bytes with a single work item at a time.
    pub fn least_bytes(&self) -> f64 {
        self.bytes_at_once(1)
    }

    /// Work items at a time, at most as many as there are threads, that take no more than so many bytes; none if a single one takes more.
    pub fn n_at_once(&self, ceiling: f64) -> Option<usize> {
        let n_threads = (1..=rayon::current_num_threads()).rev();
        let mut within = n_threads.filter(|&n| self.bytes_at_once(n) <= ceiling);
        within.next()
    }

    /// Returns the lines of `bubbletouch plan` about a study of `n_items` work items that runs on `n_threads` threads.
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
