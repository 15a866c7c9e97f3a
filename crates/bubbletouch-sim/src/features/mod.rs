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
mod join;
pub mod measured;
mod moments;
mod rings;
mod selection;
mod spectrum;
mod tilted;

pub use chart::Chart;
use feature::image_features;
pub use feature::{Feature, FeatureAbout, Workspace};
pub use image::{Cut, Image, Touched};
pub use join::{ImageFeatures, Join};
pub use moments::{N_MOMENTS, Weight, moments};
pub use selection::Features;
pub use tilted::tilt_frame;

// Everything that a study may say of a feature of images follows from its line here and from the file that it names.
image_features! {
    FourierMagnitude fourier_magnitude "Roots of the magnitudes of the Fourier transform at low frequencies.";
    FourierMellin fourier_mellin "Harmonics over the angle of the Fourier magnitude in rings.";
    PolarHarmonics polar_harmonics "Harmonics over the angle of the image in rings about its centroid.";
    Descriptors descriptors "Areas at levels, moments, and the pressure's fall from the centroid.";
    Aligned aligned "The image itself, moved to its centroid and turned to its principal axes.";
}

#[cfg(test)]
mod tests;
