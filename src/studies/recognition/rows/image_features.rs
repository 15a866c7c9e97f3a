//! Image features of configurations.

use bubbletouch_sim::features::Join;

/// Image features that the configurations of a group use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeaturesOfImages {
    /// Kinds of image features, joined into one feature vector.
    pub join: Join,
    /// Depth window behind the foremost point, as a fraction of the full scale.
    pub foremost: Option<f64>,
    /// Number of measurements from which the images are estimated.
    pub measurements: usize,
}
