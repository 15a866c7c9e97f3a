//! Selection of the features of a touch by their names in a study.

use super::foreign::Foreign;
use super::{ImageFeature, Join, fourier_magnitude, fourier_mellin};
use crate::error::{Error, Result};
use crate::world::ImageShape;
use serde::{Deserialize, Serialize};

/// Features of a touch, as listed in the file of a study.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize,
)]
#[serde(try_from = "String", into = "String")]
#[non_exhaustive]
pub enum Features {
    /// Unchanged measurements.
    #[default]
    Raw,
    /// Measurements of each frame, without the component that a constant pressure causes.
    Centred,
    /// Measurements of each touch scaled to norm 1.
    UnitNorm,
    /// Measurements of each frame, without the component that a constant pressure causes, then scaled to norm 1 for each touch.
    CentredUnitNorm,
    /// Image features of each frame.
    OfImage(Join),
    /// Features from outside of this crate, computed from the measurements of each frame.
    Foreign(Foreign),
}

/// Features made of measurements: name in the file of a study, and value.
const OF_MEASUREMENTS: [(&str, Features); 4] = [
    ("raw", Features::Raw),
    ("centred", Features::Centred),
    ("unit_norm", Features::UnitNorm),
    ("centred_unit_norm", Features::CentredUnitNorm),
];

impl Features {
    /// Display names of features whose name in the file of a study is not clear enough.
    pub const NAMES: &[(&str, &str)] = &[
        ("centred_unit_norm", "centred, unit norm"),
        ("fourier_magnitude", fourier_magnitude::ABOUT.words),
        ("fourier_mellin", fourier_mellin::ABOUT.words),
        (
            "fourier_mellin+polar_harmonics+descriptors",
            "joined invariants",
        ),
    ];

    /// Returns the combination of image features; `None` for features made of measurements.
    pub fn of_image(self) -> Option<Join> {
        match self {
            Self::OfImage(join) => Some(join),
            _ => None,
        }
    }

    /// Returns the identity of foreign features; `None` for features of this crate.
    pub fn foreign(self) -> Option<Foreign> {
        match self {
            Self::Foreign(foreign) => Some(foreign),
            _ => None,
        }
    }

    /// Returns the number of feature values for a frame of m measurements of an ny × nx image. If foreign features have no code, the result is m.
    pub fn n_values(self, m: usize, shape: ImageShape) -> usize {
        match self {
            Self::OfImage(join) => join.n_values(shape),
            Self::Foreign(foreign) => foreign.n_values(m).unwrap_or(m),
            _ => m,
        }
    }

    /// Returns the text for the features in a study file: the name, followed by the version for foreign features.
    pub fn text(self) -> String {
        match self {
            Self::Foreign(foreign) => foreign.to_string(),
            other => other.into(),
        }
    }

    /// Returns whether `name` is the name of features of this crate.
    pub(super) fn is_own_name(name: &str) -> bool {
        let mut of_images = ImageFeature::ALL.iter().map(|one| one.name());
        OF_MEASUREMENTS.iter().any(|(known, _)| *known == name)
            || of_images.any(|known| known == name)
    }
}

impl From<Features> for String {
    fn from(features: Features) -> Self {
        match features {
            Features::OfImage(join) => return join.to_string(),
            Features::Foreign(foreign) => return foreign.name().to_owned(),
            _ => {}
        }
        let mut known = OF_MEASUREMENTS.iter();
        let found = known.find(|(_, known)| *known == features);
        found.map_or_else(Self::new, |(name, _)| (*name).to_owned())
    }
}

impl TryFrom<String> for Features {
    type Error = Error;

    fn try_from(text: String) -> Result<Self> {
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
