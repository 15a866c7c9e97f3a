//! Files of taxel layouts: positions and axes of the taxels of real skins, in the formats that manufacturers and laboratories publish.
//!
//! | file | format | content |
//! |---|---|---|
//! | `.csv`, `.tsv` | [`csv`] | `x_mm, y_mm, z_mm, nx, ny, nz[, radius_mm][, row, column]`, one row for each taxel |
//! | `.npz` | [`npz`] | `positions` and `normals`, each n × 3, metres; or `poses`, n × 3 × 4, and `taxel2pixel`, n × 2, as for Analog Devices' DEX-01 |
//! | `.txt`, `.ini` | [`icub`] | position files of iCub's skin: position (metres) and normal of each taxel |
//! | `.json` | [`paxini`] | taxel positions of PaXini's sensors, mm, with or without normals |
//! | `.urdf`, `.xml` | [`urdf`] | `<sensor><tactile>` of urdf_tactile, or taxels of three prismatic joints, as for XELA's uSkin |
//!
//! Some published files have placeholders for normals: zeros, or one normal for taxels that are not in a plane across it. A mesh then gives the normals.

pub mod csv;
mod format;
pub mod icub;
mod millimetres;
pub mod npz;
pub mod paxini;
pub mod urdf;

use crate::error::{Error, Result};
use crate::mesh::{LengthUnit, Surface, TriangleMesh};
use crate::world::{Layout, TactileSensor, unit_axis};
pub use format::LayoutFormat;
use glam::{DVec2, DVec3};
use std::path::Path;

/// List of the file formats from which layouts can be read, for error messages.
const FORMATS: &str = "a layout in .csv, .npz, .txt or .ini (iCub), .json (PaXini) or .urdf";

/// Content of a layout file: the taxels of a patch or of a tactile sensor.
#[derive(Clone, Debug)]
pub struct LayoutFile {
    /// Rest centres and axes of the taxels.
    pub layout: Layout,
    /// Radius of each taxel, metres, shape (n_taxels,). `None` if the file has no radii.
    pub radii: Option<Vec<f64>>,
    /// Row and column of each taxel in the sensor's image, shape (n_taxels,). `None` if the file has no image.
    pub pixels: Option<Vec<[usize; 2]>>,
    /// Name of the robot link that carries the taxels; `None` if the layout is not read from a robot file.
    pub link: Option<String>,
    /// Notes on parts of the file that are not taxels, such as unused rows.
    pub notes: Vec<String>,
}

/// Further inputs of the reader of layout files, which some formats need.
#[derive(Clone, Copy, Debug, Default)]
pub struct LayoutOptions<'a> {
    /// Surface from which the normals of the taxels are taken; required only if the file contains no normals, or placeholders.
    pub mesh: Option<&'a TriangleMesh>,
    /// Unit of the positions and radii, for files that do not state their unit. `None`: mm for PaXini's files, metres for others.
    pub unit: Option<LengthUnit>,
    /// Name of the sensor to read; required only if the file has several sensors.
    pub sensor: Option<&'a str>,
}

impl LayoutFile {
    /// Reads a layout file; the file name's extension determines the format.
    ///
    /// # Errors
    /// If the file cannot be read, has no taxels, or has an invalid row; the error contains the file and the row (from 1). If the file needs an option that is
    /// missing, or does not use an option that is given.
    pub fn read(path: &Path, options: LayoutOptions) -> Result<Self> {
        let place = path.display().to_string();
        let ending = path.extension().and_then(|ending| ending.to_str());
        let ending = ending.unwrap_or_default().to_ascii_lowercase();
        let refuse =
            |option: &str, of: &str| Err(Error::input(&place, option, format!("none: {of}")));
        if options.mesh.is_some() && matches!(&ending[..], "urdf" | "xml") {
            return refuse("a mesh for normals", "this format has normals of its own");
        }
        if options.unit.is_some() && !matches!(&ending[..], "npz" | "txt" | "ini" | "json") {
            return refuse("a unit", "this format states its unit");
        }
        if options.sensor.is_some() && !matches!(&ending[..], "urdf" | "xml") {
            return refuse("a sensor's name", "only robots' files have several sensors");
        }
        let text = || {
            let text = crate::files::read_to_string(path);
            text.map_err(|error| Error::unreadable(path, FORMATS, error))
        };
        let mut file = match &ending[..] {
            "csv" | "tsv" => csv::read(&place, &text()?, options)?,
            "npz" => npz::read(path, options)?,
            "txt" | "ini" => icub::read(&place, &text()?, options)?,
            "json" => paxini::read(&place, &text()?, options)?,
            "urdf" | "xml" => urdf::read(&place, &text()?, options.sensor)?,
            _ => return Err(Error::input(place, "another file", FORMATS)),
        };
        if options.unit.is_none() {
            file.notes.extend(unusual_size(&place, &file.layout));
        }
        Ok(file)
    }

    /// Creates the content of a layout file from its taxels, each a position in metres and an axis vector of any length.
    ///
    /// # Errors
    /// If a number is not finite or an axis has length zero; the error contains the taxel's row number, which is taken from `rows`.
    fn new(place: &str, taxels: Vec<(DVec3, DVec3)>, rows: &[usize]) -> Result<Self> {
        let Some(_) = taxels.first() else {
            return Err(Error::input(place, "no taxel", "at least one taxel"));
        };
        for ((center, axis), row) in taxels.iter().zip(rows) {
            let at = || format!("{place}, row {row}");
            if !center.is_finite() || !axis.is_finite() {
                let allowed = "finite numbers for place and normal";
                return Err(Error::input(at(), "a number that is not finite", allowed));
            }
            if axis.length() < MIN_AXIS {
                let given = format!("normal {axis} of length {}", axis.length());
                return Err(Error::input(at(), given, "a vector with a direction"));
            }
        }
        let taxels = taxels.into_iter();
        let (centers, axes) = taxels.map(|(c, a)| (c, unit_axis(a))).unzip();
        Ok(Self {
            layout: Layout::new(centers, axes).map_err(|error| error.under(place))?,
            radii: None,
            pixels: None,
            link: None,
            notes: Vec::new(),
        })
    }

    /// Returns the taxels of a tactile sensor in a robot's file, in the frame of the sensor's link.
    ///
    /// # Errors
    /// If the sensor's poses are not a valid layout; the error begins with `place`.
    pub fn of_sensor(place: &str, sensor: &TactileSensor) -> Result<Self> {
        let poses = sensor
            .taxels
            .iter()
            .map(|taxel| sensor.link_from_sensor.compose(taxel));
        let taxels = poses.map(|pose| (pose.translation, pose.rotation * DVec3::Z));
        let read = Self::in_order(place, taxels.collect())?;
        Ok(Self {
            link: Some(sensor.link.clone()),
            radii: sensor.radii.clone(),
            notes: sensor.notes.clone(),
            ..match &sensor.pixels {
                Some(pixels) => read.with_pixels(pixels.clone()),
                None => read,
            }
        })
    }

    /// Creates the content of a layout file from positions (metres) and normals of any length.
    ///
    /// # Errors
    /// If there are no positions, or the numbers of positions and normals differ. If a position or normal is invalid; the error contains the row, from 1.
    pub fn from_points(place: &str, positions: Vec<DVec3>, normals: Vec<DVec3>) -> Result<Self> {
        if positions.len() != normals.len() {
            let given = format!("{} positions, {} normals", positions.len(), normals.len());
            return Err(Error::input(place, given, "one normal a position"));
        }
        Self::in_order(place, positions.into_iter().zip(normals).collect())
    }

    /// Creates the content of a layout file from positions (metres) on a surface, whose outward normals are the axes.
    ///
    /// # Errors
    /// If a position is invalid or more than 5 mm from the surface; the error contains the row, from 1.
    pub fn on_surface(place: &str, positions: Vec<DVec3>, surface: &TriangleMesh) -> Result<Self> {
        let rows: Vec<usize> = (1..=positions.len()).collect();
        let normals = surface_normals(place, (&positions, &rows), surface)?;
        Self::from_points(place, positions, normals)
    }

    /// Creates the content of a layout file from its points, with or without normals of any length. Normals that are [placeholders](placeholder) count as none.
    /// Points of x and y alone are a flat skin with axes along z.
    ///
    /// # Errors
    /// If a normal has no position or no direction, a mesh is given beside normals, or neither is given for points in space. The last error consists of the two
    /// texts `without_normals`: what is given, and what else is allowed.
    fn of_points(
        place: &str,
        mut points: Points,
        normals: Option<Vec<DVec3>>,
        options: LayoutOptions,
        without_normals: (&str, &str),
    ) -> Result<Self> {
        if let Some(unit) = options.unit {
            points
                .positions
                .iter_mut()
                .for_each(|position| *position *= unit.metres());
        }
        let Points {
            positions,
            rows,
            is_flat,
        } = &points;
        let placeholder = normals
            .as_ref()
            .and_then(|normals| placeholder(positions, normals));
        let normals = normals.filter(|_| placeholder.is_none());
        let mut notes = Vec::new();
        let normals = match (normals, options.mesh) {
            (Some(normals), None) => normals,
            (Some(_), Some(_)) => {
                let allowed = "none: the file has normals of its own";
                return Err(Error::input(place, "a mesh for normals", allowed));
            }
            (None, Some(mesh)) => {
                notes.extend(
                    placeholder
                        .map(|given| format!("{place}: {given}; the mesh gives the normals")),
                );
                surface_normals(place, (positions, rows), mesh)?
            }
            (None, None) if *is_flat && placeholder.is_none() => {
                notes.push(format!(
                    "{place}: positions x and y alone are read as a flat skin with normals along z"
                ));
                vec![DVec3::Z; positions.len()]
            }
            (None, None) => {
                let (given, allowed) = without_normals;
                let given = placeholder.unwrap_or_else(|| given.to_owned());
                let allowed = format!("{allowed}a mesh beside it, whose surface gives the normals");
                return Err(Error::input(place, given, allowed));
            }
        };
        let taxels = points.positions.into_iter().zip(normals).collect();
        Ok(Self {
            notes,
            ..Self::new(place, taxels, &points.rows)?
        })
    }

    /// Sets the row and column of each taxel in the sensor's image. If the taxels are numbered row by row in a complete image, the layout has its sides.
    fn with_pixels(self, pixels: Vec<[usize; 2]>) -> Self {
        let n_columns = pixels.iter().map(|[_, column]| column + 1).max();
        let n_columns = n_columns.unwrap_or(1);
        let in_order =
            |(taxel, pixel): (usize, &[usize; 2])| *pixel == [taxel / n_columns, taxel % n_columns];
        let is_image = pixels.iter().enumerate().all(in_order);
        let sides = [pixels.len() / n_columns, n_columns];
        let layout = match is_image {
            // If the last row is incomplete, the layout has no sides.
            true => self.layout.clone().with_sides(sides).unwrap_or(self.layout),
            false => self.layout,
        };
        Self {
            layout,
            pixels: Some(pixels),
            ..self
        }
    }

    /// Returns the row and column of each taxel in the image of the layout file, or of a layout that is numbered row by row. Returns `None` if there is no
    /// image.
    pub fn image(&self) -> Option<Vec<[usize; 2]>> {
        let by_rows = |[_, n_columns]: [usize; 2]| {
            let taxels = 0..self.layout.n_taxels();
            taxels
                .map(|taxel| [taxel / n_columns, taxel % n_columns])
                .collect()
        };
        self.pixels
            .clone()
            .or_else(|| self.layout.sides().map(by_rows))
    }

    /// Creates the content of a layout file whose rows are its taxels, in order and counted from 1.
    ///
    /// # Errors
    /// Returns the errors of [`new`](Self::new).
    fn in_order(place: &str, taxels: Vec<(DVec3, DVec3)>) -> Result<Self> {
        let rows: Vec<usize> = (1..=taxels.len()).collect();
        Self::new(place, taxels, &rows)
    }

    /// Returns the default radius of the taxels, metres. It is half the median distance from a taxel to its nearest neighbour, or 1 mm for a single taxel.
    pub fn default_radius(&self) -> f64 {
        let centers = self.layout.centers();
        let nearest = |one: &DVec3| {
            let others = centers.iter().filter(|other| *other != one);
            others
                .map(|other| one.distance(*other))
                .min_by(f64::total_cmp)
        };
        let looked_at = centers
            .iter()
            .step_by(centers.len().div_ceil(MAX_LOOKED_AT));
        let mut nearest: Vec<f64> = looked_at.filter_map(nearest).collect();
        nearest.sort_by(f64::total_cmp);
        nearest
            .get(nearest.len() / 2)
            .map_or(1e-3, |pitch| 0.5 * pitch)
    }
}

/// Positions of taxels in a layout file.
struct Points {
    /// Rest centres of the taxels, in the unit of the options or in metres.
    positions: Vec<DVec3>,
    /// Number of each taxel's row in the file, for messages.
    rows: Vec<usize>,
    /// Whether the file contains x and y alone; z is then 0.
    is_flat: bool,
}

/// Returns a description of normals that cannot be those of the taxels' surface; `None` for other normals. Such placeholders are zeros, or one normal n of several
/// taxels that are not in a plane across n. For a pad that is slightly uneven or inclined, the variance along n may be a hundredth of the smallest variance
/// across n. A further ten-thousandth of the whole variance allows for rounded numbers.
fn placeholder(positions: &[DVec3], normals: &[DVec3]) -> Option<String> {
    let first = *normals.first()?;
    if normals.iter().any(|normal| *normal != first) {
        return None;
    }
    if first == DVec3::ZERO {
        return Some(format!("all {} normals have length zero", normals.len()));
    }
    let n = first.try_normalize()?;
    let (u, v) = n.any_orthonormal_pair();
    let mean = positions.iter().sum::<DVec3>() / positions.len() as f64;
    let (mut along, mut squares, mut product) = (0.0, DVec2::ZERO, 0.0);
    for position in positions {
        let offset = *position - mean;
        let across = DVec2::new(offset.dot(u), offset.dot(v));
        along += offset.dot(n).powi(2);
        squares += across * across;
        product += across.x * across.y;
    }
    let total = squares.x + squares.y;
    let least = 0.5 * (total - (squares.x - squares.y).hypot(2.0 * product));
    let is_placeholder = along > 1e-2 * least + 1e-4 * (total + along);
    is_placeholder.then(|| {
        let n_taxels = normals.len();
        format!("the normal {first} of all {n_taxels} taxels is not perpendicular to their surface")
    })
}

/// Maximum distance between a taxel and the surface that provides its normal, metres. A larger distance indicates that taxels and mesh have different frames or
/// units.
const MAX_DISTANCE: f64 = 5e-3;

/// Returns the outward unit normal of the mesh surface at the point nearest to each taxel. `rows` contains the number of each taxel's row in the file.
fn surface_normals(
    place: &str,
    (points, rows): (&[DVec3], &[usize]),
    mesh: &TriangleMesh,
) -> Result<Vec<DVec3>> {
    let surface = Surface::new(mesh.clone());
    let normal = |(point, row): (&DVec3, &usize)| {
        let closest = surface.closest(*point, f64::INFINITY);
        let near = closest.filter(|closest| closest.distance <= MAX_DISTANCE);
        let Some(near) = near else {
            let distance = closest.map_or(f64::INFINITY, |closest| closest.distance);
            let given = format!("a point {:.1} mm from the mesh", 1e3 * distance);
            let allowed = "points on the mesh, within 5 mm, in the frame of the mesh";
            return Err(Error::input(format!("{place}, row {row}"), given, allowed));
        };
        Ok(surface.pseudonormal(&near).normalize_or_zero())
    };
    points.iter().zip(rows).map(normal).collect()
}

/// Usual lengths of a layout, metres: from the smallest sensor arrays to the limbs of a robot. Files in another unit are beyond them by a factor of 100 or 1000.
const USUAL_LENGTHS: std::ops::RangeInclusive<f64> = 1e-3..=1.0;

/// Returns a note on the length of a layout of several taxels outside the usual lengths.
fn unusual_size(place: &str, layout: &Layout) -> Option<String> {
    let centers = layout.centers().iter().copied();
    let low = centers.clone().fold(DVec3::INFINITY, DVec3::min);
    let high = centers.fold(DVec3::NEG_INFINITY, DVec3::max);
    let length = (high - low).max_element();
    let is_unusual = layout.n_taxels() > 1 && !USUAL_LENGTHS.contains(&length);
    is_unusual.then(|| {
        format!(
            "{place}: the layout is {} mm long; 1 mm to 1 m is usual: if the file is in another unit, give it (--unit, or unit= in Python)",
            (1e6 * length).round() / 1e3
        )
    })
}

/// Maximum number of taxels whose nearest neighbours are searched; the distances determine the default radius. A larger number takes longer and hardly changes
/// the median.
const MAX_LOOKED_AT: usize = 200;

/// Minimum length of a normal or axis vector in a layout file. Files contain normals with four decimals; shorter vectors count as zero.
const MIN_AXIS: f64 = 1e-3;
