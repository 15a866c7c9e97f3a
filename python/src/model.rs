//! Contact models of objects: a [`Mesh`] or a [`SphereUnion`].

use crate::arrays::Object;
use crate::errors::bad_input;
use crate::mesh::Mesh;
use crate::sphere_union::SphereUnion;
use bubbletouch::objects::Model;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use std::borrow::Cow;

/// Returns the contact model of a Python object.
///
/// # Errors
/// If the object is neither a `Mesh` nor a `SphereUnion`; the message begins with `place`.
pub fn model_of<'a>(place: &str, object: &'a Object) -> PyResult<&'a Model> {
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

/// Contact models of the objects that a patch is pressed on.
pub struct Objects<'a> {
    /// Models of the objects, in the order of their poses.
    pub models: Cow<'a, [Model]>,
    /// Number of objects of a sequence; `None` if the argument was a single object.
    pub n_several: Option<usize>,
}

impl<'a> Objects<'a> {
    /// Reads the argument `object`: one object, or a sequence of objects.
    ///
    /// # Errors
    /// If the sequence is empty, or an object is neither a `Mesh` nor a `SphereUnion`.
    pub fn from_argument(object: &'a Object) -> PyResult<Self> {
        const PLACE: &str = "object";
        let one = model_of(PLACE, object);
        let (Err(_), Ok(objects)) = (&one, object.try_iter()) else {
            return Ok(Self {
                models: Cow::Borrowed(std::slice::from_ref(one?)),
                n_several: None,
            });
        };
        let model = |(number, object): (usize, PyResult<Object>)| {
            Ok(model_of(&format!("{PLACE}[{number}]"), &object?)?.clone())
        };
        let models: Vec<Model> = objects.enumerate().map(model).collect::<PyResult<_>>()?;
        match models.len() {
            0 => Err(bad_input(PLACE, "no object", "at least one")),
            n => Ok(Self {
                models: models.into(),
                n_several: Some(n),
            }),
        }
    }
}
