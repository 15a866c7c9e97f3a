//! Description of image features.

use super::image::Image;
use super::rings::RingWorkspace;
use super::spectrum::FourierWorkspace;
use std::fmt::Debug;

/// Description of an image feature.
#[derive(Debug)]
pub struct FeatureAbout {
    /// Name in reports and charts.
    pub words: &'static str,
    /// Returns the number of values for an ny × nx image.
    pub n_values: fn((usize, usize)) -> usize,
    /// Prepares the feature for ny × nx images of a full scale.
    pub prepare: fn((usize, usize), f64) -> Box<dyn Feature>,
}

/// Image feature, prepared for images of one size.
pub trait Feature: Debug + Send + Sync {
    /// Writes the values for an image; zeros if nothing is touched.
    fn write(&self, image: &Image, workspace: &mut Workspace, out: &mut [f64]);
}

/// Working memory for features: one per thread.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    pub(super) image: Image,
    pub(super) fourier: FourierWorkspace,
    pub(super) rings: RingWorkspace,
}

/// Declares the image features and the module of each.
macro_rules! image_features {
    ($($name:ident $file:ident $doc:literal;)*) => {
        $(mod $file;)*

        /// Feature of an image.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum ImageFeature {
            $(#[doc = $doc] $name,)*
        }

        impl ImageFeature {
            /// All image features.
            pub const ALL: &[Self] = &[$(Self::$name),*];

            /// Names in a study and names in texts.
            pub const NAMES: &[(&str, &str)] = &[$((stringify!($file), $file::ABOUT.words)),*];

            /// Returns the description of the feature.
            pub const fn about(self) -> &'static FeatureAbout {
                match self {
                    $(Self::$name => &$file::ABOUT,)*
                }
            }
        }
    };
}

pub(super) use image_features;
