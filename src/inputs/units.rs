//! Units of the keys in studies and scenes, and common bounds of sizes.

/// One millimetre in metres, the factor that converts mm to m.
pub(crate) const MM: f64 = 1e-3;

/// Maximum number of frames in a touch; a larger number indicates that the frame rate or a unit is wrong.
pub(crate) const MAX_FRAMES: usize = 10_000;

/// Converts metres to millimetres and rounds the result for display, for example to 2 instead of 2.0000000000000004.
pub fn millimetres(metres: f64) -> f64 {
    (metres * 1e9).round() / 1e6
}

/// Maximum number of taxels along a side of an array.
pub(crate) const MAX_SIDE: usize = 4096;
