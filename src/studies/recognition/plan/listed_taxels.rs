//! Taxels at listed positions: a layout that is read from a file, or several sensors that are read together.
//!
//! Sensors that are read together are separate skins. In the patch, they are so far apart that no taxel is a neighbour of a taxel of another sensor. In
//! pictures, they are side by side.

use crate::inputs::content_hash::Hashed;
use crate::inputs::units::MAX_SIDE;
use crate::studies::prelude::*;
use crate::world::{Grid, Layout, Neighbours, Patch, nearest_distances};
use bubbletouch_sim::features::Chart;
use glam::{DVec2, DVec3};
use serde::Serializer;
use std::ops::Range;

/// Largest relative difference between the pitch of a sensor and the distance of taxels in a grid. With a larger value, the results of the grid would differ
/// from those of its layout file; with a smaller value, rounded positions are refused.
const PITCH_TOLERANCE: f64 = 1e-3;
/// Largest factor between the pitch of a sensor and the median distance of its taxels from their nearest neighbours. With a larger value, files in a wrong
/// unit are accepted; with a smaller value, irregular layouts are refused.
const MAX_PITCH_FACTOR: f64 = 2.5;
/// Distance between sensors in the patch, metres. With a smaller value, smoothing might reach the next sensor.
const APART: f64 = 10.0;
/// Distance between sensors in pictures, in pitches of the first sensor.
const PICTURE_GAP: f64 = 2.0;
/// Sensor whose taxels have known positions.
#[derive(Clone, Debug)]
pub struct PlacedSensor {
    /// Name of the sensor, as in the study.
    pub name: String,
    /// Rest centres and axes of the taxels. A layout that is a grid is stored as this grid.
    pub layout: Layout,
    /// Side of the square area per taxel, metres.
    pub pitch: f64,
    /// Largest distance of a taxel from its nearest neighbour, metres.
    widest: f64,
}

impl PlacedSensor {
    /// Creates a sensor whose taxels form a grid.
    ///
    /// # Errors
    /// If the grid is invalid.
    pub fn grid(name: &str, grid: &Grid) -> Result<Self> {
        Ok(Self {
            name: name.to_owned(),
            layout: Layout::grid(grid)?,
            pitch: grid.pitch,
            widest: grid.pitch,
        })
    }

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
        let grid = layout.to_grid();
        let distances = match &grid {
            Some(grid) => vec![grid.pitch],
            None => nearest_distances(&layout.on_plane()),
        };
        // A single taxel has no neighbours.
        let middle = distances.get(distances.len() / 2);
        let distance = middle.copied().unwrap_or(pitch);
        let is_near = match grid {
            Some(_) => (pitch / distance - 1.0).abs() <= PITCH_TOLERANCE,
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
        match grid {
            Some(grid) => Self::grid(name, &Grid { pitch, ..grid }),
            None => Ok(Self {
                name: name.to_owned(),
                layout,
                pitch,
                widest: distances.last().copied().unwrap_or(pitch),
            }),
        }
    }
}

/// Image of one sensor of an array.
#[derive(Clone, Debug)]
pub struct SensorImage {
    /// Taxels of the sensor, numbered in the array.
    pub taxels: Range<usize>,
    /// Numbers of rows and columns of the image.
    pub shape: ImageShape,
    /// Mapping from the taxels of the sensor to pixels; `None` if each taxel is a pixel.
    pub chart: Option<Chart>,
}

/// Sensor within an array of listed taxels.
#[derive(Clone, Debug)]
struct ListedSensor {
    sensor: PlacedSensor,
    taxels: Range<usize>,
    /// Positions of the taxels on the plane of the sensor's image, metres, relative to the middle of the image.
    places: Vec<DVec2>,
    /// Numbers of rows and columns of the image.
    shape: ImageShape,
}

impl ListedSensor {
    /// Returns the numbers of rows and columns of taxels, if the taxels are numbered row by row.
    fn sides(&self) -> Option<ImageShape> {
        let sides = self.sensor.layout.sides();
        sides.map(|[ny, nx]| ImageShape { ny, nx })
    }
}

/// Taxels at listed positions, with the positions that pictures and images use.
#[derive(Clone, Debug)]
pub struct ListedTaxels {
    sensors: Vec<ListedSensor>,
    /// Positions of all taxels in pictures, metres; sensors are side by side.
    places: Vec<DVec2>,
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
            let own = sensor.layout.on_plane();
            let (own, extent) = centred(own);
            let side = |length: f64| (length / sensor.pitch).round() as usize + 1;
            let shape = ImageShape {
                ny: side(extent.y),
                nx: side(extent.x),
            };
            if shape.ny.max(shape.nx) > MAX_SIDE {
                let given = format!("an image of {} × {} pixels", shape.ny, shape.nx);
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
            let width = shape.nx as f64 * sensor.pitch;
            let middle = DVec2::new(right + 0.5 * width, 0.0);
            right += width;
            let first = places.len();
            places.extend(own.iter().map(|place| *place + middle));
            listed.push(ListedSensor {
                sensor: sensor.clone(),
                taxels: first..places.len(),
                places: own,
                shape,
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
            content,
        };
        Ok((listed, layout))
    }

    /// Returns the numbers of rows and columns of taxels; `None` for several sensors, or if the taxels are not numbered row by row.
    pub fn sides(&self) -> Option<ImageShape> {
        match &self.sensors[..] {
            [one] => one.sides(),
            _ => None,
        }
    }

    /// Returns the number of sensors, and the numbers of rows and columns that all of them have. Returns `None` if these numbers differ or a sensor has
    /// none.
    pub fn equal_sides(&self) -> Option<(usize, ImageShape)> {
        let first = self.sensors.first()?.sides()?;
        let is_equal = |sensor: &ListedSensor| sensor.sides() == Some(first);
        let all_equal = self.sensors.iter().all(is_equal);
        all_equal.then_some((self.sensors.len(), first))
    }

    /// Returns whether taxels of different sensors are neighbours in the patch. The distance of neighbours depends on the local spacing, which is undefined
    /// beside a single row of taxels.
    pub fn has_neighbours_across(&self, patch: &Patch) -> bool {
        let neighbours = Neighbours::new(patch);
        self.sensors.iter().any(|sensor| {
            let mut others = sensor
                .taxels
                .clone()
                .flat_map(|taxel| neighbours.of_taxel(taxel));
            others.any(|other| !sensor.taxels.contains(&other))
        })
    }

    /// Returns the two-dimensional positions of the taxels for charts, metres.
    pub fn places(&self) -> &[DVec2] {
        &self.places
    }

    /// Returns the pitch of the sensor with this taxel, metres.
    pub fn pitch_at(&self, taxel: usize) -> f64 {
        let own = self.sensors.iter().find(|s| s.taxels.contains(&taxel));
        own.map_or(f64::NAN, |own| own.sensor.pitch)
    }

    /// Returns the smallest pitch of the sensors, metres.
    pub fn finest_pitch(&self) -> f64 {
        let pitches = self.sensors.iter().map(|listed| listed.sensor.pitch);
        pitches.fold(f64::INFINITY, f64::min)
    }

    /// Returns the numbers of rows and columns of the images of the sensors.
    pub fn image_shapes(&self) -> Vec<ImageShape> {
        self.sensors.iter().map(|sensor| sensor.shape).collect()
    }

    /// Returns the image of each sensor.
    pub fn images(&self) -> Vec<SensorImage> {
        let image = |listed: &ListedSensor| {
            let (shape, pitch) = (listed.shape, listed.sensor.pitch);
            let widest = (listed.sensor.widest / pitch).max(1.0);
            let chart = || Chart::with_gaps(&listed.places, (pitch, widest), (shape, pitch));
            SensorImage {
                taxels: listed.taxels.clone(),
                shape,
                chart: listed.sensor.layout.as_grid().is_none().then(chart),
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
                let each = each.map(|s| format!("{} {}", s.sensor.name, s.taxels.len()));
                let each: Vec<String> = each.collect();
                format!("{} sensors ({})", sensors.len(), each.join(", "))
            }
        }
    }
}

/// Writes what determines frames: the numbers of taxels, the pitches of the sensors, and the positions and axes of the taxels.
impl Serialize for ListedTaxels {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        let pitches = self
            .sensors
            .iter()
            .map(|s| (s.taxels.len(), s.sensor.pitch));
        (pitches.collect::<Vec<_>>(), &self.content).serialize(serializer)
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

/// Rounds a number for an error message.
fn rounded(number: f64) -> f64 {
    (number * 1e3).round() / 1e3
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sensor(layout: Layout, pitch: f64) -> Result<PlacedSensor> {
        PlacedSensor::new("s", ("layout.csv", layout), pitch, None)
    }

    fn listed(taxels: impl IntoIterator<Item = (DVec3, DVec3)>) -> Layout {
        let (centers, axes) = taxels.into_iter().unzip();
        Layout::new(centers, axes).unwrap()
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
