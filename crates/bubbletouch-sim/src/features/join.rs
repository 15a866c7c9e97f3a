//! Joins: several image features, one after the other.

use super::ImageFeature;
use super::feature::{Feature, FeatureWorkspace};
use super::image::Cut;
use crate::error::{Error, Result};
use crate::world::ImageShape;
use std::fmt::{self, Debug};

/// Combination of image features, whose values follow one another in the order of the list of all features. Each bit marks one feature.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize)]
#[serde(into = "String")]
pub struct Join(u8);

impl Join {
    /// Creates the combination of image features: at least one, each at most once.
    ///
    /// # Errors
    /// If there is no feature, or one occurs twice.
    pub fn new(features: &[ImageFeature]) -> Result<Self> {
        let mut join = Self(0);
        for &feature in features {
            let bit = 1 << feature as u8;
            if join.0 & bit != 0 {
                return Err(Error::input("features", feature.name(), "each once"));
            }
            join.0 |= bit;
        }
        match join.0 {
            0 => Err(Error::input("features", "none", "at least one")),
            _ => Ok(join),
        }
    }

    /// Returns the combined features in their order.
    pub fn features(self) -> impl Iterator<Item = ImageFeature> {
        let all = ImageFeature::ALL.iter().copied();
        all.filter(move |&feature| self.0 & (1 << feature as u8) != 0)
    }

    /// Returns the number of values of the combined features for an ny × nx image.
    pub fn n_values(self, shape: ImageShape) -> usize {
        self.features().map(|f| (f.about().n_values)(shape)).sum()
    }
}

/// Writes the name of the combination in the file of a study, such as `fourier_mellin+descriptors`.
impl fmt::Display for Join {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let names: Vec<&str> = self.features().map(ImageFeature::name).collect();
        f.write_str(&names.join("+"))
    }
}

impl From<Join> for String {
    fn from(join: Join) -> Self {
        join.to_string()
    }
}

impl Debug for Join {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl ImageFeature {
    /// Returns the name of the combination in the file of a study.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize].0
    }
}

/// Combination of image features, prepared for images of one size and full scale.
#[derive(Debug)]
pub struct ImageFeatures {
    nx: usize,
    cut: Cut,
    /// Prepared features, each with its number of values.
    features: Vec<(Box<dyn Feature>, usize)>,
}

impl ImageFeatures {
    /// Prepares the features of `join` for images of ny × nx values from 0 to `full_scale`; `cut` describes the omitted parts of a frame.
    pub fn new(join: Join, shape: ImageShape, full_scale: f64, cut: Cut) -> Self {
        let features = join.features().map(|feature| {
            let about = feature.about();
            ((about.prepare)(shape, full_scale), (about.n_values)(shape))
        });
        Self {
            nx: shape.nx,
            cut,
            features: features.collect(),
        }
    }

    /// Writes the features of a frame (ny · nx values, row after row). Allocates no memory after the first call with frames of this size.
    ///
    /// # Panics
    /// If the length of `out` differs from the number of values of the join.
    pub fn write(&self, frame: &[f64], workspace: &mut FeatureWorkspace, out: &mut [f64]) {
        let mut image = std::mem::take(&mut workspace.image);
        image.read(frame, self.nx, self.cut);
        let mut out = out;
        for (feature, n_values) in &self.features {
            let (own, rest) = out.split_at_mut(*n_values);
            feature.write(&image, workspace, own);
            out = rest;
        }
        assert!(out.is_empty(), "numbers of the join");
        workspace.image = image;
    }
}
