//! Contact models of objects: a [`Mesh`] or a [`SphereUnion`].

use crate::mesh::Mesh;
use crate::sphere_union::SphereUnion;
use bubbletouch::objects::Model;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

/// Returns the contact model of a Python object.
///
/// # Errors
/// If the object is neither a `Mesh` nor a `SphereUnion`; the message begins with `place`.
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
