//! Image features of configurations.

use crate::world::ImageShape;
use bubbletouch_sim::features::Join;

/// Image features that the configurations of a group need.
#[derive(Clone, Copy, Debug, PartialEq)]
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
