//! Layouts on a part of a sphere: rings of taxels at approximately equal distances.

use super::limits::{check_angle, check_count};
use crate::error::Result;
use crate::text::in_range::positive;
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Dome: a slice (lune) of a sphere around the origin, from its pole at +z. The dome is divided into rings of taxels whose axes point away from the centre.
///
/// Taxels are numbered ring by ring from the pole, each ring by ascending angle. Invariant: the polar angles of the rings ascend, no ring is empty, and each
/// vector in `directions` has length one.
#[derive(Clone, Debug, PartialEq)]
pub struct Dome {
    radius: f64,
    rings: Vec<DomeRing>,
    /// Cosine and sine of each taxel's angle around the z axis, from +x towards +y, shape (n_taxels,).
    directions: Vec<DVec2>,
}

/// Ring of taxels at one polar angle of a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DomeRing {
    /// Cosine of the polar angle of the ring.
    pub cos: f64,
    /// Sine of the polar angle of the ring.
    pub sin: f64,
    /// Index of the ring's first taxel.
    pub first: usize,
    /// Number of taxels in the ring, at least 1.
    pub n: usize,
    /// Angle of the first taxel from +x towards +y, radians.
    pub start: f64,
    /// Angle between adjacent taxels of the ring, radians.
    pub step: f64,
}

impl Dome {
    /// Returns the centres (at rest, metres) and the unit axes of all taxels, ring by ring.
    pub(crate) fn taxels(&self) -> impl Iterator<Item = (DVec3, DVec3)> {
        let axes = self.axes().map(DVec3::normalize);
        axes.map(|axis| (self.radius * axis, axis))
    }

    /// Creates a dome that extends `polar` radians from the pole (above 0 to π). The dome is `arc` radians wide (above 0 to 2π), with its middle at +x.
    ///
    /// The distances between rings, and between the taxels of a ring, are about `pitch` (metres), adjusted to whole numbers of rings and taxels. Half a
    /// distance is left at every edge, so that taxels of an adjacent dome or cylinder continue at equal distances.
    ///
    /// # Errors
    /// If an argument is out of its range, or the layout has too many taxels.
    pub fn new(radius: f64, polar: f64, arc: f64, pitch: f64) -> Result<Self> {
        positive("taxel pitch", pitch, "m")?;
        positive("dome radius", radius, "m")?;
        check_angle("dome polar angle", polar, PI)?;
        check_angle("dome arc", arc, TAU)?;
        let area = arc * radius * radius * (1.0 - polar.cos());
        check_count("dome layout", (area / (pitch * pitch)).max(1.0))?;
        let steps = |length: f64| (length / pitch).round().max(1.0);
        let n_rings = steps(radius * polar);
        let (mut rings, mut directions) = (Vec::new(), Vec::new());
        for ring in 0..n_rings as usize {
            let (sin, cos) = (polar * (ring as f64 + 0.5) / n_rings).sin_cos();
            let n = steps(arc * radius * sin);
            let step = arc / n;
            let start = 0.5 * (step - arc);
            rings.push(DomeRing {
                cos,
                sin,
                first: directions.len(),
                n: n as usize,
                start,
                step,
            });
            let angles = (0..n as usize).map(|k| start + k as f64 * step);
            directions.extend(angles.map(DVec2::from_angle));
        }
        Ok(Self {
            radius,
            rings,
            directions,
        })
    }

    /// Returns the distance of the taxels' centres (at rest) from the centre of the sphere, metres.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Returns the rings of taxels, beginning at the pole.
    pub fn rings(&self) -> &[DomeRing] {
        &self.rings
    }

    /// Returns the cosine and sine of each taxel's angle around the z axis, shape (n_taxels,).
    pub fn directions(&self) -> &[DVec2] {
        &self.directions
    }

    /// Returns the number of taxels of the dome.
    pub fn n_taxels(&self) -> usize {
        self.directions.len()
    }

    /// Returns the unit axes of all taxels, ring by ring.
    pub fn axes(&self) -> impl Iterator<Item = DVec3> + Clone {
        self.rings.iter().flat_map(|ring| {
            let directions = &self.directions[ring.first..ring.first + ring.n];
            directions
                .iter()
                .map(|around| (ring.sin * *around).extend(ring.cos))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objects::nearest_distances;
    use crate::world::Layout;

    #[test]
    fn taxels_are_about_a_pitch_apart_and_fill_the_area() {
        let pitch = 2e-3;
        for (radius, polar, arc) in [
            (0.05, 0.5 * PI, TAU),
            (0.08, 0.5 * PI, TAU / 5.0),
            (0.04, 1.0, 2.0),
            (0.03, PI, TAU),
        ] {
            let layout = Layout::from(Dome::new(radius, polar, arc, pitch).unwrap());
            for distance in nearest_distances(layout.centers()) {
                // Three taxels around a pole are as near as 0.86 pitches; the single first taxel of a narrow lune has no neighbour so near.
                assert!((0.7..1.5).contains(&(distance / pitch)), "{distance}");
            }
            let area = arc * radius * radius * (1.0 - polar.cos());
            let filled = layout.n_taxels() as f64 * pitch * pitch / area;
            assert!((filled - 1.0).abs() < 0.02, "{filled}");
            for (center, axis) in layout.centers().iter().zip(layout.axes()) {
                assert!(center.distance(radius * *axis) < 1e-15);
                assert!(axis.z >= polar.cos() && axis.y.atan2(axis.x).abs() <= 0.5 * arc);
            }
        }
    }

    #[test]
    fn lunes_make_a_whole_without_gap_or_overlap() {
        let (radius, pitch) = (0.05, 2e-3);
        let lune = Layout::from(Dome::new(radius, 0.5 * PI, TAU / 4.0, pitch).unwrap());
        let turned = |k: usize| glam::DQuat::from_rotation_z(TAU * k as f64 / 4.0);
        let turn = |k: usize| lune.centers().iter().map(move |c| turned(k) * *c);
        let centers: Vec<DVec3> = (0..4).flat_map(turn).collect();
        let whole = Layout::new(centers.clone(), vec![DVec3::Z; centers.len()]).unwrap();
        for distance in nearest_distances(whole.centers()) {
            assert!((0.6..1.3).contains(&(distance / pitch)), "{distance}");
        }
    }
}
