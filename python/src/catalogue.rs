//! `Catalogue` and `Solid`: named objects as parametric solids with real dimensions.

use crate::arrays::{Matrix, corners};
use crate::errors::{check_readable, exception, guarded};
use crate::sphere_union::SphereUnion;
use crate::threads::aside;
use bubbletouch::objects::{self, Entry};
use bubbletouch::study::load_catalogue;
use pyo3::prelude::*;
use std::path::PathBuf;

/// Catalogue of named objects, grouped into named sets.
#[pyclass(frozen, module = "bubbletouch")]
pub struct Catalogue {
    entries: objects::Catalogue,
}

#[pymethods]
impl Catalogue {
    /// Returns the built-in catalogue of bubbletouch: balls, boxes, cans, household objects and hands.
    #[staticmethod]
    fn builtin() -> PyResult<Self> {
        guarded(|| {
            let entries = objects::Catalogue::builtin().map_err(exception)?;
            Ok(Self { entries })
        })
    }

    /// Reads objects from a TOML file. Raises OSError if the file cannot be read, and ValueError, with the line number, if it is invalid.
    #[staticmethod]
    fn read(path: PathBuf) -> PyResult<Self> {
        guarded(|| {
            check_readable(&path)?;
            let entries = load_catalogue(&path).map_err(exception)?;
            Ok(Self { entries })
        })
    }

    /// Names of all objects, set by set.
    #[getter]
    fn names(&self) -> Vec<&str> {
        let entries = self.entries.entries().iter();
        entries.map(|entry| entry.name.as_str()).collect()
    }

    /// Names of all sets.
    #[getter]
    fn sets(&self) -> Vec<&str> {
        self.entries.sets()
    }

    /// Returns the object with the given name. If there is none, raises ValueError, which lists similar names.
    fn object(&self, name: &str) -> PyResult<Solid> {
        let entry = self.entries.object(name).map_err(exception)?;
        Ok(Solid(entry.clone()))
    }

    /// Returns all objects of the set with the given name. If there is no such set, raises ValueError, which lists the sets.
    fn set(&self, name: &str) -> PyResult<Vec<Solid>> {
        let entries = self.entries.set(name).map_err(exception)?;
        Ok(entries.into_iter().cloned().map(Solid).collect())
    }

    /// Number of objects in the catalogue.
    fn __len__(&self) -> usize {
        self.entries.entries().len()
    }

    fn __repr__(&self) -> String {
        let (n, sets) = (self.entries.entries().len(), self.entries.sets().join(", "));
        format!("<bubbletouch.Catalogue: {n} objects in {sets}>")
    }
}

/// Object of a catalogue: a union of parametric shapes with real dimensions. The object rests on z = 0; its bounding box is centred at x = y = 0.
#[pyclass(frozen, module = "bubbletouch")]
pub struct Solid(Entry);

#[pymethods]
impl Solid {
    /// Name of the object.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// Name of the set to which the object belongs: balls, boxes, cans, household, hands, or the name of a file.
    #[getter]
    fn set(&self) -> &str {
        &self.0.set
    }

    /// Source of the object's dimensions, such as a standard.
    #[getter]
    fn source(&self) -> &str {
        &self.0.source
    }

    /// Bounding box (2, 3): the smallest and largest coordinates, metres.
    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> Matrix<'py> {
        corners(py, &self.0.solid.bounds())
    }

    /// Returns spheres whose surface is within the tolerance (metres, positive) of the solid's surface. Raises ValueError for an invalid tolerance.
    fn pack(&self, py: Python, tolerance: f64) -> PyResult<SphereUnion> {
        guarded(|| {
            let solid = self.0.solid.clone();
            let packed = aside(py, move |_| solid.pack(tolerance))?;
            Ok(SphereUnion::from_spheres(packed.map_err(exception)?))
        })
    }

    fn __repr__(&self) -> String {
        let size = self.0.solid.bounds().size() * 1e3;
        let [x, y, z] = [size.x, size.y, size.z];
        let Entry { name, set, .. } = &self.0;
        format!("<bubbletouch.Solid {name} of {set}: {x:.1} × {y:.1} × {z:.1} mm>")
    }
}
