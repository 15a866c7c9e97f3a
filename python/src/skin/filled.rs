//! Arrays of the caller: targets that are filled with results, and optional arguments with one number for each pair.

use crate::arrays::{Object, array, shape_of};
use crate::errors::bad_input;
use numpy::{Element, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;

/// Array of the caller that is filled with results. The array is checked before the results are computed.
pub struct Target<'py, T: Element> {
    place: &'static str,
    array: Option<Bound<'py, PyArrayDyn<T>>>,
}

impl<'py, T: Element + Copy> Target<'py, T> {
    /// Checks an optional array of the caller. `dtype` is the name of the array's type, with its article.
    ///
    /// # Errors
    /// If the object is not a writeable array of this shape and type in C order; the message begins with `place`.
    pub fn new(
        place: &'static str,
        given: Option<&Object<'py>>,
        (shape, dtype): (&[usize], &str),
    ) -> PyResult<Self> {
        let Some(given) = given else {
            return Ok(Self { place, array: None });
        };
        let allowed = || format!("{dtype} array in C order of {}", shape_of(shape));
        let Ok(array) = given.cast::<PyArrayDyn<T>>() else {
            let given = match given.getattr("dtype") {
                Ok(dtype) => format!("an array of {dtype}"),
                Err(_) => given.get_type().to_string(),
            };
            return Err(bad_input(place, given, allowed()));
        };
        if array.shape() != shape {
            return Err(bad_input(place, shape_of(array.shape()), allowed()));
        }
        if !array.is_c_contiguous() {
            return Err(bad_input(place, "an array in another order", allowed()));
        }
        let writeable = array.try_readwrite().map(drop);
        writeable.map_err(|error| bad_input(place, error, "a writeable array"))?;
        Ok(Self {
            place,
            array: Some(array.clone()),
        })
    }

    /// Writes the results, as many numbers as the array has, into the array, if there is one.
    ///
    /// # Errors
    /// If the array is in use elsewhere; the message begins with the place of the array.
    pub fn fill_with<I: Iterator<Item = T>>(&self, numbers: impl FnOnce() -> I) -> PyResult<()> {
        let Some(array) = &self.array else {
            return Ok(());
        };
        let mut array = array
            .try_readwrite()
            .map_err(|error| bad_input(self.place, error, "a writeable array"))?;
        let targets = array.as_slice_mut()?.iter_mut();
        targets
            .zip(numbers())
            .for_each(|(target, number)| *target = number);
        Ok(())
    }
}

/// Copies an optional array of the given shape into `values`, which is empty if the argument is `None`.
///
/// # Errors
/// If the argument has another shape or is not an array of real numbers.
pub fn read_optional(
    place: &str,
    given: Option<&Object>,
    shape: &[usize],
    values: &mut Vec<f64>,
) -> PyResult<()> {
    values.clear();
    if let Some(given) = given {
        let array = array(place, given, &shape_of(shape), |is| is == shape)?;
        values.extend_from_slice(array.values());
    }
    Ok(())
}
