//! Descriptions of ensembles, and the operations of their maps.

use crate::error::Result;
use crate::own::{Own, Registry};
use crate::random::Seed;
use crate::sensing::{Ensemble, Selection};
use crate::world::ImageShape;
use ndarray::{Array2, ArrayView2, ArrayViewMut2};
use std::fmt::Debug;
use std::sync::OnceLock;

/// Function that draws the linear map from an ny × nx array to m measurements with its own random stream, 1 ≤ m ≤ ny · nx.
pub type Draw = fn(ImageShape, usize, &Seed) -> Box<dyn Operator>;

/// Function that learns the map from an ny × nx array to m measurements from frames of training touches, with its own random stream, 1 ≤ m ≤ ny · nx.
pub type Learn = fn(&TrainingFrames, ImageShape, usize, &Seed) -> Result<Box<dyn Operator>>;

/// Origin of a measurement map.
#[derive(Clone, Copy, Debug)]
pub enum Source {
    /// The map is drawn at random or fixed.
    Drawn(Draw),
    /// The map is learned from frames of training touches.
    Learned(Learn),
}

/// Frames of training touches from which a measurement map is learned.
#[derive(Clone, Copy, Debug)]
pub struct TrainingFrames<'a> {
    /// Frames, shape (n_frames, n_taxels), at least one frame.
    pub frames: ArrayView2<'a, f64>,
    /// Class of each frame, shape (n_frames,); empty if the classes are unknown.
    pub labels: &'a [usize],
    /// Group of each frame, shape (n_frames,); empty if each frame is its own group. Validation compares a frame only with frames of other groups.
    pub groups: &'a [usize],
    /// Method by which the ensemble `selected` selects taxels; other ensembles do not use it.
    pub selection: Selection,
}

/// Training frames of unknown classes.
impl<'a> From<ArrayView2<'a, f64>> for TrainingFrames<'a> {
    fn from(frames: ArrayView2<'a, f64>) -> Self {
        Self {
            frames,
            labels: &[],
            groups: &[],
            selection: Selection::default(),
        }
    }
}

/// Description of an ensemble, that is, a family of measurement maps.
#[derive(Debug)]
pub struct EnsembleAbout {
    /// Display name of the ensemble.
    pub words: &'static str,
    /// Whether the projection to m measurements gives the first m measurements of any larger projection with the same seed.
    pub is_prefix_nested: bool,
    /// Whether the ensemble measures every taxel separately for any requested number of measurements.
    pub is_whole_frame: bool,
    /// Whether earlier readings of a frame determine its later readings. Such a map is not linear; it returns an estimate of the frame, one value per taxel.
    pub is_adaptive: bool,
    /// Whether the ensemble requires a grid of taxels with rows and columns.
    pub needs_rows: bool,
    /// Function that returns the memory of a projection, bytes. Its arguments are the numbers of measurements and of taxels.
    pub bytes: fn(f64, f64) -> f64,
    /// Origin of the measurement map: drawn at random, or learned from frames.
    pub source: Source,
}

impl EnsembleAbout {
    /// Describes an ensemble with default properties: nested measurements, 16 bytes for each taxel, and any layout. The map is drawn by `draw`.
    pub const fn new(words: &'static str, draw: Draw) -> Self {
        Self {
            words,
            is_prefix_nested: true,
            is_whole_frame: false,
            is_adaptive: false,
            needs_rows: false,
            bytes: |_, n| 16.0 * n,
            source: Source::Drawn(draw),
        }
    }

    /// Describes an ensemble that `learn` learns, with default properties: measurements that are not nested, a stored matrix, and any layout.
    pub const fn learned(words: &'static str, learn: Learn) -> Self {
        Self {
            words,
            is_prefix_nested: false,
            is_whole_frame: false,
            is_adaptive: false,
            needs_rows: false,
            bytes: |m, n| 16.0 * n * m,
            source: Source::Learned(learn),
        }
    }
}

/// Map from a frame x to its measurements y: linear, y = Φx, unless the ensemble is adaptive. An adaptive map has no matrix Φ.
pub trait Operator: Debug + Send + Sync {
    /// Measures frames (n_frames × n_taxels) and overwrites `out` (n_frames × n_measurements). The measurements of a frame have equal bits in any batch of
    /// frames.
    fn measure(&self, frames: ArrayView2<f64>, out: ArrayViewMut2<f64>);

    /// Calls `visit(measurement, taxel, value)` for each entry of Φ that can be nonzero, always in one order. An adaptive map visits nothing.
    fn each_entry(&self, visit: &mut dyn FnMut(usize, usize, f64));

    /// Returns the root mean square norm of the rows of Φ, by default 1. For an adaptive map, returns an upper bound of the noise of values divided by the noise of
    /// taxels.
    fn row_norm(&self) -> f64 {
        1.0
    }

    /// Returns the indices of the taxels that are read, in the order of the measurements, if each measurement is one taxel; otherwise `None`.
    fn taxels(&self) -> Option<&[usize]> {
        None
    }

    /// Returns the matrix Φ if it is stored, otherwise `None`.
    fn stored(&self) -> Option<&Array2<f64>> {
        None
    }

    /// Returns the Gram matrix ΦΦᵀ if a formula gives it without Φ, otherwise `None`.
    fn known_gram(&self) -> Option<Array2<f64>> {
        None
    }
}

/// Ensembles that a program has registered.
static OWN: Registry<EnsembleAbout> = Registry::new("ensemble");

impl Ensemble {
    /// Registers an ensemble from outside of this crate, before the first study is read. Studies name it like a built-in ensemble; it is written as
    /// `name@version`.
    ///
    /// ```
    /// use bubbletouch_sim::random::Seed;
    /// use bubbletouch_sim::sensing::{Ensemble, EnsembleAbout, Operator, Projection};
    /// use bubbletouch_sim::world::ImageShape;
    /// use ndarray::{ArrayView2, ArrayViewMut2, array, s};
    ///
    /// /// Reads the first m taxels.
    /// #[derive(Debug)]
    /// struct First(usize);
    ///
    /// impl Operator for First {
    ///     fn measure(&self, frames: ArrayView2<f64>, mut out: ArrayViewMut2<f64>) {
    ///         out.assign(&frames.slice(s![.., ..self.0]));
    ///     }
    ///
    ///     fn each_entry(&self, visit: &mut dyn FnMut(usize, usize, f64)) {
    ///         (0..self.0).for_each(|taxel| visit(taxel, taxel, 1.0));
    ///     }
    /// }
    ///
    /// let about = EnsembleAbout::new("first taxels", |_, m, _| Box::new(First(m)));
    /// let first = Ensemble::register("first", "1", about)?;
    /// let projection = Projection::new(first, ImageShape { ny: 1, nx: 4 }, 2, &Seed::new(1))?;
    /// assert_eq!(projection.measure(array![[1.0, 2.0, 3.0, 4.0]].view()), array![[1.0, 2.0]]);
    /// # Ok::<(), bubbletouch_sim::Error>(())
    /// ```
    ///
    /// # Errors
    /// If another ensemble has the name, the name or the version is invalid, or a study was read before.
    pub fn register(
        name: &'static str,
        version: &'static str,
        about: EnsembleAbout,
    ) -> Result<Self> {
        let is_taken = Self::NAMES.iter().any(|(known, _)| *known == name);
        OWN.register(name, version, about, is_taken).map(Self::Own)
    }

    /// Returns the registered ensemble that a study names: its name, or `name@version`.
    pub(super) fn own(text: &str) -> Option<Self> {
        OWN.named(text).map(Self::Own)
    }

    /// Returns the names of all ensembles in the files of studies; those of registered ensembles are last, without and with the version.
    pub(super) fn names() -> &'static [&'static str] {
        static NAMES: OnceLock<Vec<&str>> = OnceLock::new();
        NAMES.get_or_init(|| {
            let built_in = Self::NAMES.iter().map(|(name, _)| *name);
            let texts = |own: &Own<_>| [own.name(), own.to_string().leak()];
            built_in.chain(OWN.all().iter().flat_map(texts)).collect()
        })
    }

    /// Returns whether the projection to m measurements gives the first m measurements of any larger projection with the same seed.
    pub fn is_prefix_nested(self) -> bool {
        self.about().is_prefix_nested
    }

    /// Returns whether the map is learned from frames of training touches.
    pub fn is_learned(self) -> bool {
        matches!(self.about().source, Source::Learned(_))
    }

    /// Returns whether the map is drawn at random or fixed, and therefore linear and independent of all frames.
    pub fn is_drawn(self) -> bool {
        !self.about().is_adaptive && !self.is_learned()
    }

    /// Returns whether a measured frame has one value per taxel: each taxel is measured, or an adaptive readout estimates it.
    pub fn gives_frames(self) -> bool {
        self.about().is_whole_frame || self.about().is_adaptive
    }

    /// Returns the number of values of a measured frame for n taxels and a requested number m of measurements. The result is n if the ensemble gives one
    /// value per taxel, otherwise m.
    pub fn n_measurements(self, m: usize, n: usize) -> usize {
        match self.gives_frames() {
            true => n,
            false => m,
        }
    }
}

/// Declares the ensembles, and the module that contains each ensemble.
macro_rules! ensembles {
    ($($name:ident $file:ident $doc:literal;)*) => {
        $(mod $file;)*

        /// Family of linear maps that compress a frame to measurements.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
        #[serde(rename_all = "snake_case")]
        #[non_exhaustive]
        pub enum Ensemble {
            $(#[doc = $doc] $name,)*
            /// Ensemble from outside of this crate; see [`register`](Self::register).
            #[serde(untagged)]
            Own(crate::own::Own<EnsembleAbout>),
        }

        /// Deserialises an ensemble from its name, or from `name@version` if it is registered.
        impl<'de> Deserialize<'de> for Ensemble {
            fn deserialize<D: serde::Deserializer<'de>>(names: D) -> Result<Self, D::Error> {
                match &*String::deserialize(names)? {
                    $(stringify!($file) => Ok(Self::$name),)*
                    other => Self::own(other)
                        .ok_or_else(|| serde::de::Error::unknown_variant(other, Self::names())),
                }
            }
        }

        impl Ensemble {
            /// List of all ensembles of this crate.
            pub const ALL: &[Self] = &[$(Self::$name),*];

            /// Names of the ensembles of this crate in the file of a study, with their display names.
            pub const NAMES: &[(&str, &str)] = &[$((stringify!($file), $file::ABOUT.words)),*];

            /// Returns the description of the ensemble.
            pub const fn about(self) -> &'static EnsembleAbout {
                match self {
                    $(Self::$name => &$file::ABOUT,)*
                    Self::Own(own) => own.about(),
                }
            }
        }
    };
}
