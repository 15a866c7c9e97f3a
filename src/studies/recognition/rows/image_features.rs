//! Features of images that cells learn from.

use bubbletouch_sim::features::Join;

/// What cells of a group learn from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeaturesOfImages {
    /// Which.
    pub join: Join,
    /// Of what is so far behind the foremost point, as a fraction of the full scale.
    pub foremost: Option<f64>,
    /// From how many measurements.
    pub measurements: usize,
}
