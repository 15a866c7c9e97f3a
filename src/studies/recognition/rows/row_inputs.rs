//! Inputs of the rows of features that a cell learns from.

use crate::learning::data::over_time::OverTime;
use crate::studies::recognition::rows::image_features::FeaturesOfImages;
use bubbletouch_sim::features::Features;

/// Inputs of the features of a touch.
#[derive(Clone, Debug, PartialEq)]
pub struct RowInputs {
    /// Rows and columns of the images of frames.
    pub image_shape: (usize, usize),
    /// Measurements of a frame, m.
    pub measurements: usize,
    /// Frames of a touch, F.
    pub frames: usize,
    /// How the frames are combined; `None`: one after the other.
    pub over_time: Option<OverTime>,
    /// Features of a frame's measurements.
    pub features: Features,
    /// Depth, behind the foremost point, up to which features of images see, as a fraction of the full scale.
    pub foremost_full_scale: Option<f64>,
    /// Tilted copies of each training touch.
    pub n_copies: usize,
}

impl RowInputs {
    /// Returns the features of images among them; `None` if features are of measurements.
    pub fn of_images(&self) -> Option<FeaturesOfImages> {
        Some(FeaturesOfImages {
            join: self.features.of_image()?,
            foremost: self.foremost_full_scale,
            measurements: self.measurements,
        })
    }

    /// Returns the number of features of a frame.
    pub fn n_frame_features(&self) -> usize {
        self.features.n_values(self.measurements, self.image_shape)
    }

    /// Returns the number of features of a touch.
    pub fn n_features(&self) -> usize {
        let (n_frames, m) = (self.frames, self.n_frame_features());
        self.over_time
            .map_or(n_frames * m, |kind| kind.n_features(n_frames, m))
    }
}
