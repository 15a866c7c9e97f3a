//! Units of the keys of studies and scenes, and bounds of sizes that several of them share.

/// Metres in a millimetre.
pub(crate) const MM: f64 = 1e-3;

/// Frames a touch, at most: more is a rate or a number in the wrong unit.
pub(crate) const MOST_FRAMES: usize = 10_000;

/// Millimetres as people write them: 2, not 2.0000000000000004.
pub fn millimetres(metres: f64) -> f64 {
    (metres * 1e9).round() / 1e6
}

/// Taxels along a side of an array, at most.
pub(crate) const MOST_SIDE: usize = 4096;
