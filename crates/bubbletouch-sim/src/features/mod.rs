//! Features: quantities computed from a touch, which a classifier then scales and learns.
//!
//! The measurements of a touch are F frames of m values, one after the other (F = 1 unless a touch is read at several depths). Features are
//! computed from one touch at a time without knowledge of objects, so training and test touches need not be separated.
//!
//! **Measurement features** ([`measured`]): unchanged measurements, measurements without the effect of a constant pressure (centred), at norm 1, or both.
//!
//! **Image features** ([`ImageFeature`], and joins of several) are numbers that are invariant to shifts and rotations of the contact on the array. Shifts and
//! rotations cause most differences between touches of a free object. Image features need the frame; if it was compressed, the linear estimate of the image
//! replaces it. A patch without rows and columns uses its [`Chart`].
//!
//! [Foreign features](foreign) are a function of a program that uses this crate.
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
//! The entry "exact by taxels" means for shifts by a whole number of taxels while the contact stays on the array. The entry "exact by 90°" means up to
//! rounding, on a square array. Other shifts and rotations change the features as much as the sampling by taxels changes the image. Four times the pressure
//! doubles magnitudes and harmonics, because these are square roots.

mod chart;
mod feature;
pub mod foreign;
mod image;
mod join;
pub mod measured;
mod moments;
mod rings;
mod selection;
mod spectrum;
mod tilted;

pub use chart::Chart;
pub use feature::FeatureWorkspace;
use feature::image_features;
#[doc(hidden)]
pub use feature::{Feature, FeatureAbout};
pub use image::{Cut, Image, Touched};
pub use join::{ImageFeatures, Join};
pub use moments::{N_MOMENTS, Weight, moments};
pub use selection::Features;
pub use tilted::tilt_frame;

// The properties of an image feature follow from its line here and from the module that the line names.
image_features! {
    FourierMagnitude fourier_magnitude "Roots of the magnitudes of the Fourier transform at low frequencies.";
    FourierMellin fourier_mellin "Harmonics over the angle of the Fourier magnitude in rings.";
    PolarHarmonics polar_harmonics "Harmonics over the angle of the image in rings about its centroid.";
    Descriptors descriptors "Areas at levels, moments, and the pressure's fall from the centroid.";
    Aligned aligned "The image itself, moved to its centroid and turned to its principal axes.";
}

#[cfg(test)]
mod tests;
