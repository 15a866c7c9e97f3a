//! Inputs that determine the feature rows of a configuration: one row of features per touch.

use crate::learning::data::temporal_features::TemporalFeatures;
use crate::studies::recognition::spec::with_version;
use crate::world::ImageShape;
use bubbletouch_sim::features::{Features, Join};
use serde::Serialize;

/// Inputs that determine how features are computed from the measurements of a touch.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RowInputs {
    /// Numbers of rows and columns of the images that represent frames, one for each sensor.
    pub image_shapes: Vec<ImageShape>,
    /// Number of values of a measured frame: m measurements, or one value per taxel if the ensemble gives frames.
    pub measurements: usize,
    /// Number F of frames per touch.
    pub frames: usize,
    /// Method that combines the frames of a touch into features; `None` if the frames are concatenated.
    pub temporal_features: Option<TemporalFeatures>,
    /// Features that are computed from the measurements of a frame.
    #[serde(serialize_with = "with_version")]
    pub features: Features,
    /// Depth window of image features, as a fraction of the full scale; `None` for no window. Image features use only deflections that are within the window
    /// below the largest deflection of a frame.
    pub depth_window_full_scale: Option<f64>,
    /// Number of tilted copies that are added for each training touch.
    pub n_copies: usize,
}

impl RowInputs {
    /// Returns the description of the image features; `None` if the features are computed from measurements.
    pub fn of_images(&self) -> Option<FeaturesOfImages> {
        Some(FeaturesOfImages {
            join: self.features.of_image()?,
            foremost: self.depth_window_full_scale,
            measurements: self.measurements,
        })
    }

    /// Returns the number of features per frame.
    pub fn n_frame_features(&self) -> usize {
        match self.features.of_image() {
            Some(join) => join_values(join, &self.image_shapes),
            None => self
                .features
                .n_values(self.measurements, ImageShape::row(1)),
        }
    }

    /// Returns the number of features per touch.
    pub fn n_features(&self) -> usize {
        let (n_frames, m) = (self.frames, self.n_frame_features());
        self.temporal_features
            .map_or(n_frames * m, |kind| kind.n_features(n_frames, m))
    }
}

/// Image features that the configurations of a group need.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FeaturesOfImages {
    /// Kinds of image features whose values are concatenated into one feature vector.
    pub join: Join,
    /// Depth window of the features, as a fraction of the full scale; `None` for the whole image. The features use only deflections that are within the window
    /// below the largest deflection of a frame.
    pub foremost: Option<f64>,
    /// Number of measurements from which the images of frames are estimated.
    pub measurements: usize,
}

/// Returns the number of values of a combination of image features for a frame. The frame has one image for each sensor, given as numbers of rows and
/// columns.
pub fn join_values(join: Join, shapes: &[ImageShape]) -> usize {
    shapes.iter().map(|&shape| join.n_values(shape)).sum()
}
