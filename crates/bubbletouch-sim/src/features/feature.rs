//! Description of image features, and the trait that computes them.

use super::image::Image;
use super::rings::RingWorkspace;
use super::spectrum::FourierWorkspace;
use crate::world::ImageShape;
use std::fmt::Debug;

/// Description of an image feature: name, size, and constructor.
#[derive(Debug)]
pub struct FeatureAbout {
    /// Display name of the feature.
    pub words: &'static str,
    /// Function that returns the number of feature values for an ny × nx image.
    pub n_values: fn(ImageShape) -> usize,
    /// Function that prepares the feature for ny × nx images with values up to a full scale.
    pub prepare: fn(ImageShape, f64) -> Box<dyn Feature>,
}

/// Image feature, prepared for images of one size.
pub trait Feature: Debug + Send + Sync {
    /// Writes the values of the feature for an image; zeros if no taxel is touched.
    fn write(&self, image: &Image, workspace: &mut FeatureWorkspace, out: &mut [f64]);
}

/// Scratch memory for image features: one instance per thread.
#[derive(Clone, Debug, Default)]
pub struct FeatureWorkspace {
    pub(super) image: Image,
    pub(super) fourier: FourierWorkspace,
    pub(super) rings: RingWorkspace,
}

/// Declares the image features and the module of each feature.
macro_rules! image_features {
    ($($name:ident $file:ident $doc:literal;)*) => {
        $(mod $file;)*

        /// Feature that is computed from an image of a frame.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[non_exhaustive]
        pub enum ImageFeature {
            $(#[doc = $doc] $name,)*
        }

        impl ImageFeature {
            /// List of all image features.
            pub const ALL: &[Self] = &[$(Self::$name),*];

            /// Names of the image features in the file of a study, with their display names.
            pub const NAMES: &[(&str, &str)] = &[$((stringify!($file), $file::ABOUT.words)),*];

            /// Returns the description of the image feature.
            pub const fn about(self) -> &'static FeatureAbout {
                match self {
                    $(Self::$name => &$file::ABOUT,)*
                }
            }
        }
    };
}

pub(super) use image_features;
