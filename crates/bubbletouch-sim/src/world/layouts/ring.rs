//! Rings around the z axis, from which annuli, cylinders and caps are built.

use glam::DVec3;
use std::f64::consts::TAU;

/// Circle around the z axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ring {
    /// Radius of the ring, metres, not negative.
    pub radius: f64,
    /// Height z of the ring, metres.
    pub height: f64,
}

impl Ring {
    /// Returns points on the ring, evenly spaced by about `pitch` metres, the first at +x; at least one.
    pub fn places(self, pitch: f64) -> impl Iterator<Item = DVec3> {
        let n = n_steps(TAU * self.radius, pitch).max(1);
        (0..n).map(move |k| self.place(TAU * k as f64 / n as f64))
    }

    /// Returns the point of the ring at an angle from +x towards +y, radians.
    pub fn place(self, angle: f64) -> DVec3 {
        let (sin, cos) = angle.sin_cos();
        DVec3::new(self.radius * cos, self.radius * sin, self.height)
    }
}

/// Returns the number of equal steps into which a length is divided. Each step is between 0.75 and 1.5 pitches; 0 if the length is shorter than a step.
pub(crate) fn n_steps(length: f64, pitch: f64) -> usize {
    if length < 0.75 * pitch {
        return 0;
    }
    (length / pitch).round() as usize
}

/// Returns the ends of n equal steps of a length centred at zero, as fractions of the length. The ends are from −0.5 to 0.5, or only 0 if n is 0.
pub(crate) fn ends_of_steps(n: usize) -> impl Iterator<Item = f64> + Clone {
    (0..=n).map(move |step| match n {
        0 => 0.0,
        n => step as f64 / n as f64 - 0.5,
    })
}
