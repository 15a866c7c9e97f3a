//! Projection of a skin to a plane, which gives the position of each taxel in the picture.
//!
//! A skin is seen along the mean of its axes or, if there is none, on its broad side. If some taxels face away, the picture also shows the view from behind.

use glam::{DMat3, DVec2, DVec3};

/// Positions of the taxels of a skin after projection onto a plane.
pub(super) struct Projected {
    /// Position of each taxel in the plane, to the right and up, metres.
    pub places: Vec<DVec2>,
    /// Sentence below the picture that describes the projection.
    pub sentence: String,
}

/// Returns a matrix whose rows are the directions right, up and towards the viewer in a picture. If the view is along z, y is up, as in a heat map; otherwise z
/// is up.
pub(crate) fn view_from(towards_eye: DVec3) -> DMat3 {
    let is_above = towards_eye.z.abs() > 0.7;
    let up = if is_above { DVec3::Y } else { DVec3::Z };
    let right = up.cross(towards_eye).normalize();
    DMat3::from_cols(right, towards_eye.cross(right), towards_eye).transpose()
}

/// Projects the taxels of a skin along the mean direction of their axes. If there is no mean direction, they are projected from the broad side along +x, +y or
/// +z. For each centre (metres), `axes` contains a unit vector.
pub(super) fn project(centers: &[DVec3], axes: &[DVec3]) -> Projected {
    let mean = axes.iter().sum::<DVec3>() / axes.len() as f64;
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
        return Projected { places, sentence };
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
    Projected {
        places,
        sentence: format!("left {sentence}, right the taxels that face away, from behind"),
    }
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

    #[test]
    fn a_grid_is_seen_as_a_heat_map_shows_it() {
        let centers = [DVec3::ZERO, DVec3::new(0.1, 0.02, 0.0)];
        let projected = project(&centers, &[DVec3::Z; 2]);
        assert_eq!(projected.sentence, "seen from +z");
        assert_eq!(projected.places[1], DVec2::new(0.1, 0.02));
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
        let projected = project(&centers, &axes);
        assert!(
            projected
                .sentence
                .starts_with("left seen from +z, right the")
        );
        // In the view from behind, right is left. The two views do not overlap.
        let shift = |taxel: usize| projected.places[taxel].x + centers[taxel].x;
        let away = (0..200).find(|&taxel| axes[taxel].z < 0.0).unwrap();
        for (taxel, place) in projected.places.iter().enumerate() {
            let is_away = axes[taxel].z < 0.0;
            assert_eq!(is_away, place.x > 0.08);
            match is_away {
                true => assert!((shift(taxel) - shift(away)).abs() < 1e-12),
                false => assert_eq!(place.x, centers[taxel].x),
            }
        }
    }
}
