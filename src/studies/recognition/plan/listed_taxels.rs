//! Taxels at listed positions: a layout that is read from a file, or several sensors that are read together.
//!
//! Sensors that are read together are separate skins. In the patch, they are so far apart that no taxel is a neighbour of a taxel of another sensor. In
//! pictures, they are side by side.

use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::inputs::content_hash::Hashed;
use crate::inputs::units::{MAX_SIDE, millimetres};
use crate::world::{Grid, Layout};
use bubbletouch_sim::features::Chart;
use glam::{DQuat, DVec2, DVec3};
use std::ops::Range;

/// Largest deviation of a taxel from its place in a grid, in pitches, at which a layout counts as a grid. With a larger value, positions that differ on purpose
/// are ignored; with a smaller value, rounded positions of a grid form no grid.
const GRID_TOLERANCE: f64 = 1e-3;
/// Largest factor between the pitch of a sensor and the median distance of its taxels from their nearest neighbours. With a larger value, files in a wrong
/// unit are accepted; with a smaller value, irregular layouts are refused.
const MAX_PITCH_FACTOR: f64 = 2.5;
/// Maximum number of taxels whose nearest neighbours are searched, because the search compares all pairs.
const MAX_SEARCHED: usize = 2000;
/// Distance between sensors in the patch, metres. With a smaller value, smoothing might reach the next sensor.
const APART: f64 = 10.0;
/// Distance between sensors in pictures, in pitches of the first sensor.
const PICTURE_GAP: f64 = 2.0;
/// Length of the mean axis below which the axes point in all directions and define no direction of view.
const MIN_MEAN_AXIS: f64 = 0.1;

/// Sensor whose taxels have known positions.
#[derive(Clone, Debug)]
pub struct PlacedSensor {
    /// Name of the sensor, as in the study.
    pub name: String,
    /// Rest centres and axes of the taxels. A layout that is a grid is stored as this grid.
    pub layout: Layout,
    /// Side of the square area per taxel, metres.
    pub pitch: f64,
}

impl PlacedSensor {
    /// Creates a sensor from a layout and its pitch, metres. The numbers of rows and columns are given if the frames have rows and columns. Text `place` names
    /// the layout file in errors.
    ///
    /// # Errors
    /// If the distances between taxels contradict the pitch, or the layout has other numbers of rows and columns.
    pub fn new(
        name: &str,
        (place, layout): (&str, Layout),
        pitch: f64,
        sides: Option<[usize; 2]>,
    ) -> Result<Self> {
        let layout = match (sides, layout.sides()) {
            (Some([rows, columns]), Some(own)) if own != [rows, columns] => {
                let given = format!("{} × {} taxels", own[0], own[1]);
                let allowed = format!("{rows} × {columns}, as the recorded frames have");
                return Err(Error::input(place, given, allowed));
            }
            (Some(sides), None) => layout.with_sides(sides)?,
            _ => layout,
        };
        let grid = as_grid(&layout);
        let distance = match &grid {
            Some(grid) => grid.pitch,
            None => median_distance(&on_plane(&layout)).unwrap_or(pitch),
        };
        let is_near = match grid {
            Some(_) => (pitch / distance - 1.0).abs() <= GRID_TOLERANCE,
            None => (1.0 / MAX_PITCH_FACTOR..=MAX_PITCH_FACTOR).contains(&(distance / pitch)),
        };
        if !is_near {
            let given = format!("taxels {} mm apart", rounded(millimetres(distance)));
            let allowed = match grid {
                Some(_) => format!("the pitch of the skin, {} mm", millimetres(pitch)),
                None => format!(
                    "{} to {} mm at a pitch of {} mm",
                    rounded(millimetres(pitch / MAX_PITCH_FACTOR)),
                    rounded(millimetres(pitch * MAX_PITCH_FACTOR)),
                    millimetres(pitch)
                ),
            };
            return Err(Error::input(place, given, allowed));
        }
        Ok(Self {
            name: name.to_owned(),
            layout: match grid {
                Some(grid) => Layout::grid(&Grid { pitch, ..grid })?,
                None => layout,
            },
            pitch,
        })
    }
}

/// Image of one sensor of an array.
#[derive(Clone, Debug)]
pub struct SensorImage {
    /// Taxels of the sensor, numbered in the array.
    pub taxels: Range<usize>,
    /// Numbers of rows and columns of the image.
    pub shape: (usize, usize),
    /// Mapping from the taxels of the sensor to pixels; `None` if each taxel is a pixel.
    pub chart: Option<Chart>,
}

/// Sensor within an array of listed taxels.
#[derive(Clone, Debug)]
struct ListedSensor {
    name: String,
    taxels: Range<usize>,
    /// Positions of the taxels on the plane of the sensor's image, metres, relative to the middle of the image.
    places: Vec<DVec2>,
    shape: (usize, usize),
    pitch: f64,
    is_grid: bool,
}

/// Taxels at listed positions, with the positions that pictures and images use.
#[derive(Clone, Debug)]
pub struct ListedTaxels {
    sensors: Vec<ListedSensor>,
    /// Positions of all taxels in pictures, metres; sensors are side by side.
    places: Vec<DVec2>,
    /// Numbers of rows and columns of a single sensor whose taxels are numbered row by row.
    sides: Option<(usize, usize)>,
    /// Rest centres and axes of all taxels in the patch, hashed for cache keys.
    content: Hashed<Vec<[f64; 6]>>,
}

impl ListedTaxels {
    /// Places sensors in one patch, and returns the layout of the patch.
    ///
    /// # Errors
    /// If the image of a sensor has too many pixels, or there are too many taxels.
    pub fn new(sensors: &[PlacedSensor]) -> Result<(Self, Layout)> {
        let (mut listed, mut places) = (Vec::new(), Vec::new());
        let (mut centers, mut axes) = (Vec::new(), Vec::new());
        let mut right = 0.0;
        for (number, sensor) in sensors.iter().enumerate() {
            let own = on_plane(&sensor.layout);
            let (own, extent) = centred(own);
            let side = |length: f64| (length / sensor.pitch).round() as usize + 1;
            let shape = (side(extent.y), side(extent.x));
            if shape.0.max(shape.1) > MAX_SIDE {
                let given = format!("an image of {} × {} pixels", shape.0, shape.1);
                let allowed = format!("at most {MAX_SIDE} rows and columns of the pitch");
                return Err(Error::input(
                    format!("sensor {}", sensor.name),
                    given,
                    allowed,
                ));
            }
            if number > 0 {
                right += PICTURE_GAP * sensors[0].pitch;
            }
            let width = shape.1 as f64 * sensor.pitch;
            let middle = DVec2::new(right + 0.5 * width, 0.0);
            right += width;
            let first = places.len();
            places.extend(own.iter().map(|place| *place + middle));
            listed.push(ListedSensor {
                name: sensor.name.clone(),
                taxels: first..places.len(),
                places: own,
                shape,
                pitch: sensor.pitch,
                is_grid: sensor.layout.as_grid().is_some(),
            });
            let away = Pose::from_translation(APART * number as f64 * DVec3::X);
            let moved = match number {
                0 => sensor.layout.clone(),
                _ => sensor.layout.moved(&away),
            };
            centers.extend_from_slice(moved.centers());
            axes.extend_from_slice(moved.axes());
        }
        let (places, _) = centred(places);
        let sides = match sensors {
            [one] => one.layout.sides().map(|[rows, columns]| (rows, columns)),
            _ => None,
        };
        let numbers = centers.iter().zip(&axes);
        let numbers = numbers.map(|(c, a): (&DVec3, &DVec3)| [c.x, c.y, c.z, a.x, a.y, a.z]);
        let content = Hashed::new(numbers.collect(), |numbers: &Vec<[f64; 6]>| {
            let numbers = numbers.iter().flatten();
            numbers.flat_map(|number| number.to_le_bytes()).collect()
        });
        let layout = Layout::new(centers, axes)?;
        let listed = Self {
            sensors: listed,
            places,
            sides,
            content,
        };
        Ok((listed, layout))
    }

    /// Returns the numbers of rows and columns of taxels; `None` for several sensors, or if the taxels are not numbered row by row.
    pub fn sides(&self) -> Option<(usize, usize)> {
        self.sides
    }

    /// Returns the positions of the taxels in pictures, metres.
    pub fn places(&self) -> &[DVec2] {
        &self.places
    }

    /// Returns the pitch of the sensor with this taxel, metres.
    pub fn pitch_at(&self, taxel: usize) -> f64 {
        let own = self.sensors.iter().find(|s| s.taxels.contains(&taxel));
        own.map_or(f64::NAN, |sensor| sensor.pitch)
    }

    /// Returns the smallest pitch of the sensors, metres.
    pub fn finest_pitch(&self) -> f64 {
        let pitches = self.sensors.iter().map(|sensor| sensor.pitch);
        pitches.fold(f64::INFINITY, f64::min)
    }

    /// Returns the numbers of rows and columns of the images of the sensors.
    pub fn image_shapes(&self) -> Vec<(usize, usize)> {
        self.sensors.iter().map(|sensor| sensor.shape).collect()
    }

    /// Returns the image of each sensor.
    pub fn images(&self) -> Vec<SensorImage> {
        let image = |sensor: &ListedSensor| {
            let ListedSensor {
                places,
                shape,
                pitch,
                ..
            } = sensor;
            let widest = widest_distance(places).map_or(1.0, |d| (d / pitch).max(1.0));
            let chart = || Chart::with_gaps(places, (*pitch, widest), (*shape, *pitch));
            SensorImage {
                taxels: sensor.taxels.clone(),
                shape: *shape,
                chart: (!sensor.is_grid).then(chart),
            }
        };
        self.sensors.iter().map(image).collect()
    }

    /// Returns a description of the layout, such as `layout of a file` or `3 sensors (thumb 24, index 24, palm 60)`.
    pub fn words(&self) -> String {
        match &self.sensors[..] {
            [_] => "layout of a file".to_owned(),
            sensors => {
                let each = sensors.iter();
                let each = each.map(|s| format!("{} {}", s.name, s.taxels.len()));
                let each: Vec<String> = each.collect();
                format!("{} sensors ({})", sensors.len(), each.join(", "))
            }
        }
    }

    /// Returns a text that identifies the positions and axes of the taxels.
    pub fn identity(&self) -> String {
        let pitches = self.sensors.iter().map(|s| (s.taxels.len(), s.pitch));
        format!("{:?} {:?}", pitches.collect::<Vec<_>>(), self.content)
    }
}

/// Returns the positions relative to the middle of their bounding box, and the width and height of the box.
fn centred(places: Vec<DVec2>) -> (Vec<DVec2>, DVec2) {
    let low = places.iter().copied().fold(DVec2::INFINITY, DVec2::min);
    let high = places.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
    let middle = 0.5 * (low + high);
    let places = places.into_iter().map(|place| place - middle).collect();
    (places, high - low)
}

/// Returns the positions of the taxels on a plane, metres. The plane is perpendicular to the mean axis. A taxel whose axis is inclined by the angle θ is moved
/// along the direction of the inclination by the factor θ / sin θ. Distances from the middle along a sphere and around a cylinder are therefore preserved.
fn on_plane(layout: &Layout) -> Vec<DVec2> {
    let (centers, axes) = (layout.centers(), layout.axes());
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

/// Returns the distances of taxels from their nearest neighbours, metres, in ascending order.
fn nearest_distances(places: &[DVec2]) -> Vec<f64> {
    let step = places.len().div_ceil(MAX_SEARCHED).max(1);
    let nearest = |taxel: usize| {
        let others = places
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != taxel);
        let squares = others.map(|(_, place)| place.distance_squared(places[taxel]));
        squares.min_by(f64::total_cmp).map(f64::sqrt)
    };
    let taxels = (0..places.len()).step_by(step);
    let mut distances: Vec<f64> = taxels.filter_map(nearest).collect();
    distances.sort_by(f64::total_cmp);
    distances
}

fn median_distance(places: &[DVec2]) -> Option<f64> {
    let distances = nearest_distances(places);
    distances.get(distances.len() / 2).copied()
}

fn widest_distance(places: &[DVec2]) -> Option<f64> {
    nearest_distances(places).last().copied()
}

/// Returns the grid that the taxels form row by row, in any position and orientation; `None` if they form no grid.
fn as_grid(layout: &Layout) -> Option<Grid> {
    if let Some(grid) = layout.as_grid() {
        return Some(*grid);
    }
    let (centers, axis) = (layout.centers(), layout.axes()[0]);
    let n = centers.len();
    let away = |taxel: usize| centers[taxel] - centers[0];
    let pitch = away(1.min(n - 1)).length();
    let is_flat = layout
        .axes()
        .iter()
        .all(|a| a.distance(axis) <= GRID_TOLERANCE);
    if pitch == 0.0 || !is_flat {
        return None;
    }
    let first = away(1) / pitch;
    let is_at = |taxel: usize, place: DVec3| away(taxel).distance(place) <= GRID_TOLERANCE * pitch;
    let columns = match layout.sides() {
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
    let is_square = [x.dot(y), x.dot(axis), y.dot(axis)];
    let is_square = is_square
        .iter()
        .all(|cosine| cosine.abs() <= GRID_TOLERANCE);
    let place = |taxel: usize| {
        let (row, column) = (taxel / columns, taxel % columns);
        pitch * (column as f64 * x + row as f64 * y)
    };
    let is_grid =
        n.is_multiple_of(columns) && is_square && is_long(y) && (0..n).all(|k| is_at(k, place(k)));
    is_grid.then_some(Grid {
        nx: columns,
        ny: n / columns,
        pitch,
    })
}

/// Rounds a number for an error message.
fn rounded(number: f64) -> f64 {
    (number * 1e3).round() / 1e3
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn sensor(layout: Layout, pitch: f64) -> Result<PlacedSensor> {
        PlacedSensor::new("s", ("layout.csv", layout), pitch, None)
    }

    fn listed(taxels: impl IntoIterator<Item = (DVec3, DVec3)>) -> Layout {
        let (centers, axes) = taxels.into_iter().unzip();
        Layout::new(centers, axes).unwrap()
    }

    #[test]
    fn a_grid_in_any_position_and_numbered_row_by_row_is_the_grid() {
        let grid = Grid {
            nx: 5,
            ny: 3,
            pitch: 2e-3,
        };
        let flat = Layout::grid(&grid).unwrap();
        let pose = Pose {
            rotation: DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 2.0, -1.0),
            translation: DVec3::new(0.1, -0.2, 0.3),
        };
        for (nx, ny) in [(5, 3), (1, 7), (6, 1), (1, 1)] {
            let flat = Layout::grid(&Grid { nx, ny, ..grid }).unwrap();
            let moved = sensor(flat.moved(&pose), 2e-3).unwrap().layout;
            if nx * ny > 1 {
                let found = moved.as_grid().expect("a grid");
                // A single line has one row or one column.
                assert_eq!((found.nx * found.ny, found.pitch), (nx * ny, 2e-3));
            }
            if nx > 1 && ny > 1 {
                assert_eq!(moved.sides(), Some([ny, nx]));
            }
        }
        // Another order or a moved taxel is no grid.
        let taxels = || {
            flat.centers()
                .iter()
                .copied()
                .zip(flat.axes().iter().copied())
        };
        let by_columns = |k: usize| taxels().nth(k / 3 + 5 * (k % 3)).unwrap();
        assert!(as_grid(&listed((0..15).map(by_columns))).is_some_and(|g| (g.nx, g.ny) == (3, 5)));
        let serpentine = |k: usize| match (k / 5) % 2 {
            0 => taxels().nth(k).unwrap(),
            _ => taxels().nth(k / 5 * 5 + 4 - k % 5).unwrap(),
        };
        assert!(as_grid(&listed((0..15).map(serpentine))).is_none());
        let moved = taxels().enumerate();
        let moved = moved.map(|(k, (c, a))| (c + f64::from(k == 7) * 1e-4 * DVec3::X, a));
        assert!(as_grid(&listed(moved)).is_none());
        assert!(sensor(flat.moved(&pose), 3e-3).is_err());
    }

    #[test]
    fn images_of_a_cylinder_and_a_cap_keep_distances_along_the_surface() {
        let radius = 0.02;
        let on_cylinder = |k: usize| {
            let (angle, y) = (
                f64::from(k as u32 % 9) / 8.0 * PI - FRAC_PI_2,
                1e-3 * (k / 9) as f64,
            );
            let axis = DVec3::new(angle.sin(), 0.0, angle.cos());
            (radius * axis + y * DVec3::Y, axis)
        };
        let places = on_plane(&listed((0..27).map(on_cylinder)));
        for (k, place) in places.iter().enumerate() {
            let away = *place - places[0];
            let expected = DVec2::new((k % 9) as f64 * PI * radius / 8.0, 1e-3 * (k / 9) as f64);
            assert!((away - expected).length() < 1e-12, "{k}: {away}");
        }
        let cap = Layout::sphere_cap(radius, 1.2, 2e-3).unwrap();
        for (axis, place) in cap.axes().iter().zip(on_plane(&cap)) {
            let arc = radius * axis.z.acos();
            assert!((place.length() - arc).abs() < 1e-9, "{place} {arc}");
        }
    }

    #[test]
    fn positions_in_a_wrong_unit_contradict_the_pitch() {
        let taxels = [(0.0, 0.0), (3.0, 0.5), (0.2, 2.5), (3.4, 3.1)];
        let layout =
            |unit: f64| listed(taxels.map(|(x, y)| (unit * DVec3::new(x, y, 0.0), DVec3::Z)));
        assert!(sensor(layout(1e-3), 2.5e-3).is_ok());
        let said = sensor(layout(1.0), 2.5e-3).unwrap_err().to_string();
        assert!(
            said.starts_with("layout.csv: taxels ") && said.contains("at a pitch of 2.5 mm"),
            "{said}"
        );
    }
}
