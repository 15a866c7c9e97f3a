//! Arrays of the caller that are filled with results.

use crate::arrays::{Object, shape_of};
use crate::errors::bad_input;
use numpy::{Element, PyArrayDyn, PyArrayMethods, PyReadwriteArrayDyn, PyUntypedArrayMethods};
use pyo3::prelude::*;
use std::fmt::Display;

/// Returns an array of the caller for results. `dtype` is the name of the array's type, with its article.
///
/// # Errors
/// If the object is not an array of this shape and type in C order; the message begins with `place`.
pub fn output_array<'py, T: Element>(
    place: impl Display,
    given: &Object<'py>,
    (shape, dtype): (&[usize], &str),
) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    let refuse = |given: String| {
        let allowed = format!("{dtype} array in C order of {}", shape_of(shape));
        bad_input(&place, given, allowed)
    };
    let Ok(array) = given.cast::<PyArrayDyn<T>>() else {
        return Err(refuse(match given.getattr("dtype") {
            Ok(dtype) => format!("an array of {dtype}"),
            Err(_) => given.get_type().to_string(),
        }));
    };
    if array.shape() != shape {
        return Err(refuse(shape_of(array.shape())));
    }
    if !array.is_c_contiguous() {
        return Err(refuse("an array in another order".to_owned()));
    }
    if !array.data().is_aligned() {
        return Err(refuse("a misaligned array".to_owned()));
    }
    Ok(array.clone())
}

/// Borrows an array of the caller for writing.
///
/// # Errors
/// If the array is read-only or in use elsewhere; the message begins with `place`.
pub fn writable<'py, T: Element>(
    place: impl Display,
    array: &Bound<'py, PyArrayDyn<T>>,
) -> PyResult<PyReadwriteArrayDyn<'py, T>> {
    let array = array.try_readwrite();
    array.map_err(|error| bad_input(place, error, "a writeable array that nobody else uses"))
}

/// Optional array of the caller that is filled with results. The array is checked before the results are computed.
pub struct Target<'py, T: Element> {
    place: &'static str,
    array: Option<Bound<'py, PyArrayDyn<T>>>,
}

impl<'py, T: Element + Copy> Target<'py, T> {
    /// Checks an optional array of the caller.
    ///
    /// # Errors
    /// Returns the errors of [`output_array`] and [`writable`].
    pub fn new(
        place: &'static str,
        given: Option<&Object<'py>>,
        form: (&[usize], &str),
    ) -> PyResult<Self> {
        let array = given.map(|given| output_array(place, given, form));
        let array = array.transpose()?;
        if let Some(array) = &array {
            writable(place, array)?;
        }
        Ok(Self { place, array })
    }

    /// Writes the results, as many numbers as the array has, into the array, if there is one.
    ///
    /// # Errors
    /// If the array is in use elsewhere; the message begins with the place of the array.
    pub fn fill_with<I: Iterator<Item = T>>(&self, numbers: impl FnOnce() -> I) -> PyResult<()> {
        let Some(array) = &self.array else {
            return Ok(());
        };
        let mut array = writable(self.place, array)?;
        let targets = array.as_slice_mut()?.iter_mut();
        targets
            .zip(numbers())
            .for_each(|(target, number)| *target = number);
        Ok(())
    }
}
