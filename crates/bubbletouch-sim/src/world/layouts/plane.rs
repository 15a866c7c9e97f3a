//! Layouts on a plane: positions for images of curved layouts, distances of neighbours, and layouts that are grids.

use crate::world::{Grid, Layout};
use glam::{DQuat, DVec2, DVec3};

/// Largest deviation of a taxel from its place in a grid, in pitches, at which a layout counts as a grid. With a larger value, positions that differ on purpose
/// are ignored; with a smaller value, rounded positions of a grid form no grid.
const GRID_TOLERANCE: f64 = 1e-3;
/// Maximum number of taxels whose nearest neighbours are searched, because the search compares all pairs.
const MAX_SEARCHED: usize = 2000;
/// Length of the mean axis below which the axes point in all directions and define no direction of view.
const MIN_MEAN_AXIS: f64 = 0.1;

impl Layout {
    /// Returns the positions of the taxels on a plane, metres. The plane is perpendicular to the mean axis, and the position of the taxel with the most
    /// similar axis is the origin. A taxel whose axis is inclined by the angle θ is moved
    /// along the direction of the inclination by the factor θ / sin θ. Distances from the middle along a sphere and around a cylinder are therefore preserved.
    pub fn on_plane(&self) -> Vec<DVec2> {
        let (centers, axes) = (self.centers(), self.axes());
        let mean = axes.iter().sum::<DVec3>() / axes.len() as f64;
        let view = match mean.length() < MIN_MEAN_AXIS {
            true => DVec3::Z,
            false => mean.normalize(),
        };
        // The x and y axes of the layout, rotated as little as possible; seen from below, y points down.
        let (rotation, up) = match view.z < 0.0 {
            true => (DQuat::from_rotation_arc(DVec3::NEG_Z, view), DVec3::NEG_Y),
            false => (DQuat::from_rotation_arc(DVec3::Z, view), DVec3::Y),
        };
        let (x, y) = (rotation * DVec3::X, rotation * up);
        let plane = |vector: DVec3| DVec2::new(vector.dot(x), vector.dot(y));
        let most = axes.iter().enumerate();
        let middle = most.max_by(|a, b| a.1.dot(view).total_cmp(&b.1.dot(view)));
        let middle = middle.map_or(DVec3::ZERO, |(taxel, _)| centers[taxel]);
        let taxels = centers.iter().zip(axes);
        let place = |(center, axis): (&DVec3, &DVec3)| {
            let place = plane(*center - middle);
            let inclined = plane(*axis);
            let sine = inclined.length();
            // Axes in files are rounded; a small angle does not move a taxel.
            if sine < 1e-3 {
                return place;
            }
            let (direction, angle) = (inclined / sine, sine.atan2(axis.dot(view)));
            let along = place.dot(direction);
            place + along * (angle / sine - 1.0) * direction
        };
        taxels.map(place).collect()
    }

    /// Returns the grid that the taxels form row by row, in any position and orientation; `None` if they form no grid.
    pub fn to_grid(&self) -> Option<Grid> {
        if let Some(grid) = self.as_grid() {
            return Some(*grid);
        }
        let (centers, axis) = (self.centers(), self.axes()[0]);
        let n = centers.len();
        let away = |taxel: usize| centers[taxel] - centers[0];
        let pitch = away(1.min(n - 1)).length();
        let is_along = |other: &DVec3| other.distance(axis) <= GRID_TOLERANCE;
        let is_flat = self.axes().iter().all(is_along);
        if pitch == 0.0 || !is_flat {
            return None;
        }
        let first = away(1) / pitch;
        let is_at =
            |taxel: usize, place: DVec3| away(taxel).distance(place) <= GRID_TOLERANCE * pitch;
        let columns = match self.sides() {
            Some([_, columns]) => columns,
            None => {
                let in_line = |taxel: &usize| is_at(*taxel, *taxel as f64 * pitch * first);
                (0..n).take_while(in_line).count()
            }
        };
        // If there is a single column, the first two taxels lie along it.
        let (x, y) = match (columns, n / columns) {
            (1, _) => (DVec3::ZERO, first),
            (_, 1) => (first, DVec3::ZERO),
            _ => (first, away(columns) / pitch),
        };
        let is_long =
            |side: DVec3| side == DVec3::ZERO || (side.length() - 1.0).abs() <= GRID_TOLERANCE;
        let cosines = [x.dot(y), x.dot(axis), y.dot(axis)];
        let is_square = cosines.iter().all(|it| it.abs() <= GRID_TOLERANCE);
        let place = |taxel: usize| {
            let (row, column) = (taxel / columns, taxel % columns);
            pitch * (column as f64 * x + row as f64 * y)
        };
        let is_grid = n.is_multiple_of(columns)
            && is_square
            && is_long(y)
            && (0..n).all(|k| is_at(k, place(k)));
        is_grid.then_some(Grid {
            nx: columns,
            ny: n / columns,
            pitch,
        })
    }
}

/// Returns the distances of positions from their nearest neighbours, in ascending order. If there are more than
/// `MAX_SEARCHED` positions, only every second, third, … position is searched.
pub fn nearest_distances(places: &[DVec2]) -> Vec<f64> {
    let step = places.len().div_ceil(MAX_SEARCHED).max(1);
    let nearest = |taxel: usize| {
        let squares = places.iter().map(|it| it.distance_squared(places[taxel]));
        // Taxels at one position have no distance.
        let squares = squares.filter(|square| *square > 0.0);
        squares.min_by(f64::total_cmp).map(f64::sqrt)
    };
    let taxels = (0..places.len()).step_by(step);
    let mut distances: Vec<f64> = taxels.filter_map(nearest).collect();
    distances.sort_by(f64::total_cmp);
    distances
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::world::fixtures::grid;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn listed(taxels: impl IntoIterator<Item = (DVec3, DVec3)>) -> Layout {
        let (centers, axes) = taxels.into_iter().unzip();
        Layout::new(centers, axes).unwrap()
    }

    #[test]
    fn a_grid_in_any_position_and_numbered_row_by_row_is_the_grid() {
        let flat = Layout::grid(&grid(5, 3, 2e-3)).unwrap();
        let pose = Pose {
            rotation: DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 2.0, -1.0),
            translation: DVec3::new(0.1, -0.2, 0.3),
        };
        for (nx, ny) in [(5, 3), (1, 7), (6, 1), (1, 1)] {
            let flat = Layout::grid(&grid(nx, ny, 2e-3)).unwrap();
            let moved = flat.moved(&pose);
            let Some(found) = moved.to_grid() else {
                assert_eq!(nx * ny, 1, "a single taxel has no pitch");
                continue;
            };
            assert_eq!((found.nx, found.ny), (nx, ny));
            assert!((found.pitch - 2e-3).abs() < 1e-15);
        }
        // Another order or a moved taxel is no grid.
        let taxel = |k: usize| (flat.centers()[k], flat.axes()[k]);
        let by_columns = (0..15).map(|k| taxel(k / 3 + 5 * (k % 3)));
        let found = listed(by_columns).to_grid().expect("another grid");
        assert_eq!((found.nx, found.ny), (3, 5));
        let serpentine = (0..15).map(|k| match (k / 5) % 2 {
            0 => taxel(k),
            _ => taxel(k / 5 * 5 + 4 - k % 5),
        });
        assert!(listed(serpentine).to_grid().is_none());
        let shift = |k| f64::from(k == 7) * 1e-4 * DVec3::X;
        let moved = (0..15).map(|k| (taxel(k).0 + shift(k), taxel(k).1));
        assert!(listed(moved).to_grid().is_none());
    }

    #[test]
    fn images_of_a_cylinder_and_a_cap_keep_distances_along_the_surface() {
        let radius = 0.02;
        let on_cylinder = |k: usize| {
            let angle = (k % 9) as f64 / 8.0 * PI - FRAC_PI_2;
            let y = 1e-3 * (k / 9) as f64;
            let axis = DVec3::new(angle.sin(), 0.0, angle.cos());
            (radius * axis + y * DVec3::Y, axis)
        };
        let places = listed((0..27).map(on_cylinder)).on_plane();
        for (k, place) in places.iter().enumerate() {
            let away = *place - places[0];
            let expected = DVec2::new((k % 9) as f64 * PI * radius / 8.0, 1e-3 * (k / 9) as f64);
            assert!((away - expected).length() < 1e-12, "{k}: {away}");
        }
        let cap = Layout::sphere_cap(radius, 1.2, 2e-3).unwrap();
        for (axis, place) in cap.axes().iter().zip(cap.on_plane()) {
            let arc = radius * axis.z.acos();
            assert!((place.length() - arc).abs() < 1e-9, "{place} {arc}");
        }
    }
}
