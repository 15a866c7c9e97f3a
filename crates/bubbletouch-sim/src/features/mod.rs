//! Features: what is made of a touch before a classifier scales and learns it.
//!
//! The measurements of a touch are F frames of m, one after the other (F = 1 unless a touch is read at several depths). Everything here is
//! done to one touch at a time and learns nothing of objects, so training and test touches need not be kept apart.
//!
//! **Of measurements** ([`measured`]): raw, without what a constant pressure adds (centred), at norm 1, or both.
//!
//! **Of images** ([`ImageFeature`], and joins of several): numbers that stay as they are when the contact moves over the array or turns on it,
//! which is most of what differs between two touches of one object that nothing holds in place. They need the frame; where it was
//! compressed, its [linear estimate](crate::sensing::ImageEstimate) stands for it. Of a patch without rows and columns they see its [`Chart`].
//!
//! | feature | numbers (64 × 64) | shift | turn | mirror image | more pressure | deeper |
//! |---|---|---|---|---|---|---|
//! | raw, centred | m | | | | of centred: + a | |
//! | unit norm | m | | | | × a | |
//! | [`FourierMagnitude`](ImageFeature::FourierMagnitude) | 925 | exact, cyclic | | | | |
//! | [`FourierMellin`](ImageFeature::FourierMellin) | 216 | exact, cyclic | exact by 90° | yes | | |
//! | [`PolarHarmonics`](ImageFeature::PolarHarmonics) | 416 | exact by taxels | exact by 90° | yes | | |
//! | [`Descriptors`](ImageFeature::Descriptors) | 126 | exact by taxels | exact by 90° | all but 3 | 51 of them | 24 of them |
//! | [`Aligned`](ImageFeature::Aligned) | 1,024 | exact by taxels | exact by 90° | | | |
//!
//! Exact by taxels: by a whole number of taxels, while the contact stays on the array; exact by 90°: to rounding, on a square array. Other
//! shifts and turns change what taxels sample of the object, and features as much as that. Four
//! times the pressure makes magnitudes and harmonics, of which these are roots, four times as large.

mod chart;
mod feature;
mod image;
pub mod measured;
mod moments;
mod rings;
mod spectrum;
mod tilted;

pub use chart::Chart;
use feature::image_features;
pub use feature::{Feature, FeatureAbout, ImageFeatures, Join, Workspace};
pub use image::{Cut, Image, Touched};
pub use moments::{N_MOMENTS, Weight, moments};
pub use tilted::tilt_frame;

use crate::error::Error;
use serde::{Deserialize, Serialize};

// Everything that a study may say of a feature of images follows from its line here and from the file that it names.
image_features! {
    FourierMagnitude fourier_magnitude "Roots of the magnitudes of the Fourier transform at low frequencies.";
    FourierMellin fourier_mellin "Harmonics over the angle of the Fourier magnitude in rings.";
    PolarHarmonics polar_harmonics "Harmonics over the angle of the image in rings about its centroid.";
    Descriptors descriptors "Areas at levels, moments, and the pressure's fall from the centroid.";
    Aligned aligned "The image itself, moved to its centroid and turned to its principal axes.";
}

/// What is made of a touch.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize,
)]
#[serde(try_from = "String", into = "String")]
pub enum Features {
    /// The measurements.
    #[default]
    Raw,
    /// Each frame without what a constant pressure adds to it.
    Centred,
    /// Each touch scaled to norm 1.
    UnitNorm,
    /// Centred, then scaled to norm 1.
    CentredUnitNorm,
    /// Of each frame as an image.
    OfImage(Join),
}

/// Features of measurements: name in a study, and what people call it where that is something else.
const OF_MEASUREMENTS: [(&str, Features); 4] = [
    ("raw", Features::Raw),
    ("centred", Features::Centred),
    ("unit_norm", Features::UnitNorm),
    ("centred_unit_norm", Features::CentredUnitNorm),
];

impl Features {
    /// What people call those whose name does not say it.
    pub const NAMES: &[(&str, &str)] = &[
        ("centred_unit_norm", "centred, unit norm"),
        ("fourier_magnitude", fourier_magnitude::ABOUT.words),
        ("fourier_mellin", fourier_mellin::ABOUT.words),
        (
            "fourier_mellin+polar_harmonics+descriptors",
            "joined invariants",
        ),
    ];

    /// The features of images, of those that are.
    pub fn of_image(self) -> Option<Join> {
        match self {
            Self::OfImage(join) => Some(join),
            _ => None,
        }
    }

    /// How many numbers it makes of a frame of m measurements of an ny × nx array.
    pub fn n_values(self, m: usize, shape: (usize, usize)) -> usize {
        self.of_image().map_or(m, |join| join.n_values(shape))
    }
}

impl From<Features> for String {
    fn from(features: Features) -> Self {
        if let Features::OfImage(join) = features {
            return join.to_string();
        }
        let mut known = OF_MEASUREMENTS.iter();
        let found = known.find(|(_, known)| *known == features);
        found.map_or_else(Self::new, |(name, _)| (*name).to_owned())
    }
}

impl TryFrom<String> for Features {
    type Error = Error;

    fn try_from(text: String) -> Result<Self, Error> {
        let mut known = OF_MEASUREMENTS.iter();
        if let Some((_, features)) = known.find(|(name, _)| *name == text) {
            return Ok(*features);
        }
        let all = ImageFeature::ALL.iter().copied();
        let named = |name: &str| all.clone().find(|feature| feature.name() == name.trim());
        let features: Option<Vec<ImageFeature>> = text.split('+').map(named).collect();
        match features {
            Some(features) => Join::new(&features).map(Self::OfImage),
            None => {
                let of_measurements = OF_MEASUREMENTS.map(|(name, _)| name).join(", ");
                let of_images = all.map(ImageFeature::name).collect::<Vec<_>>().join(", ");
                let allowed =
                    format!("{of_measurements}, or {of_images}, or several of these joined by +");
                Err(Error::input("features", format!("{text:?}"), allowed))
            }
        }
    }
}

#[cfg(test)]
mod tests;
