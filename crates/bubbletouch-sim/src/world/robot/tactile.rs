//! Tactile sensors of a URDF file: `<sensor>` with `<tactile>`, in the syntax of urdf_tactile (github.com/ubi-agni/tactile_toolbox).

use super::origin::{origin_of, pose_of};
use crate::error::Result;
use crate::geometry::Pose;
use crate::text::xml::{Element, POSITIVE};
use glam::DVec3;
use std::collections::HashMap;

/// Tactile sensor that a robot's file declares: the poses of its taxels on a link.
#[derive(Clone, Debug, PartialEq)]
pub struct TactileSensor {
    /// Name of the sensor.
    pub name: String,
    /// Name of the link that carries the sensor.
    pub link: String,
    /// Pose of the sensor on its link (`link_from_sensor`), metres.
    pub link_from_sensor: Pose,
    /// Pose `sensor_from_taxel` of each taxel, metres, in the order of the data vector; z is the taxel's normal.
    pub taxels: Vec<Pose>,
    /// Radius of each taxel, metres, shape (n_taxels,). `None` if not every taxel is described by a sphere.
    pub radii: Option<Vec<f64>>,
    /// Row and column of each taxel of an array, shape (n_taxels,). `None` for taxels that are listed one by one.
    pub pixels: Option<Vec<[usize; 2]>>,
    /// Notes on parts of the sensor that are not read, or on channels without a taxel.
    pub notes: Vec<String>,
}

/// Largest allowed number of taxels of an array. A larger number indicates a mistake in the file.
const MAX_TAXELS: usize = 1_000_000;

/// Returns the tactile sensors that a robot's file declares, in the order of the file: the name of each sensor and its content, or the fault that makes it
/// unreadable. A sensor with the name of an earlier sensor is unreadable. Notes name each unreadable sensor and its link.
pub(super) fn read_tactile_sensors(robot: Element) -> Vec<(String, Result<TactileSensor>)> {
    let mut first_lines = HashMap::new();
    let elements = robot.whole_document();
    let sensors = elements.filter(|it| it.tag() == "tactile").map(|tactile| {
        let place = Place::new(tactile);
        let name = place.name.unwrap_or("without a name");
        let first_line = place.name.and_then(|name| first_lines.get(name));
        let sensor = match first_line {
            None => read_sensor(tactile, &place),
            Some(line) => {
                let given = format!("a second sensor `{name}` (the first is on line {line})");
                Err(tactile.refuse(given, "a name of its own"))
            }
        };
        first_lines.entry(name).or_insert_with(|| tactile.line());
        match &sensor {
            Ok(sensor) => {
                let notes = sensor.notes.iter().cloned();
                notes.for_each(|note| robot.lines.note(note));
            }
            Err(fault) => robot.lines.note(format!(
                "{fault}: tactile sensor `{name}` on link `{}` is not read",
                place.link.unwrap_or("without a name")
            )),
        }
        (name.to_owned(), sensor)
    });
    sensors.collect()
}

/// Origin of a tactile sensor in the file: its XML element, its name, and the name of its link.
struct Place<'a> {
    sensor: Option<Element<'a>>,
    name: Option<&'a str>,
    link: Option<&'a str>,
}

impl<'a> Place<'a> {
    fn new(tactile: Element<'a>) -> Self {
        let around = |tag: &str| tactile.around().find(|element| element.tag() == tag);
        let sensor = around("sensor");
        let parent = sensor.and_then(|sensor| sensor.children("parent").next()?.attribute("link"));
        let link = around("link").and_then(|link| link.attribute("name"));
        let gazebo = around("gazebo").and_then(|element| element.attribute("reference"));
        Self {
            sensor,
            name: sensor.and_then(|sensor| sensor.attribute("name")),
            link: parent.or(link).or(gazebo),
        }
    }
}

fn read_sensor(tactile: Element, place: &Place) -> Result<TactileSensor> {
    let (Some(sensor), Some(name), Some(link)) = (place.sensor, place.name, place.link) else {
        let allowed = "a <sensor> with a name and <parent link=\"…\"/> around it";
        return Err(tactile.refuse("<tactile>", allowed));
    };
    let mut listed = tactile
        .children("taxel")
        .enumerate()
        .map(|(number, taxel)| {
            let index = taxel.integer("idx", 0, MAX_TAXELS - 1)?.unwrap_or(number);
            Ok((index, pose_of(taxel)?, sphere_radius(taxel)?, taxel))
        })
        .collect::<Result<Vec<_>>>()?;
    listed.sort_by_key(|(index, ..)| *index);
    if let Some(twice) = listed.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        let given = format!("a second taxel with `idx` {}", twice[1].0);
        return Err(twice[1].3.refuse(given, "one taxel for each channel"));
    }
    let mut notes = Vec::new();
    let n_channels = listed.last().map_or(0, |(index, ..)| index + 1);
    if n_channels > listed.len() {
        let given = format!("{} taxels for {n_channels} channels", listed.len());
        let allowed = "channels without a taxel are left out";
        notes.push(tactile.refuse(given, allowed).to_string());
    }
    let radii = listed.iter().map(|(_, _, radius, _)| *radius).collect();
    let (taxels, radii, pixels) = match (listed.is_empty(), tactile.child("array")?) {
        (true, Some(array)) => {
            let taxels = array_taxels(array)?;
            let (taxels, pixels) = taxels.into_iter().unzip();
            (taxels, None, Some(pixels))
        }
        (true, None) => {
            return Err(tactile.refuse("<tactile> without taxels", "an <array> or <taxel>s"));
        }
        (false, array) => {
            if array.is_some() {
                // urdf_tactile ignores the array, too.
                let given = "<array> beside <taxel>s";
                let note = tactile.refuse(given, "one of them: the array is not read");
                notes.push(note.to_string());
            }
            (
                listed.into_iter().map(|(_, pose, ..)| pose).collect(),
                radii,
                None,
            )
        }
    };
    Ok(TactileSensor {
        name: name.to_owned(),
        link: link.to_owned(),
        link_from_sensor: origin_of(sensor)?,
        taxels,
        radii,
        pixels,
        notes,
    })
}

/// Returns the radius of the sphere that describes the shape of a taxel, metres; `None` if the shape is no sphere or unknown.
fn sphere_radius(taxel: Element) -> Result<Option<f64>> {
    let Some(geometry) = taxel.child("geometry")? else {
        return Ok(None);
    };
    let Some(sphere) = geometry.child("sphere")? else {
        return Ok(None);
    };
    let [radius] = sphere.needed_in("radius", &POSITIVE)?;
    Ok(Some(radius))
}

/// Returns the poses, and the rows and columns, of the taxels of `<array rows cols order size spacing offset>`. Rows run along x and columns along y. The
/// taxel (0, 0) is at −offset.
fn array_taxels(array: Element) -> Result<Vec<(Pose, [usize; 2])>> {
    let rows = array.needed_integer("rows", 1, MAX_TAXELS)?;
    let columns = array.needed_integer("cols", 1, MAX_TAXELS)?;
    if rows * columns > MAX_TAXELS {
        let given = format!("{rows} × {columns} taxels");
        return Err(array.refuse(given, format!("at most {MAX_TAXELS}")));
    }
    let size = array.numbers_in("size", &POSITIVE)?;
    let spacing = array.numbers::<2>("spacing")?.or(size);
    let Some([along_x, along_y]) = spacing else {
        return Err(array.refuse("<array> without size and spacing", "one of them"));
    };
    if (rows > 1 && along_x == 0.0) || (columns > 1 && along_y == 0.0) {
        let given = format!("`spacing` {along_x} {along_y}");
        let allowed = "distances in metres, not zero; without spacing, the size";
        return Err(array.refuse(given, allowed));
    }
    let [x, y] = array.numbers::<2>("offset")?.unwrap_or([0.0; 2]);
    const ORDERS: [(&str, bool); 3] = [
        ("row-major", true),
        ("column-major", false),
        ("col-major", false),
    ];
    let is_by_rows = array.one_of("order", &ORDERS)?.unwrap_or(true);
    let taxels = (0..rows * columns).map(|index| {
        let (row, column) = match is_by_rows {
            true => (index / columns, index % columns),
            false => (index % rows, index / rows),
        };
        let place = DVec3::new(row as f64 * along_x - x, column as f64 * along_y - y, 0.0);
        (Pose::from_translation(place), [row, column])
    });
    Ok(taxels.collect())
}
