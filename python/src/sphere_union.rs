//! Class `SphereUnion`: rigid spheres.

use crate::arrays::{Matrix, Object, Vector, corners, each, points, to_column, to_rows};
use crate::errors::{bad_input, check_folder, check_readable, exception, guarded};
use crate::length_unit::unit_of;
use bubbletouch::files::write_whole;
use bubbletouch::mesh::SizeLimits;
use bubbletouch::objects::{self, Model, Sphere, write_spheres};
use bubbletouch::study::load_spheres;
use pyo3::prelude::*;
use std::path::PathBuf;

/// Union of rigid spheres.
///
/// `SphereUnion(centers, radii)`: centers (n, 3), metres; radii (n,) or one number, metres, positive. Raises ValueError if a sphere is invalid; the
/// message contains its number, from 1.
#[pyclass(frozen, module = "bubbletouch")]
pub struct SphereUnion {
    model: Model,
}

impl SphereUnion {
    /// Wraps a sphere union of the Rust library.
    pub fn from_spheres(spheres: objects::SphereUnion) -> Self {
        Self {
            model: spheres.into(),
        }
    }

    /// Returns the spheres as a model of the contact kernel.
    pub fn model(&self) -> &Model {
        &self.model
    }

    fn union(&self) -> &objects::SphereUnion {
        self.model.spheres().expect("it is made of spheres")
    }

    fn spheres(&self) -> &[Sphere] {
        self.union().spheres()
    }

    /// Returns the only sphere of the union.
    ///
    /// # Errors
    /// If there are several spheres; the message begins with `place`.
    pub fn single(&self, place: &str) -> PyResult<Sphere> {
        match self.spheres() {
            [sphere] => Ok(*sphere),
            all => Err(bad_input(
                place,
                format!("a SphereUnion of {} spheres", all.len()),
                "a Mesh, or one sphere",
            )),
        }
    }
}

#[pymethods]
impl SphereUnion {
    #[new]
    fn new(centers: &Object, radii: &Object) -> PyResult<Self> {
        guarded(|| {
            let centers = points("centers", centers)?;
            let radii = each("radii", radii, centers.len())?;
            let spheres = centers.into_iter().zip(radii);
            let spheres = spheres.map(|(center, radius)| Sphere { center, radius });
            let union = objects::SphereUnion::new(spheres.collect()).map_err(exception)?;
            Ok(Self::from_spheres(union))
        })
    }

    /// Reads spheres from a CSV file with columns x, y, z, r, in metres or in another unit.
    ///
    /// Raises OSError if the file cannot be read, and ValueError if it contains no valid spheres.
    #[staticmethod]
    #[pyo3(signature = (path, *, unit=None))]
    fn read(path: PathBuf, unit: Option<&str>) -> PyResult<Self> {
        guarded(|| {
            let unit = unit_of(unit)?;
            check_readable(&path)?;
            let spheres = load_spheres(&path, unit, &SizeLimits::ANY).map_err(exception)?;
            Ok(Self::from_spheres(spheres))
        })
    }

    /// Writes the spheres to a CSV file, from which read() returns bitwise equal spheres. Raises OSError if writing fails; an existing file is then
    /// kept.
    fn write(&self, path: PathBuf) -> PyResult<()> {
        guarded(|| {
            check_folder(&path)?;
            let written = write_whole(&path, |sink| write_spheres(self.union(), sink));
            written.map_err(exception)
        })
    }

    /// Centres of the spheres (n, 3), metres; a copy.
    #[getter]
    fn centers<'py>(&self, py: Python<'py>) -> Matrix<'py> {
        to_rows(py, self.spheres().iter().map(|sphere| sphere.center))
    }

    /// Radii of the spheres (n,), metres; a copy.
    #[getter]
    fn radii<'py>(&self, py: Python<'py>) -> Vector<'py> {
        to_column(py, self.spheres().iter().map(|sphere| sphere.radius))
    }

    /// Bounding box (2, 3): the smallest and largest coordinates, metres.
    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> Matrix<'py> {
        corners(py, &self.union().bounds())
    }

    /// Number of spheres of the union.
    fn __len__(&self) -> usize {
        self.spheres().len()
    }

    fn __repr__(&self) -> String {
        let size = self.union().bounds().size() * 1e3;
        let [x, y, z] = [size.x, size.y, size.z];
        let n = self.spheres().len();
        format!("<bubbletouch.SphereUnion: {n} spheres, {x:.1} × {y:.1} × {z:.1} mm>")
    }

    fn __getnewargs__<'py>(&self, py: Python<'py>) -> (Matrix<'py>, Vector<'py>) {
        (self.centers(py), self.radii(py))
    }
}
