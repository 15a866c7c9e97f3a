//! Arrays of the caller: targets that are filled with results, and optional arguments with one number for each pair.

use crate::arrays::{numbers, shape_of};
use crate::errors::bad_input;
use numpy::{Element, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;

/// Writes numbers into an array of the caller, which must have the given shape.
///
/// # Errors
/// If the object is not a writeable array of this shape and type in C order; the message begins with `place`.
pub fn fill<T: Element + Copy>(
    place: &str,
    out: &Bound<PyAny>,
    (shape, dtype): (&[usize], &str),
    numbers: &[T],
) -> PyResult<()> {
    let allowed = || format!("a {dtype} array in C order of {}", shape_of(shape));
    let Ok(array) = out.cast::<PyArrayDyn<T>>() else {
        return Err(bad_input(place, out.get_type(), allowed()));
    };
    if array.shape() != shape || !array.is_c_contiguous() {
        return Err(bad_input(place, shape_of(array.shape()), allowed()));
    }
    let mut array = array
        .try_readwrite()
        .map_err(|error| bad_input(place, error, "a writeable array"))?;
    array.as_slice_mut()?.copy_from_slice(numbers);
    Ok(())
}

/// Copies an optional array of the given shape into `values`, which is empty if the argument is `None`.
///
/// # Errors
/// If the argument has another shape or is not an array of real numbers.
pub fn read_optional(
    place: &str,
    given: Option<&Bound<PyAny>>,
    shape: &[usize],
    values: &mut Vec<f64>,
) -> PyResult<()> {
    values.clear();
    let Some(given) = given else { return Ok(()) };
    let array = numbers(place, given)?;
    if array.shape() != shape {
        return Err(bad_input(place, shape_of(array.shape()), shape_of(shape)));
    }
    let array = array
        .try_readonly()
        .map_err(|error| bad_input(place, error, "an array that nobody writes to meanwhile"))?;
    values.extend_from_slice(array.as_slice()?);
    Ok(())
}
