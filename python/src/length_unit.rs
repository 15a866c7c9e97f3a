//! Length units by name.

use crate::errors::bad_input;
use bubbletouch::mesh::LengthUnit;
use pyo3::prelude::*;

/// Returns the length unit with the given name, as used in study files.
///
/// # Errors
/// If there is no unit of this name.
pub fn unit_of(name: Option<&str>) -> PyResult<Option<LengthUnit>> {
    let Some(name) = name else {
        return Ok(None);
    };
    let found = LengthUnit::NAMES.iter().find(|(known, _)| *known == name);
    let unit = found.map(|(_, unit)| *unit);
    unit.map(Some).ok_or_else(|| {
        let given = format!("`{name}`");
        bad_input("unit", given, "m, cm, mm or in")
    })
}
