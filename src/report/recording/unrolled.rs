//! Projection of a skin to a plane, which gives the position of each taxel in the picture.
//!
//! Flat skins are seen from above. Cylinders are unrolled. Parts of spheres are flattened about their middle with true distances from it (azimuthal
//! equidistant projection). A skin is detected as a sphere if its rest centres p and axes n satisfy p = c + R n. It is detected as a cylinder if this holds
//! without the axial parts. Any other skin is seen along the mean of its axes or, if there is none, on its broad side. If some taxels face away, the
//! picture also shows the view from behind.

use crate::table::short_number;
use glam::{DMat3, DVec2, DVec3};

/// Minimum cosine of the angle between each taxel axis and the mean axis (10°) for a skin to be drawn as flat. The projection then shortens lengths by at most
/// 1.5 %.
const FLAT: f64 = 0.985;
/// Maximum deviation of the taxels from a fitted sphere or cylinder, relative to its radius. With a larger value, ellipsoids are accepted as spheres; with a
/// smaller value, printed shapes are rejected.
const FIT: f64 = 0.05;
/// Maximum angle between taxels and the middle of a sphere that is drawn flat, radians. At larger angles, the rim would be drawn more than twice as long as it
/// is.
const WIDEST_CAP: f64 = 1.9;

/// Positions of the taxels of a skin after projection onto a plane.
pub(super) struct Unrolled {
    /// Position of each taxel in the plane, to the right and up, metres.
    pub places: Vec<DVec2>,
    /// Sentence below the picture that describes the projection.
    pub sentence: String,
}

/// Returns a matrix whose rows are the directions right, up and towards the viewer in a picture. If the view is along z, y is up, as in a heat map; otherwise z
/// is up.
fn view_from(towards_eye: DVec3) -> DMat3 {
    let is_above = towards_eye.z.abs() > 0.7;
    upright(towards_eye, if is_above { DVec3::Y } else { DVec3::Z })
}

/// Returns a matrix of the directions right, up and towards the viewer; `up` must not be parallel to the viewing direction.
fn upright(towards_eye: DVec3, up: DVec3) -> DMat3 {
    let right = up.cross(towards_eye).normalize();
    DMat3::from_cols(right, towards_eye.cross(right), towards_eye).transpose()
}

/// Projects the taxels of a skin onto a plane. For each centre (metres), `axes` contains a unit vector.
pub(super) fn unroll(centers: &[DVec3], axes: &[DVec3]) -> Unrolled {
    let middle = mean(axes).normalize_or_zero();
    let round = match axes.iter().all(|axis| axis.dot(middle) > FLAT) {
        true => None,
        false => cylinder(centers, axes).or_else(|| cap(centers, axes)),
    };
    round.unwrap_or_else(|| sides(centers, axes))
}

fn mean(vectors: &[DVec3]) -> DVec3 {
    vectors.iter().sum::<DVec3>() / vectors.len() as f64
}

/// Returns the radius of the sphere (or circle) to which all axes are perpendicular; `None` if there is none. All places p and axes n then satisfy p = c + R n
/// with a centre c and the radius R. A negative R means a concave surface.
fn radius_of(places: &[DVec3], axes: &[DVec3]) -> Option<f64> {
    let (mean_place, mean_axis) = (mean(places), mean(axes));
    let pairs = || places.iter().zip(axes);
    let spread: f64 = axes.iter().map(|n| (n - mean_axis).length_squared()).sum();
    let along: f64 = pairs()
        .map(|(p, n)| (p - mean_place).dot(n - mean_axis))
        .sum();
    let radius = along / spread;
    let center = mean_place - radius * mean_axis;
    let fits = |(p, n): (&DVec3, &DVec3)| (p - center - radius * n).length() < FIT * radius.abs();
    (spread > 0.0 && pairs().all(fits)).then_some(radius)
}

fn cylinder(centers: &[DVec3], axes: &[DVec3]) -> Option<Unrolled> {
    let crosses = axes.iter().map(|axis| axes[0].cross(*axis));
    let widest = crosses.max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))?;
    let along = widest.try_normalize()?;
    // The end of the cylinder that points along a patch axis is up.
    let sign = along.to_array().into_iter().fold(0.0, larger).signum();
    let along = sign * along;
    if axes.iter().any(|axis| axis.dot(along).abs() > 0.1) {
        return None;
    }
    let flat = |v: &DVec3| v.reject_from_normalized(along);
    let rings: Vec<DVec3> = centers.iter().map(flat).collect();
    let spokes: Vec<DVec3> = axes.iter().map(|n| flat(n).normalize()).collect();
    let radius = radius_of(&rings, &spokes)?;
    let front = mean(&spokes);
    let front = if front.length() > 0.1 {
        flat(&front).normalize()
    } else {
        // The mean axis of a full cylinder is zero; the front is then a fixed direction, and the cut is at the back.
        flat(&view_from(along).row(0)).normalize()
    };
    let right = upright(front, along).row(0);
    let places = centers.iter().zip(&spokes).map(|(center, spoke)| {
        let angle = spoke.dot(right).atan2(spoke.dot(front));
        // Rounding must not decide on which side of the cut a taxel is drawn.
        let angle = if angle > std::f64::consts::PI - 1e-9 {
            -std::f64::consts::PI
        } else {
            angle
        };
        DVec2::new(radius * angle, center.dot(along))
    });
    let shape = round("cylinder", radius);
    let (up, middle) = (direction(along), direction(front));
    Some(Unrolled {
        places: places.collect(),
        sentence: format!("unrolled from {shape}; up: {up}, middle: {middle}"),
    })
}

fn cap(centers: &[DVec3], axes: &[DVec3]) -> Option<Unrolled> {
    let radius = radius_of(centers, axes)?;
    let middle = mean(axes).try_normalize()?;
    let view = view_from(middle);
    let polar = |axis: &DVec3| axis.dot(middle).clamp(-1.0, 1.0).acos();
    if axes.iter().any(|axis| polar(axis) > WIDEST_CAP) {
        return None;
    }
    let places = axes.iter().map(|axis| {
        let heading = (view * axis).truncate().normalize_or_zero();
        radius * polar(axis) * heading
    });
    let (shape, middle) = (round("sphere", radius), direction(middle));
    Some(Unrolled {
        places: places.collect(),
        sentence: format!("flattened from {shape}; middle: {middle}"),
    })
}

/// Projects the taxels of a skin along the mean direction of their axes. If there is no mean direction, they are projected from the broad side along +x, +y or
/// +z.
fn sides(centers: &[DVec3], axes: &[DVec3]) -> Unrolled {
    let mean = mean(axes);
    let towards_eye = if mean.length() > 0.1 {
        mean.normalize()
    } else {
        let low = centers.iter().fold(DVec3::INFINITY, |a, &b| a.min(b));
        let high = centers.iter().fold(DVec3::NEG_INFINITY, |a, &b| a.max(b));
        let thinnest = (high - low).min_position();
        DVec3::AXES[thinnest]
    };
    let view = view_from(towards_eye);
    let faces_away = |axis: &DVec3| axis.dot(towards_eye) < 0.0;
    let mut places: Vec<DVec2> = centers
        .iter()
        .map(|center| (view * center).truncate())
        .collect();
    let sentence = format!("seen from {}", direction(towards_eye));
    if !axes.iter().any(faces_away) {
        return Unrolled { places, sentence };
    }
    // In the view from behind, right is left. The two views are separated by a tenth of the width plus 2 mm.
    let low = places.iter().fold(DVec2::INFINITY, |a, &b| a.min(b)).x;
    let high = places.iter().fold(DVec2::NEG_INFINITY, |a, &b| a.max(b)).x;
    let mirror = high + 0.05 * (high - low) + 1e-3;
    for (place, axis) in places.iter_mut().zip(axes) {
        if faces_away(axis) {
            place.x = 2.0 * mirror - place.x;
        }
    }
    Unrolled {
        places,
        sentence: format!("left {sentence}, right the taxels that face away, from behind"),
    }
}

fn larger(a: f64, b: f64) -> f64 {
    if b.abs() > a.abs() { b } else { a }
}

/// Returns a shape and its radius as text, such as `a sphere of radius 20 mm`. A negative radius means the inside of the shape.
fn round(shape: &str, radius: f64) -> String {
    let side = if radius < 0.0 { "the inside of " } else { "" };
    let radius_mm = short_number(radius.abs() * 1e3);
    format!("{side}a {shape} of radius {radius_mm} mm")
}

/// Returns a direction as text: `+z` if it is within half a degree of an axis, otherwise three components.
fn direction(vector: DVec3) -> String {
    for (axis, name) in DVec3::AXES.into_iter().zip(["x", "y", "z"]) {
        let along = vector.dot(axis);
        if along.abs() > 1.0 - 4e-5 {
            return format!("{}{name}", if along > 0.0 { '+' } else { '−' });
        }
    }
    // Adding zero turns −0 into 0.
    let parts = vector.to_array().map(|c| (100.0 * c).round() / 100.0 + 0.0);
    let parts = parts.map(|c| format!("{c:.2}").replace('-', "−"));
    format!("({})", parts.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn around(radius: f64, angles: impl Iterator<Item = f64> + Clone) -> (Vec<DVec3>, Vec<DVec3>) {
        let heights = [-0.02, 0.0, 0.02];
        let pairs = heights.into_iter().flat_map(|y| {
            angles.clone().map(move |angle| {
                let axis = DVec3::new(angle.sin(), 0.0, angle.cos());
                (DVec3::new(0.01, y, 0.5) + radius * axis, axis)
            })
        });
        pairs.unzip()
    }

    fn distances_are_kept(unrolled: &Unrolled, expected: &[DVec2]) {
        let places = &unrolled.places;
        assert_eq!(places.len(), expected.len());
        for pair in places.windows(2).zip(expected.windows(2)) {
            let (a, b) = (pair.0[1] - pair.0[0], pair.1[1] - pair.1[0]);
            assert!((a - b).length() < 1e-9, "{a}, {b}");
        }
    }

    #[test]
    fn a_grid_is_seen_as_a_heat_map_shows_it() {
        let centers = [DVec3::ZERO, DVec3::new(0.1, 0.02, 0.0)];
        let unrolled = unroll(&centers, &[DVec3::Z; 2]);
        assert_eq!(unrolled.sentence, "seen from +z");
        assert_eq!(unrolled.places[1], DVec2::new(0.1, 0.02));
    }

    #[test]
    fn a_cylinder_is_unrolled_with_the_distances_on_it() {
        let angles = (-10..=10).map(|i| 0.25 * f64::from(i));
        let (centers, axes) = around(0.04, angles.clone());
        let unrolled = unroll(&centers, &axes);
        let said = "unrolled from a cylinder of radius 40 mm; up: +y, middle: +z";
        assert_eq!(unrolled.sentence, said);
        let expected: Vec<DVec2> = [-0.02, 0.0, 0.02]
            .into_iter()
            .flat_map(|y| angles.clone().map(move |a| DVec2::new(0.04 * a, y)))
            .collect();
        distances_are_kept(&unrolled, &expected);
    }

    #[test]
    fn a_pipe_is_seen_from_inside() {
        let angles = (-5..=5).map(|i| 0.25 * f64::from(i));
        let (centers, axes) = around(0.04, angles.clone());
        let inwards: Vec<DVec3> = axes.iter().map(|&axis| -axis).collect();
        let unrolled = unroll(&centers, &inwards);
        assert!(unrolled.sentence.contains("the inside of a cylinder"));
        // The viewer is in the middle and faces +z with y up: +x, where the angles increase, is on the left.
        let expected: Vec<DVec2> = [-0.02, 0.0, 0.02]
            .into_iter()
            .flat_map(|y| angles.clone().map(move |a| DVec2::new(-0.04 * a, y)))
            .collect();
        distances_are_kept(&unrolled, &expected);
    }

    #[test]
    fn a_cap_keeps_distances_from_its_middle() {
        let axes: Vec<DVec3> = (0..40)
            .map(|i| {
                let (polar, azimuth) = (0.03 * f64::from(i), 2.4 * f64::from(i));
                DVec3::new(
                    polar.sin() * azimuth.cos(),
                    polar.sin() * azimuth.sin(),
                    polar.cos(),
                )
            })
            .collect();
        let centers: Vec<DVec3> = axes.iter().map(|&axis| 0.05 * axis).collect();
        let unrolled = unroll(&centers, &axes);
        assert!(
            unrolled
                .sentence
                .starts_with("flattened from a sphere of radius 50 mm")
        );
        let middle = mean(&axes).normalize();
        for (taxel, place) in unrolled.places.iter().enumerate() {
            let expected = 0.05 * axes[taxel].dot(middle).acos();
            assert!((place.length() - expected).abs() < 1e-9);
        }
    }

    #[test]
    fn a_closed_skin_is_seen_from_both_sides_and_each_taxel_once() {
        let axes: Vec<DVec3> = (0..200)
            .map(|i| {
                let z = -1.0 + (f64::from(i) + 0.5) / 100.0;
                let azimuth = 2.4 * f64::from(i);
                let ring = (1.0 - z * z).sqrt();
                DVec3::new(ring * azimuth.cos(), ring * azimuth.sin(), z)
            })
            .collect();
        let scale = DVec3::new(0.08, 0.05, 0.02);
        let centers: Vec<DVec3> = axes.iter().map(|&axis| axis * scale).collect();
        let unrolled = unroll(&centers, &axes);
        assert!(
            unrolled
                .sentence
                .starts_with("left seen from +z, right the")
        );
        // In the view from behind, right is left. The two views do not overlap.
        let shift = |taxel: usize| unrolled.places[taxel].x + centers[taxel].x;
        let away = (0..200).find(|&taxel| axes[taxel].z < 0.0).unwrap();
        for (taxel, place) in unrolled.places.iter().enumerate() {
            let is_away = axes[taxel].z < 0.0;
            assert_eq!(is_away, place.x > 0.08);
            match is_away {
                true => assert!((shift(taxel) - shift(away)).abs() < 1e-12),
                false => assert_eq!(place.x, centers[taxel].x),
            }
        }
    }
}
