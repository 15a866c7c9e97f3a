//! What an ensemble says of itself, and what a drawn map does.

use crate::error::Result;
use crate::random::Seed;
use crate::sensing::Ensemble;
use ndarray::{Array2, ArrayView2, ArrayViewMut2};
use std::fmt::Debug;

/// Draws the map of an ny × nx array to m measurements, 1 ≤ m ≤ n, from its own stream.
pub type Draw = fn((usize, usize), usize, &Seed) -> Box<dyn Operator>;

/// Learns it from frames (n_frames × n), of which there are some.
pub type Learn = fn(ArrayView2<f64>, usize, &Seed) -> Result<Box<dyn Operator>>;

/// Where a map comes from.
#[derive(Clone, Copy, Debug)]
pub enum Source {
    /// It is drawn, or known.
    Drawn(Draw),
    /// It is learned from frames that training touches read.
    Learned(Learn),
}

/// An ensemble of measurements.
#[derive(Debug)]
pub struct EnsembleAbout {
    /// What people call it.
    pub words: &'static str,
    /// Whether the first m measurements of a larger projection are those of the projection of size m.
    pub is_prefix_nested: bool,
    /// Whether it measures the whole frame, whatever m.
    pub is_whole_frame: bool,
    /// Whether it needs rows and columns: a layout without any has none of it.
    pub needs_rows: bool,
    /// Bytes that a map from n taxels to m measurements takes, by m and n.
    pub bytes: fn(f64, f64) -> f64,
    /// Where a map comes from.
    pub source: Source,
}

impl EnsembleAbout {
    /// One of nested rows and few numbers that reads each taxel once at most.
    pub(crate) const fn new(words: &'static str, draw: Draw) -> Self {
        Self {
            words,
            is_prefix_nested: true,
            is_whole_frame: false,
            needs_rows: false,
            bytes: |_, n| 16.0 * n,
            source: Source::Drawn(draw),
        }
    }
}

/// A drawn map y = Φx.
pub trait Operator: Debug + Send + Sync {
    /// Measures frames (n_frames × n) into `out` (n_frames × m), whatever was there. A row has the same bits in whatever batch.
    fn measure(&self, frames: ArrayView2<f64>, out: ArrayViewMut2<f64>);

    /// Calls `visit` with measurement, taxel and value of each entry of Φ that may not be zero; the same order every time.
    fn each_entry(&self, visit: &mut dyn FnMut(usize, usize, f64));

    /// Root mean square norm of a row of Φ.
    fn row_norm(&self) -> f64;

    /// Φ, if it is stored.
    fn stored(&self) -> Option<&Array2<f64>> {
        None
    }

    /// ΦΦᵀ, if it is known without Φ.
    fn known_gram(&self) -> Option<Array2<f64>> {
        None
    }
}

impl Ensemble {
    /// Whether the first m measurements of a larger projection are those of the projection of size m.
    pub fn is_prefix_nested(self) -> bool {
        self.about().is_prefix_nested
    }

    /// Whether its map is learned from frames of training touches.
    pub fn is_learned(self) -> bool {
        matches!(self.about().source, Source::Learned(_))
    }

    /// The number of measurements of an array of n taxels where m are asked for: n, of a whole frame.
    pub fn n_measurements(self, m: usize, n: usize) -> usize {
        match self.about().is_whole_frame {
            true => n,
            false => m,
        }
    }
}

/// Says of each ensemble which file tells of it.
macro_rules! ensembles {
    ($($name:ident $file:ident $doc:literal;)*) => {
        $(mod $file;)*

        /// How measurements are made from a frame.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
        #[serde(rename_all = "snake_case")]
        pub enum Ensemble {
            $(#[doc = $doc] $name,)*
        }

        impl Ensemble {
            /// All of them.
            pub const ALL: &[Self] = &[$(Self::$name),*];

            /// The name in a study, and what people call it.
            pub const NAMES: &[(&str, &str)] = &[$((stringify!($file), $file::ABOUT.words)),*];

            /// What it says of itself.
            pub const fn about(self) -> &'static EnsembleAbout {
                match self {
                    $(Self::$name => &$file::ABOUT,)*
                }
            }
        }
    };
}
