//! Description of a feature of images.

use super::image::Image;
use super::rings::RingWorkspace;
use super::spectrum::FourierWorkspace;
use std::fmt::Debug;

/// A feature of images.
#[derive(Debug)]
pub struct FeatureAbout {
    /// What people call it.
    pub words: &'static str,
    /// How many numbers it makes of an ny × nx image.
    pub n_values: fn((usize, usize)) -> usize,
    /// Prepares it for ny × nx images of a full scale.
    pub prepare: fn((usize, usize), f64) -> Box<dyn Feature>,
}

/// A feature that is prepared for images of one size.
pub trait Feature: Debug + Send + Sync {
    /// Writes its numbers of an image; zeros of one that nothing touches.
    fn write(&self, image: &Image, workspace: &mut Workspace, out: &mut [f64]);
}

/// What features are made in: one a thread.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    pub(super) image: Image,
    pub(super) fourier: FourierWorkspace,
    pub(super) rings: RingWorkspace,
}

/// Says of each feature of images which file tells of it.
macro_rules! image_features {
    ($($name:ident $file:ident $doc:literal;)*) => {
        $(mod $file;)*

        /// What is made of an image.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum ImageFeature {
            $(#[doc = $doc] $name,)*
        }

        impl ImageFeature {
            /// All of them.
            pub const ALL: &[Self] = &[$(Self::$name),*];

            /// The name in a study, and what people call it.
            pub const NAMES: &[(&str, &str)] = &[$((stringify!($file), $file::ABOUT.words)),*];

            /// What it says of itself.
            pub const fn about(self) -> &'static FeatureAbout {
                match self {
                    $(Self::$name => &$file::ABOUT,)*
                }
            }
        }
    };
}

pub(super) use image_features;
