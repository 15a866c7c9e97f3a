//! What patches press on: a [`Mesh`] or a [`SphereUnion`].

use crate::mesh::Mesh;
use crate::sphere_union::SphereUnion;
use bubbletouch::geometry::Aabb;
use bubbletouch::mesh::LengthUnit;
use bubbletouch::objects::Model;
use glam::DVec3;
use numpy::PyArray2;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

/// The model of an object.
///
/// # Errors
/// Something else, named by `place`.
pub fn model_of<'a>(place: &str, object: &'a Bound<PyAny>) -> PyResult<&'a Model> {
    if let Ok(spheres) = object.cast::<SphereUnion>() {
        return Ok(spheres.get().model());
    }
    if let Ok(mesh) = object.cast::<Mesh>() {
        return Ok(mesh.get().model());
    }
    Err(PyTypeError::new_err(format!(
        "{place}: {}; a SphereUnion or a Mesh (a Solid is pressed as what its pack(tolerance) gives)",
        object.get_type()
    )))
}

/// [[min], [max]] of a box, metres.
pub fn corners<'py>(py: Python<'py>, bounds: &Aabb) -> Bound<'py, PyArray2<f64>> {
    let corners: [DVec3; 2] = [bounds.min, bounds.max];
    crate::arrays::to_rows(py, corners.into_iter())
}

/// A unit by its name, as files have it.
///
/// # Errors
/// No such unit.
pub fn unit_of(name: Option<&str>) -> PyResult<Option<LengthUnit>> {
    let Some(name) = name else {
        return Ok(None);
    };
    let found = LengthUnit::NAMES.iter().find(|(known, _)| *known == name);
    let unit = found.map(|(_, unit)| *unit);
    unit.map(Some).ok_or_else(|| {
        let given = format!("`{name}`");
        crate::errors::bad_input("unit", given, "m, cm, mm or in")
    })
}
