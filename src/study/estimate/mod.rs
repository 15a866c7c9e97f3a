//! What touches, measurements and fits of a recognition study are planned to take.

mod learning;
mod measuring;
mod touching;

pub(super) use learning::family_s;
pub(super) use measuring::{measure_s, project_s};
pub(super) use touching::{PLACE_SPHERE_S, PLACE_TRIANGLE_S, touch_s};

use std::fmt;

/// Seconds in words.
pub(super) struct Seconds(pub f64);

impl fmt::Display for Seconds {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.0 {
            s if s < 1.0 => write!(f, "1 s"),
            s if s < 100.0 => write!(f, "{s:.0} s"),
            s if s < 6000.0 => write!(f, "{:.0} min", s / 60.0),
            s => write!(f, "{:.1} h", s / 3600.0),
        }
    }
}
