//! How large a study of pieces is, told before it runs.

use crate::spelling::counted;
use crate::study::memory::Bytes;
use crate::study::time_left::Piece;
use std::fmt;

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

    fn bytes_at_once(&self, n_items: usize) -> f64 {
        PROGRAM_BYTES + self.bytes + n_items as f64 * self.item_bytes
    }
}

/// A study of pieces as `bubbletouch plan` tells it: its scale, and what its pieces are planned to take, those that are shared and those
/// at the end included.
///
/// Times are those of the pieces' plans: mostly right within a factor of 3 on a usual machine.
#[derive(Clone, Debug)]
pub struct PieceEstimate {
    /// How large it is.
    pub scale: Scale,
    /// Pieces that the journal counts.
    pub n_pieces: usize,
    /// Threads that do them.
    pub n_threads: usize,
    /// All work.
    pub work: Vec<Piece>,
}

impl PieceEstimate {
    /// Seconds until the study is done, with all threads.
    pub fn wall_s(&self) -> f64 {
        let n_threads = self.n_threads as f64;
        self.work.iter().map(|piece| piece.planned_s).sum::<f64>() / n_threads
    }
}

impl fmt::Display for PieceEstimate {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Scale {
            objects,
            touches,
            n_configurations,
            ..
        } = &self.scale;
        let configurations = counted(*n_configurations, "configuration");
        let bytes = Bytes(self.scale.bytes_at_once(self.n_threads));
        let seconds = seconds(self.wall_s());
        let threads = counted(self.n_threads, "thread");
        writeln!(f, "  objects  {objects}")?;
        writeln!(f, "  touches  {touches}")?;
        writeln!(f, "  items    {}, of {configurations}", self.n_pieces)?;
        writeln!(f, "  memory   about {bytes}")?;
        let right = "(mostly right within a factor of 3)";
        write!(f, "  time     about {seconds} on {threads} {right}")
    }
}

/// Seconds in words, without more digits than an estimate has.
fn seconds(seconds: f64) -> String {
    match seconds {
        s if s < 1.0 => "1 s".to_owned(),
        s if s < 100.0 => format!("{s:.0} s"),
        s if s < 6000.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}
