//! How large a study of pieces is, told before it runs.

use crate::spelling::counted;
use crate::study::estimate::Seconds;
use crate::study::memory::Bytes;
use crate::study::time_left::{Piece, Work};
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
}

/// A study of pieces as `bubbletouch plan` tells it: its scale, and what its pieces are planned to take, those that are shared and those
/// at the end included.
///
/// Times are those of the pieces' plans, from rates of a 2-core x86-64 server: mostly right within a factor of 3.
#[derive(Clone, Debug)]
pub struct PieceEstimate {
    /// How large it is.
    pub scale: Scale,
    /// Pieces that the journal counts.
    pub n_pieces: usize,
    /// All work.
    pub work: Vec<Piece>,
}

impl PieceEstimate {
    /// Seconds until the study is done, with all threads.
    pub fn wall_s(&self) -> f64 {
        let n_threads = rayon::current_num_threads() as f64;
        let wall_s = |piece: &Piece| match piece.kind {
            Work::Report => piece.planned_s,
            _ => piece.planned_s / n_threads,
        };
        self.work.iter().map(wall_s).sum()
    }
}

impl fmt::Display for PieceEstimate {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Scale {
            objects,
            touches,
            n_configurations,
            bytes,
        } = &self.scale;
        writeln!(f, "  objects  {objects}")?;
        writeln!(f, "  touches  {touches}")?;
        writeln!(
            f,
            "  pieces   {}, of {}",
            self.n_pieces,
            counted(*n_configurations, "configuration")
        )?;
        writeln!(f, "  memory   about {}", Bytes(PROGRAM_BYTES + bytes))?;
        write!(
            f,
            "  time     about {} on {} (mostly right within a factor of 3)",
            Seconds(self.wall_s()),
            counted(rayon::current_num_threads(), "thread")
        )
    }
}
