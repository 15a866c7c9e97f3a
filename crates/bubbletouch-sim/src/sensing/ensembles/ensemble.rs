//! Descriptions of ensembles, and the operations of their maps.

use crate::error::Result;
use crate::random::Seed;
use crate::sensing::Ensemble;
use ndarray::{Array2, ArrayView2, ArrayViewMut2};
use std::fmt::Debug;

/// Function that draws the map from an ny × nx array to m measurements, 1 ≤ m ≤ n, with its own random stream.
pub type Draw = fn((usize, usize), usize, &Seed) -> Box<dyn Operator>;

/// Function that learns the map from frames (n_frames × n, at least one frame).
pub type Learn = fn(ArrayView2<f64>, usize, &Seed) -> Result<Box<dyn Operator>>;

/// Origin of a measurement map: drawn or learned.
#[derive(Clone, Copy, Debug)]
pub enum Source {
    /// The map is drawn at random or fixed.
    Drawn(Draw),
    /// The map is learned from frames of training touches.
    Learned(Learn),
}

/// Description of an ensemble of measurements.
#[derive(Debug)]
pub struct EnsembleAbout {
    /// Display name of the ensemble.
    pub words: &'static str,
    /// Whether the first m measurements of a larger projection are the measurements of the projection of size m.
    pub is_prefix_nested: bool,
    /// Whether the ensemble measures the whole frame for any m.
    pub is_whole_frame: bool,
    /// Whether the ensemble needs rows and columns; other layouts do not support it.
    pub needs_rows: bool,
    /// Function that returns the memory of a map from n taxels to m measurements, bytes; its arguments are m and n.
    pub bytes: fn(f64, f64) -> f64,
    /// Origin of the map: drawn or learned.
    pub source: Source,
}

impl EnsembleAbout {
    /// Describes an ensemble with nested rows and little memory that works on any layout.
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

/// Linear map y = Φx from frames to measurements.
pub trait Operator: Debug + Send + Sync {
    /// Measures frames (n_frames × n) and overwrites `out` (n_frames × m). The measurements of a frame have equal bits in any batch.
    fn measure(&self, frames: ArrayView2<f64>, out: ArrayViewMut2<f64>);

    /// Calls `visit` with measurement, taxel and value of each entry of Φ that can be nonzero, always in one order.
    fn each_entry(&self, visit: &mut dyn FnMut(usize, usize, f64));

    /// Returns the root mean square norm of the rows of Φ.
    fn row_norm(&self) -> f64;

    /// Returns the matrix Φ if it is stored.
    fn stored(&self) -> Option<&Array2<f64>> {
        None
    }

    /// Returns the Gram matrix ΦΦᵀ if it is known without computing Φ.
    fn known_gram(&self) -> Option<Array2<f64>> {
        None
    }
}

impl Ensemble {
    /// Returns whether the first m measurements of a larger projection are the measurements of the projection of size m.
    pub fn is_prefix_nested(self) -> bool {
        self.about().is_prefix_nested
    }

    /// Returns whether the map is learned from frames of training touches.
    pub fn is_learned(self) -> bool {
        matches!(self.about().source, Source::Learned(_))
    }

    /// Returns the number of measurements for n taxels and a requested m: n for whole-frame ensembles, otherwise m.
    pub fn n_measurements(self, m: usize, n: usize) -> usize {
        match self.about().is_whole_frame {
            true => n,
            false => m,
        }
    }
}

/// Declares the ensembles, and the module that contains each.
macro_rules! ensembles {
    ($($name:ident $file:ident $doc:literal;)*) => {
        $(mod $file;)*

        /// Ensemble of measurements, by which a frame is compressed.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
        #[serde(rename_all = "snake_case")]
        pub enum Ensemble {
            $(#[doc = $doc] $name,)*
        }

        impl Ensemble {
            /// List of all ensembles.
            pub const ALL: &[Self] = &[$(Self::$name),*];

            /// Names of the ensembles in a study, and their display names.
            pub const NAMES: &[(&str, &str)] = &[$((stringify!($file), $file::ABOUT.words)),*];

            /// Returns the description of the ensemble.
            pub const fn about(self) -> &'static EnsembleAbout {
                match self {
                    $(Self::$name => &$file::ABOUT,)*
                }
            }
        }
    };
}
