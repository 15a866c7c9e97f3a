//! Class `Patch`: taxels on a rigid substrate.

use super::arguments::{
    drape_region, each_taxel, missing_taxels, pixels_of, side, taxel, with_shape,
};
use crate::arrays::{Matrix, Object, points, to_column, to_rows, whole_number};
use crate::batch::{Spare, n_threads};
use crate::errors::{check_folder, check_readable, exception, guarded, warn};
use crate::length_unit::unit_of;
use crate::mesh::Mesh;
use crate::model::model_of;
use crate::poses::Poses;
use crate::press::batch_press::{Wanted, press};
use crate::press::goal::Goal;
use crate::press::output::Output;
use crate::press::slide::{Motion, press_and_slide};
use crate::sphere_union::SphereUnion;
use bubbletouch::contact::Workspace;
use bubbletouch::geometry::Pose;
use bubbletouch::inputs::layout_file::{LayoutFile, LayoutOptions};
use bubbletouch::mesh::TriangleMesh;
use bubbletouch::objects::Sphere;
use bubbletouch::random::Seed;
use bubbletouch::report::layout_picture::write_layout_picture;
use bubbletouch::world::{self, Grid, Layout, Taxel, Taxels};
use glam::DVec3;
use ndarray::Array2;
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::path::PathBuf;

/// Taxels on a rigid substrate. A patch is created by one of the static methods.
///
/// A taxel is a sphere of `taxel_radius` (metres, positive; half the pitch if None) on a spring of `stiffness` (N/m, positive). Its `damping`
/// (N·s/m, zero or more) is used by signal chains and scenes. Its deflection is at most its `stroke` (metres, positive). The methods raise
/// ValueError for values out of range, and for more than 4,194,304 taxels.
#[pyclass(frozen, module = "bubbletouch")]
pub struct Patch {
    patch: world::Patch,
    /// Shape of a frame: (ny, nx) for taxels in rows and columns, otherwise (n_taxels,).
    shape: Vec<usize>,
    /// Row and column of each taxel in the sensor's image, if the layout has one.
    pixels: Option<Vec<[usize; 2]>>,
    /// Memory that successive presses of the patch reuse.
    spare: Spare<Workspace>,
}

impl Patch {
    /// Wraps a patch of the Rust library.
    pub fn from_patch(patch: world::Patch) -> Self {
        Self {
            shape: frame_shape(patch.layout()),
            pixels: None,
            spare: Spare::new(),
            patch,
        }
    }

    fn with(layout: bubbletouch::Result<Layout>, taxels: impl Into<Taxels>) -> PyResult<Self> {
        let patch = layout.and_then(|layout| world::Patch::new("patch", layout, taxels));
        patch.map(Self::from_patch).map_err(exception)
    }

    /// Creates a patch with the taxels of a layout file. If no radius is given, the radii in the file are used, or else the default radius of the file. If no
    /// stroke is given, it is the diameter of the taxel.
    fn from_file(
        file: LayoutFile,
        stroke: Option<f64>,
        (taxel_radius, stiffness, damping): (Option<f64>, f64, f64),
    ) -> PyResult<Self> {
        let with_radius = |radius| Taxel {
            radius,
            stiffness,
            damping,
            stroke: stroke.unwrap_or(2.0 * radius),
        };
        let taxels = match (taxel_radius, &file.radii) {
            (None, Some(radii)) => joined(radii.iter().copied().map(with_radius).collect()),
            (radius, _) => {
                let radius = radius.unwrap_or_else(|| file.default_radius());
                Taxels::Equal(with_radius(radius))
            }
        };
        Ok(Self {
            pixels: file.pixels,
            ..Self::with(Ok(file.layout), taxels)?
        })
    }

    /// Returns the patch of the Rust library that this object wraps.
    pub fn inner(&self) -> &world::Patch {
        &self.patch
    }

    /// Returns the shape of a frame: (ny, nx) for taxels in rows and columns, otherwise (n_taxels,).
    pub fn sides(&self) -> &[usize] {
        &self.shape
    }

    /// Returns the memory that successive presses of the patch reuse.
    pub fn spare(&self) -> &Spare<Workspace> {
        &self.spare
    }

    /// Returns a property of the taxels as a Python object: one number if all taxels are equal, otherwise an array with one number per taxel.
    fn property<'py>(&self, py: Python<'py>, of: impl Fn(&Taxel) -> f64) -> PyResult<Object<'py>> {
        Ok(match self.patch.taxels() {
            Taxels::Equal(taxel) => of(taxel).into_pyobject(py)?.into_any(),
            Taxels::Each(taxels) => to_column(py, taxels.iter().map(of)).into_any(),
        })
    }
}

/// Returns the shape of a frame: (ny, nx) for taxels in rows and columns, otherwise (n_taxels,).
pub fn frame_shape(layout: &Layout) -> Vec<usize> {
    let sides = layout.sides().map(|sides| sides.to_vec());
    sides.unwrap_or_else(|| vec![layout.n_taxels()])
}

/// Returns the taxels of a patch as equal taxels, if they are equal.
fn joined(taxels: Vec<Taxel>) -> Taxels {
    match taxels.iter().all(|taxel| *taxel == taxels[0]) {
        true => Taxels::Equal(taxels[0]),
        false => Taxels::Each(taxels),
    }
}

#[pymethods]
impl Patch {
    /// Returns a grid of ny rows (along y, ascending) of nx taxels in the plane z = 0. The taxels are `pitch` metres apart; the grid is centred on the
    /// origin. Frames have the shape (ny, nx).
    #[staticmethod]
    #[pyo3(signature = (ny, nx, pitch, stroke, *, taxel_radius=None, stiffness=100.0, damping=0.0))]
    fn grid(
        ny: i64,
        nx: i64,
        pitch: f64,
        stroke: f64,
        taxel_radius: Option<f64>,
        stiffness: f64,
        damping: f64,
    ) -> PyResult<Self> {
        guarded(|| {
            let (ny, nx) = (side("ny", ny)?, side("nx", nx)?);
            let layout = Layout::grid(&Grid { nx, ny, pitch });
            let taxel = taxel(pitch, stroke, (taxel_radius, stiffness, damping));
            Self::with(layout, taxel)
        })
    }

    /// Returns a patch of ny staggered rows of nx taxels on a hexagonal lattice. Each inner taxel has six neighbours `pitch` metres away. The taxels
    /// are numbered row by row.
    #[staticmethod]
    #[pyo3(signature = (ny, nx, pitch, stroke, *, taxel_radius=None, stiffness=100.0, damping=0.0))]
    fn hexagonal(
        ny: i64,
        nx: i64,
        pitch: f64,
        stroke: f64,
        taxel_radius: Option<f64>,
        stiffness: f64,
        damping: f64,
    ) -> PyResult<Self> {
        guarded(|| {
            let (ny, nx) = (side("ny", ny)?, side("nx", nx)?);
            let layout = Layout::hexagonal(nx, ny, pitch);
            let taxel = taxel(pitch, stroke, (taxel_radius, stiffness, damping));
            Self::with(layout, taxel)
        })
    }

    /// Returns a patch of all taxels of a hexagonal lattice within `radius` metres of the origin. The taxels are numbered row by row.
    #[staticmethod]
    #[pyo3(signature = (radius, pitch, stroke, *, taxel_radius=None, stiffness=100.0, damping=0.0))]
    fn disc(
        radius: f64,
        pitch: f64,
        stroke: f64,
        taxel_radius: Option<f64>,
        stiffness: f64,
        damping: f64,
    ) -> PyResult<Self> {
        let taxel = taxel(pitch, stroke, (taxel_radius, stiffness, damping));
        guarded(|| Self::with(Layout::disc(radius, pitch), taxel))
    }

    /// Returns a patch of rings of taxels around the z axis that face away from the axis, as on a forearm or a finger.
    ///
    /// radius: distance of the rest centres from the axis, metres.
    /// length: distance between the first and the last ring, metres, zero or more.
    /// arc: angle covered by a ring, radians, above 0 to 2π, centred at +x.
    /// pitch: distance between taxels along the surface, metres; rounded so that a whole number of taxels fits.
    ///
    /// Presses move along z: use moved() to turn the middle of the patch to z.
    #[staticmethod]
    #[pyo3(signature = (radius, length, arc, pitch, stroke, *, taxel_radius=None, stiffness=100.0, damping=0.0))]
    fn cylinder(
        radius: f64,
        length: f64,
        arc: f64,
        pitch: f64,
        stroke: f64,
        taxel_radius: Option<f64>,
        stiffness: f64,
        damping: f64,
    ) -> PyResult<Self> {
        let taxel = taxel(pitch, stroke, (taxel_radius, stiffness, damping));
        guarded(|| Self::with(Layout::cylinder(radius, length, arc, pitch), taxel))
    }

    /// Returns a patch of rings of taxels on a sphere about the origin, as on a fingertip or an elbow.
    ///
    /// radius: radius of the sphere, metres.
    /// half_angle: angle from the pole at +z to the edge, radians, above 0 to π.
    #[staticmethod]
    #[pyo3(signature = (radius, half_angle, pitch, stroke, *, taxel_radius=None, stiffness=100.0, damping=0.0))]
    fn sphere_cap(
        radius: f64,
        half_angle: f64,
        pitch: f64,
        stroke: f64,
        taxel_radius: Option<f64>,
        stiffness: f64,
        damping: f64,
    ) -> PyResult<Self> {
        let taxel = taxel(pitch, stroke, (taxel_radius, stiffness, damping));
        guarded(|| Self::with(Layout::sphere_cap(radius, half_angle, pitch), taxel))
    }

    /// Returns a patch of taxels that are distributed over the outer surface of a mesh, or of a SphereUnion of one sphere.
    ///
    /// The number of taxels equals the number in a grid with this pitch. The taxels are at least 0.83 pitches apart. The call takes 0.3 ms per taxel. A
    /// taxel whose axis would meet the mesh again is omitted; n_left_out counts these taxels. Closed parts of the mesh that face inwards are turned
    /// outwards, with a UserWarning.
    ///
    /// The region is the intersection of the given conditions:
    ///
    /// - bounds (2, 3): smallest and largest coordinates, metres;
    /// - plane (2, 3): a point, metres, and the direction to the covered side;
    /// - triangles: triangle indices.
    #[staticmethod]
    #[pyo3(signature = (mesh, pitch, stroke, *, seed=0, bounds=None, plane=None, triangles=None, taxel_radius=None, stiffness=100.0, damping=0.0))]
    fn draped(
        py: Python,
        mesh: &Object,
        pitch: f64,
        stroke: f64,
        seed: i128,
        bounds: Option<&Object>,
        plane: Option<&Object>,
        triangles: Option<Vec<i128>>,
        taxel_radius: Option<f64>,
        stiffness: f64,
        damping: f64,
    ) -> PyResult<Self> {
        guarded(|| {
            let seed = whole_number("seed", seed)?;
            let region = drape_region(bounds, plane, triangles)?;
            let drape = |mesh: TriangleMesh| {
                let draped = py.detach(|| {
                    let (outwards, orientation) = mesh.turned_outwards();
                    let layout = Layout::draped_on(&outwards, pitch, &region, &Seed::new(seed));
                    layout.map(|layout| (layout, orientation))
                });
                draped.map_err(exception)
            };
            let layout = match mesh.cast::<SphereUnion>() {
                Ok(spheres) => {
                    let sphere = spheres.get().single("mesh")?;
                    on_sphere(sphere, drape(facets(sphere).map_err(exception)?)?.0)
                }
                Err(_) => {
                    model_of("mesh", mesh)?;
                    let mesh = mesh.cast::<Mesh>()?.get();
                    let (layout, orientation) = drape(mesh.triangle_mesh().clone())?;
                    mesh.warn_if_turned(py, &orientation)?;
                    Ok(layout)
                }
            };
            let taxel = taxel(pitch, stroke, (taxel_radius, stiffness, damping));
            Self::with(layout, taxel)
        })
    }

    /// Returns a patch of given taxels: centers (n, 3), metres, and unit axes (n, 3) that point away from the substrate. The lengths of the axes may
    /// differ from 1 by 1 %; the axes are normalised. The other arguments are arrays (n,), or one number for all taxels. Defaults: stiffness 100 N/m,
    /// damping 0.
    ///
    /// shape: shape of a frame, (ny, nx) if the taxels are numbered row by row. Default: (n,).
    /// pixels: row and column of each taxel in the sensor's image, (n, 2) integers from 0.
    #[staticmethod]
    #[pyo3(signature = (centers, axes, *, stroke, taxel_radius, stiffness=None, damping=None, shape=None, pixels=None))]
    fn from_arrays(
        centers: &Object,
        axes: &Object,
        stroke: &Object,
        taxel_radius: &Object,
        stiffness: Option<&Object>,
        damping: Option<&Object>,
        shape: Option<Vec<i64>>,
        pixels: Option<&Object>,
    ) -> PyResult<Self> {
        guarded(|| {
            let centers = points("centers", centers)?;
            let axes = points("axes", axes)?;
            let n = centers.len();
            let taxels = each_taxel(n, (stroke, taxel_radius), (stiffness, damping))?;
            let layout = Layout::new(centers, axes).map_err(exception)?;
            let layout = with_shape(layout, shape)?;
            Ok(Self {
                pixels: pixels.map(|given| pixels_of(given, n)).transpose()?,
                ..Self::with(Ok(layout), joined(taxels))?
            })
        })
    }

    /// Returns a patch with the taxels of a layout file.
    ///
    /// The extension of `path` selects the format:
    ///
    /// - .csv: columns x_mm, y_mm, z_mm, nx, ny, nz, and optionally radius_mm, row and column;
    /// - .npz: positions and normals, or poses and taxel2pixel as for DEX-01;
    /// - .txt or .ini: iCub;
    /// - .json: PaXini;
    /// - .urdf: `<tactile>` of urdf_tactile, or XELA's prismatic joints; `sensor` selects one of several sensors.
    ///
    /// stroke: metres. Default: the diameter of the taxel.
    /// mesh: surface that gives the normals, for files without normals or with placeholders, such as files of iCub and PaXini.
    /// unit: "m", "cm", "mm" or "in", for .npz, .txt, .ini and .json files that do not state their unit. Default: mm for PaXini, metres for others.
    /// taxel_radius: metres. Default: the radius in the file, or half the median distance between neighbours.
    ///
    /// Frames have the shape (ny, nx) if the file numbers its taxels row by row in a complete image. Notes of the reader are issued as UserWarnings.
    /// Raises ValueError with the file and the row if the file is invalid, and OSError if it cannot be read.
    #[staticmethod]
    #[pyo3(signature = (path, stroke=None, *, mesh=None, unit=None, sensor=None, taxel_radius=None, stiffness=100.0, damping=0.0))]
    fn read(
        py: Python,
        path: PathBuf,
        stroke: Option<f64>,
        mesh: Option<&Mesh>,
        unit: Option<&str>,
        sensor: Option<&str>,
        taxel_radius: Option<f64>,
        stiffness: f64,
        damping: f64,
    ) -> PyResult<Self> {
        guarded(|| {
            let options = LayoutOptions {
                mesh: mesh.map(Mesh::triangle_mesh),
                unit: unit_of(unit)?,
                sensor,
            };
            check_readable(&path)?;
            let file = LayoutFile::read(&path, options).map_err(exception)?;
            warn(py, &file.notes, 1)?;
            Self::from_file(file, stroke, (taxel_radius, stiffness, damping))
        })
    }

    /// Returns a patch of taxels at given points, metres, (n, 3), with normals that point away from the substrate.
    ///
    /// stroke: metres. Default: the diameter of the taxel.
    /// normals: vectors of any length, (n, 3), or a Mesh whose surface gives the normals. Each point must be at most 5 mm from the mesh.
    /// taxel_radius: metres. Default: half the median distance between neighbours.
    /// shape: shape of a frame, (ny, nx) if the taxels are numbered row by row. Default: (n,).
    /// pixels: row and column of each taxel in the sensor's image, (n, 2) integers from 0.
    #[staticmethod]
    #[pyo3(signature = (positions, normals, stroke=None, *, taxel_radius=None, stiffness=100.0, damping=0.0, shape=None, pixels=None))]
    fn from_points(
        positions: &Object,
        normals: &Object,
        stroke: Option<f64>,
        taxel_radius: Option<f64>,
        stiffness: f64,
        damping: f64,
        shape: Option<Vec<i64>>,
        pixels: Option<&Object>,
    ) -> PyResult<Self> {
        guarded(|| {
            let positions = points("positions", positions)?;
            let n = positions.len();
            let file = match normals.cast::<Mesh>() {
                Ok(mesh) => {
                    let mesh = mesh.get().triangle_mesh();
                    LayoutFile::on_surface("positions", positions, mesh)
                }
                Err(_) => {
                    let normals = points("normals", normals)?;
                    LayoutFile::from_points("from_points", positions, normals)
                }
            };
            let file = file.map_err(exception)?;
            let pixels = pixels.map(|given| pixels_of(given, n)).transpose()?;
            let file = LayoutFile {
                layout: with_shape(file.layout.clone(), shape)?,
                pixels,
                ..file
            };
            Self::from_file(file, stroke, (taxel_radius, stiffness, damping))
        })
    }

    /// Returns a flat grid of ny × nx taxels that is wrapped around the surface of a mesh.
    ///
    /// The grid lies in the plane z = 0 of the pose, with `pitch` metres between taxels. The pose is (7,) or (4, 4), in the frame of the mesh. Each taxel
    /// moves along −z of the pose to the first point of the mesh. Its axis is the outward normal of the triangle at this point. The centres and axes are
    /// in the frame of the mesh. Closed parts of the mesh that face inwards are turned outwards, with a UserWarning.
    ///
    /// stroke: metres. Default: the diameter of the taxel.
    /// missing: "error" raises ValueError if a taxel meets no outer face of the mesh. "drop" omits such taxels, and n_left_out counts them.
    ///
    /// Frames have the shape (ny, nx) if no taxel is omitted. `pixels` contains the row and column of each taxel in the grid.
    #[staticmethod]
    #[pyo3(signature = (mesh, pose, ny, nx, pitch, stroke=None, *, missing="error", taxel_radius=None, stiffness=100.0, damping=0.0))]
    fn projected(
        py: Python,
        mesh: &Bound<Mesh>,
        pose: &Object,
        ny: i64,
        nx: i64,
        pitch: f64,
        stroke: Option<f64>,
        missing: &str,
        taxel_radius: Option<f64>,
        stiffness: f64,
        damping: f64,
    ) -> PyResult<Self> {
        guarded(|| {
            let pose = Poses::single("pose", pose)?;
            let missing = missing_taxels(missing)?;
            let (ny, nx) = (side("ny", ny)?, side("nx", nx)?);
            let grid = Grid { nx, ny, pitch };
            let mesh = mesh.get();
            let (projected, orientation) = py.detach(|| {
                let (outwards, orientation) = mesh.triangle_mesh().clone().turned_outwards();
                let projected = Layout::projected(&outwards, &pose, &grid, missing);
                (projected, orientation)
            });
            let projected = projected.map_err(exception)?;
            mesh.warn_if_turned(py, &orientation)?;
            let stroke = stroke.unwrap_or_else(|| 2.0 * taxel_radius.unwrap_or(0.5 * pitch));
            let taxel = taxel(pitch, stroke, (taxel_radius, stiffness, damping));
            Ok(Self {
                pixels: Some(projected.pixels),
                ..Self::with(Ok(projected.layout), taxel)?
            })
        })
    }

    /// Writes the layout to a file that Patch.read can read. The file contains positions and normals, and radii and pixels if the format has them.
    ///
    /// format: csv, npz, dex-01 (poses and taxel2pixel in a .npz file), icub (.txt or .ini), paxini (.json) or urdf. None selects the format by the extension.
    ///
    /// Radii and pixels that the format cannot represent are omitted, with a UserWarning. If a csv, npz or icub file is read again, the layout is bitwise
    /// equal. Other formats round the last digits. Raises OSError if the file cannot be written.
    #[pyo3(signature = (path, *, format=None))]
    fn write(&self, py: Python, path: PathBuf, format: Option<&str>) -> PyResult<()> {
        guarded(|| {
            let format = format.map(str::parse).transpose().map_err(exception)?;
            let n_taxels = self.patch.n_taxels();
            let radii = (0..n_taxels).map(|taxel| self.patch.taxels().at(taxel).radius);
            let file = LayoutFile {
                layout: self.patch.layout().clone(),
                radii: Some(radii.collect()),
                pixels: self.pixels.clone(),
                link: None,
                notes: Vec::new(),
            };
            check_folder(&path)?;
            warn(py, file.write(&path, format).map_err(exception)?, 1)
        })
    }

    /// Draws the taxels to a file that ends in .svg or .png. The picture has a map with the taxels' numbers, from 0, and an oblique view with their axes.
    ///
    /// title: heading of the picture, "patch" if None.
    #[pyo3(signature = (path, *, title=None))]
    fn draw(&self, py: Python, path: PathBuf, title: Option<&str>) -> PyResult<()> {
        guarded(|| {
            check_folder(&path)?;
            let layout = self.patch.layout();
            let title = title.unwrap_or("patch");
            py.detach(|| write_layout_picture(&path, title, layout))
                .map_err(exception)
        })
    }

    /// Row and column of each taxel in the sensor's image, (n_taxels, 2) integers; None if the layout file contains no image.
    #[getter]
    fn pixels<'py>(&self, py: Python<'py>) -> Option<Matrix<'py, i64>> {
        let pixels = self.pixels.as_ref()?.iter();
        let pixels: Vec<[i64; 2]> = pixels.map(|pixel| pixel.map(|side| side as i64)).collect();
        Some(Array2::from(pixels).into_pyarray(py))
    }

    /// Returns a copy of the patch, moved by a pose in the patch frame. Frames of the copy have the same shape. pose: (7,) or (4, 4).
    fn moved(&self, pose: &Object) -> PyResult<Self> {
        guarded(|| {
            let pose = Poses::single("pose", pose)?;
            let layout = self.patch.layout().moved(&pose);
            Ok(Self {
                pixels: self.pixels.clone(),
                ..Self::with(Ok(layout), self.patch.taxels().clone())?
            })
        })
    }

    /// Shape of a frame of the patch: (ny, nx) for taxels in rows and columns, otherwise (n_taxels,).
    #[getter]
    fn shape<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.shape)
    }

    /// Number of taxels of the patch.
    #[getter]
    fn n_taxels(&self) -> usize {
        self.patch.n_taxels()
    }

    /// Number of taxels omitted from a draped patch because their axes would meet the mesh again; 0 for other patches.
    #[getter]
    fn n_left_out(&self) -> usize {
        self.patch.layout().n_left_out()
    }

    /// Rest centres of the taxels (n_taxels, 3), metres; a copy.
    #[getter]
    fn centers<'py>(&self, py: Python<'py>) -> Matrix<'py> {
        to_rows(py, self.patch.layout().centers().iter().copied())
    }

    /// Unit axes of the taxels (n_taxels, 3), pointing away from the substrate; a copy.
    #[getter]
    fn axes<'py>(&self, py: Python<'py>) -> Matrix<'py> {
        to_rows(py, self.patch.layout().axes().iter().copied())
    }

    /// Distance between neighbouring taxels of a grid, metres; None for other patches.
    #[getter]
    fn pitch(&self) -> Option<f64> {
        self.patch.layout().as_grid().map(|grid| grid.pitch)
    }

    /// Radius of the taxels, metres: one number, or one per taxel.
    #[getter]
    fn taxel_radius<'py>(&self, py: Python<'py>) -> PyResult<Object<'py>> {
        self.property(py, |taxel| taxel.radius)
    }

    /// Stroke (largest deflection) of the taxels, metres: one number, or one per taxel. A taxel whose deflection equals its stroke is saturated.
    #[getter]
    fn stroke<'py>(&self, py: Python<'py>) -> PyResult<Object<'py>> {
        self.property(py, |taxel| taxel.stroke)
    }

    /// Stiffness of the taxels, N/m: one number, or one per taxel.
    #[getter]
    fn stiffness<'py>(&self, py: Python<'py>) -> PyResult<Object<'py>> {
        self.property(py, |taxel| taxel.stiffness)
    }

    /// Damping of the taxels, N·s/m: one number, or one per taxel.
    #[getter]
    fn damping<'py>(&self, py: Python<'py>) -> PyResult<Object<'py>> {
        self.property(py, |taxel| taxel.damping)
    }

    /// Number of taxels of the patch.
    fn __len__(&self) -> usize {
        self.patch.n_taxels()
    }

    fn __repr__(&self) -> String {
        match self.patch.layout().as_grid() {
            Some(grid) => {
                let (ny, nx, pitch) = (grid.ny, grid.nx, 1e3 * grid.pitch);
                format!("<bubbletouch.Patch: grid of {ny} × {nx} taxels, {pitch} mm apart>")
            }
            None => format!("<bubbletouch.Patch: {} taxels>", self.patch.n_taxels()),
        }
    }

    /// Pickles a grid as its constructor call, and another patch as its arrays.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Object<'py>, Bound<'py, PyTuple>)> {
        let named = PyDict::new(py);
        named.set_item("stroke", self.stroke(py)?)?;
        named.set_item("taxel_radius", self.taxel_radius(py)?)?;
        named.set_item("stiffness", self.stiffness(py)?)?;
        named.set_item("damping", self.damping(py)?)?;
        let class = py.get_type::<Self>();
        let grid = self.patch.layout().as_grid();
        let (made_by, given) = match (grid, self.patch.taxels()) {
            (Some(grid), Taxels::Equal(_)) if self.pixels.is_none() => {
                let sides = (grid.ny, grid.nx, grid.pitch);
                (class.getattr("grid")?, sides.into_pyobject(py)?)
            }
            _ => {
                named.set_item("shape", &self.shape)?;
                named.set_item("pixels", self.pixels(py))?;
                let arrays = (self.centers(py), self.axes(py));
                (class.getattr("from_arrays")?, arrays.into_pyobject(py)?)
            }
        };
        let partial = py.import("functools")?.getattr("partial")?;
        let call = partial.call((made_by,), Some(&named))?;
        Ok((call, given))
    }

    /// Presses the patch on one or several objects at n poses. Returns the deflections of the taxels, metres, from 0 to the stroke.
    ///
    /// object: a Mesh or a SphereUnion, or a sequence of k of them. If several objects deflect a taxel, the largest deflection counts.
    /// poses: poses of the object in the patch frame, (n, 7) of x, y, z, qw, qx, qy, qz or (n, 4, 4). A single pose is (7,) or (4, 4). For a sequence of k
    /// objects, the shape is (n, k, 7) or (n, k, 4, 4). A single pose of each object is (k, 7) or (k, 4, 4).
    ///
    /// The patch approaches along its z axis. At most one of the following goals is given, as one number for all poses or (n,):
    ///
    /// - depth: metres past first contact, zero or more;
    /// - travel: metres from the given pose;
    /// - force: newtons, positive, the sum Σ k δ of all springs.
    ///
    /// Without a goal, the deflections are computed at the given pose. If the patch does not touch the object, the deflections are zero.
    ///
    /// output: "deflection" or "force". The force of a taxel along its axis is its stiffness times its deflection, newtons.
    /// out: C-contiguous array of float32 or float64 that receives the frames and is returned.
    /// dtype: type of a new array, float64 (default) or float32.
    /// threads: maximum number of threads; all cores if None. The call releases the interpreter's lock, and Ctrl-C ends the call.
    ///
    /// Returns an array (n, ny, nx) for a grid, and (n, n_taxels) for another patch; for a single pose, without the axis n. The result is bitwise equal
    /// for any number of threads. With contacts=True, the Contacts are also returned; the frames are unchanged. With jacobian=True, the derivatives
    /// (…, 6) of the output with respect to the object's pose are also returned; (…, k, 6) for a sequence of k objects. The derivatives are
    /// per metre along x, y, z, and per radian about x, y, z through the object's origin, in the axes of the patch. Free and saturated taxels have zeros.
    /// With a depth or a force, the derivatives include the change of the travel. With a depth, the patch must be flat.
    ///
    /// Raises ValueError for arrays of a wrong shape or type, numbers that are not finite, and a force that cannot be reached.
    #[pyo3(signature = (object, poses, *, depth=None, travel=None, force=None, output="deflection", out=None, dtype=None, threads=None, contacts=false, jacobian=false))]
    fn press<'py>(
        &self,
        py: Python<'py>,
        object: &Object<'py>,
        poses: &Object<'py>,
        depth: Option<&Object<'py>>,
        travel: Option<&Object<'py>>,
        force: Option<&Object<'py>>,
        output: &str,
        out: Option<&Object<'py>>,
        dtype: Option<&Object<'py>>,
        threads: Option<i64>,
        contacts: bool,
        jacobian: bool,
    ) -> PyResult<Object<'py>> {
        guarded(|| {
            let goal = Goal::from_arguments(depth, travel, force)?;
            let wanted = Wanted {
                output: Output::from_argument(output)?,
                contacts,
                jacobian,
            };
            let (given, threads) = ((object, poses, goal), n_threads(threads)?);
            press(py, self, given, (out, dtype), threads, wanted)
        })
    }

    /// Presses the patch to a depth past first contact, then slides it along its x and y axes, at n poses. The skin has friction: the objects drag the
    /// taxels sideways until they slip. The friction is zero at first contact.
    ///
    /// object, poses, threads: as in press().
    /// depth: metres, zero or more; one number, or (n,).
    /// slide: motion of the patch after the press along x and y, metres, (2,) or (n, 2).
    /// friction: coefficient between taxels and objects, zero or more; one number, or (n_taxels,).
    /// shear_stiffness: stiffness of the taxels across their axes, N/m; one number, or (n_taxels,). Default: the stiffness along the axes.
    ///
    /// Returns a dict of arrays at the end of the slide. For a single pose, the arrays have no axis n. The keys are:
    ///
    /// - deflection: metres, (n, ny, nx) for a grid, and (n, n_taxels) for another patch;
    /// - force3: force of the objects on each taxel, newtons, (n, n_taxels, 3), in the patch frame;
    /// - is_slipping: whether the contact of the taxel slipped in the last step, in the shape of the deflections;
    /// - wrench: force and torque on the patch about its origin, newtons and newton metres, (n, 6), in the patch frame;
    /// - travel: travel of the patch along z, metres, (n,). If the path misses all objects, the travel is NaN and all other results are zero.
    ///
    /// Raises ValueError if an argument is invalid.
    #[pyo3(signature = (object, poses, *, depth, slide, friction, shear_stiffness=None, threads=None))]
    fn press_and_slide<'py>(
        &self,
        py: Python<'py>,
        object: &Object<'py>,
        poses: &Object<'py>,
        depth: &Object<'py>,
        slide: &Object<'py>,
        friction: &Object<'py>,
        shear_stiffness: Option<&Object<'py>>,
        threads: Option<i64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let motion = Motion {
            depth,
            slide,
            friction,
            shear_stiffness,
        };
        guarded(|| {
            let patch = (&self.patch, &self.shape[..]);
            press_and_slide(py, patch, (object, poses), &motion, threads)
        })
    }
}

/// Returns a triangle mesh of a sphere, within a thousandth of its radius.
fn facets(sphere: Sphere) -> bubbletouch::Result<TriangleMesh> {
    let radii = DVec3::splat(sphere.radius);
    let mesh = TriangleMesh::ellipsoid("sphere", radii, 1e-3 * sphere.radius)?;
    Ok(mesh.moved(&Pose::from_translation(sphere.center)))
}

/// Returns the taxels of a layout on the facets of a sphere, moved onto the sphere itself.
fn on_sphere(sphere: Sphere, layout: Layout) -> bubbletouch::Result<Layout> {
    let outwards = |center: &DVec3| (*center - sphere.center).normalize();
    let axes: Vec<DVec3> = layout.centers().iter().map(outwards).collect();
    let centers = axes
        .iter()
        .map(|axis| sphere.center + sphere.radius * *axis);
    Layout::new(centers.collect(), axes)
}
