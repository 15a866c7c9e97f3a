//! How large a study of pieces is, told before it runs.

use crate::spelling::{counted, duration};
use crate::study::memory::Bytes;
use crate::study::time_left::Piece;

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

    /// A study of so many work items as `bubbletouch plan` tells it, in lines: its scale, and how long all of its work, shared work included,
    /// is planned to take with so many threads. Mostly right within a factor of 3 on a usual machine.
    pub fn estimate(&self, n_items: usize, work: &[Piece], n_threads: usize) -> String {
        let wall_s = work.iter().map(|piece| piece.planned_s).sum::<f64>() / n_threads as f64;
        let (objects, touches) = (&self.objects, &self.touches);
        let configurations = counted(self.n_configurations, "configuration");
        let bytes = Bytes(self.bytes_at_once(n_threads));
        let time = duration(wall_s.max(1.0));
        let threads = counted(n_threads, "thread");
        [
            format!("  objects  {objects}"),
            format!("  touches  {touches}"),
            format!("  items    {n_items}, of {configurations}"),
            format!("  memory   about {bytes}"),
            format!("  time     about {time} on {threads} (mostly right within a factor of 3)"),
        ]
        .join("\n")
    }

    fn bytes_at_once(&self, n_items: usize) -> f64 {
        PROGRAM_BYTES + self.bytes + n_items as f64 * self.item_bytes
    }
}
