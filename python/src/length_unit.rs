//! Length units by name.

use crate::errors::one_of;
use bubbletouch::mesh::LengthUnit;
use pyo3::prelude::*;

/// Returns the length unit with the given name, as used in study files.
///
/// # Errors
/// If there is no unit of this name.
pub fn unit_of(name: Option<&str>) -> PyResult<Option<LengthUnit>> {
    name.map(|name| one_of("unit", name, &LengthUnit::NAMES))
        .transpose()
}
