//! Conversion of NumPy arrays to and from the library's types.
//!
//! Inputs of any real type are accepted as float64. A copy is made only of other types and of strided arrays.

use crate::errors::bad_input;
use bubbletouch::geometry::Aabb;
use glam::DVec3;
use ndarray::{Array2, ArrayViewD};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyAny;

/// Converts the input to a NumPy array with `numpy.asarray`.
fn asarray<'py>(py: Python<'py>, array: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    static ASARRAY: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    ASARRAY.import(py, "numpy", "asarray")?.call1((array,))
}

/// Converts an array of real numbers of any shape to float64, in C order.
///
/// # Errors
/// If the input is not an array of real numbers; the message begins with `place`.
pub fn numbers<'py>(
    place: &str,
    given: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    if let Ok(array) = given.cast::<PyArrayDyn<f64>>()
        && array.is_c_contiguous()
    {
        return Ok(array.clone());
    }
    let py = given.py();
    let array = asarray(py, given)
        .map_err(|error| bad_input(place, error.value(py), "an array of real numbers"))?;
    let dtype = array.getattr("dtype")?;
    let kind: String = dtype.getattr("kind")?.extract()?;
    if !matches!(&kind[..], "f" | "i" | "u" | "b") {
        let given = format!("dtype {dtype}");
        return Err(bad_input(place, given, "real numbers, such as float64"));
    }
    let array = array.call_method1("astype", ("float64", "C"))?;
    Ok(array.cast_into::<PyArrayDyn<f64>>()?)
}

/// Converts an array of real numbers to float64 and passes a view of the result to the closure `look`.
///
/// # Errors
/// If the input is not an array of real numbers, or if its shape does not satisfy `is_shape`.
pub fn view<T>(
    place: &str,
    given: &Bound<PyAny>,
    allowed: &str,
    is_shape: impl Fn(&[usize]) -> bool,
    look: impl FnOnce(ArrayViewD<f64>) -> PyResult<T>,
) -> PyResult<T> {
    let array = numbers(place, given)?;
    if !is_shape(array.shape()) {
        return Err(bad_input(place, shape_of(array.shape()), allowed));
    }
    let array = array
        .try_readonly()
        .map_err(|error| bad_input(place, error, "an array that nobody writes to meanwhile"))?;
    look(array.as_array())
}

/// Returns a shape as text in Python's notation, such as `shape (3, 7)`.
pub fn shape_of(shape: &[usize]) -> String {
    let sides: Vec<String> = shape.iter().map(ToString::to_string).collect();
    match &sides[..] {
        [side] => format!("shape ({side},)"),
        sides => format!("shape ({})", sides.join(", ")),
    }
}

/// Reads n points or directions from an n × 3 array.
///
/// # Errors
/// If the shape is wrong. The library checks that the numbers are finite; its error names them.
pub fn points(place: &str, given: &Bound<PyAny>) -> PyResult<Vec<DVec3>> {
    let is_shape = |shape: &[usize]| matches!(shape, [_, 3]);
    view(place, given, "(n, 3)", is_shape, |array| {
        let rows = array.rows().into_iter();
        Ok(rows.map(|row| DVec3::new(row[0], row[1], row[2])).collect())
    })
}

/// Returns n numbers from an array of n numbers, or from a single number that is repeated n times.
///
/// # Errors
/// If the shape is wrong.
pub fn each(place: &str, given: &Bound<PyAny>, n: usize) -> PyResult<Vec<f64>> {
    let is_shape = |shape: &[usize]| shape.is_empty() || shape == [n];
    let allowed = format!("({n},), or one number for all");
    view(place, given, &allowed, is_shape, |array| {
        Ok(match array.ndim() {
            0 => vec![array.first().copied().unwrap_or(f64::NAN); n],
            _ => array.iter().copied().collect(),
        })
    })
}

/// Converts an integer from Python to the integer type `T`; the error message contains `place`.
///
/// # Errors
/// If the number is out of the range of the type.
pub fn whole_number<T: TryFrom<i128>>(place: &str, given: i128) -> PyResult<T> {
    let allowed = "zero or a positive whole number below 2⁶⁴";
    T::try_from(given).map_err(|_| bad_input(place, given, allowed))
}

/// Returns whether an array with the given shape contains one frame, or several frames along the first axis. A frame has one axis of all taxels or, for a grid,
/// the two axes `sides` (rows, columns).
pub fn is_of_frames(shape: &[usize], n_taxels: usize, sides: Option<[usize; 2]>) -> bool {
    let is_frame = |frame: &[usize]| {
        let is_whole = frame.iter().product::<usize>() == n_taxels && !frame.is_empty();
        // Sides of length 1 do not determine the order of the axes.
        let known = frame.iter().filter(|&&side| side != 1);
        is_whole
            && (known.clone().count() < 2
                || sides.is_none_or(|sides| known.eq(sides.iter().filter(|&&side| side != 1))))
    };
    is_frame(shape) || shape.len() > 1 && is_frame(&shape[1..])
}

/// Reads frames of n taxels as an array n_frames × n. The shape of the input is (n_frames, …), where the lengths after the first have the product n, or the
/// shape of one frame.
///
/// # Errors
/// If the number of taxels is wrong, the frames of a grid have other sides than `sides` (rows, columns), or a number is not finite.
pub fn frames(
    place: &str,
    given: &Bound<PyAny>,
    n_taxels: usize,
    sides: Option<[usize; 2]>,
) -> PyResult<Array2<f64>> {
    let is_shape = |shape: &[usize]| is_of_frames(shape, n_taxels, sides);
    let allowed = match sides {
        Some([ny, nx]) => format!("(n, {ny}, {nx}) or (n, {n_taxels}), or one frame"),
        None => format!("(n, …) with {n_taxels} taxels a frame"),
    };
    view(place, given, &allowed, is_shape, |array| {
        let n_frames = array.len() / n_taxels;
        let values: Vec<f64> = array.iter().copied().collect();
        if let Some(at) = values.iter().position(|value| !value.is_finite()) {
            let place = format!("{place}, frame {}, taxel {}", at / n_taxels, at % n_taxels);
            return Err(bad_input(place, values[at], "only finite numbers"));
        }
        let frames = Array2::from_shape_vec((n_frames, n_taxels), values);
        Ok(frames.expect("as many values as frames times taxels"))
    })
}

/// Converts points to an n × 3 array for Python.
pub fn to_rows<'py>(
    py: Python<'py>,
    points: impl ExactSizeIterator<Item = DVec3>,
) -> Bound<'py, PyArray2<f64>> {
    let n = points.len();
    let values: Vec<f64> = points.flat_map(|point| point.to_array()).collect();
    let rows = Array2::from_shape_vec((n, 3), values).expect("three numbers a point");
    rows.into_pyarray(py)
}

/// Converts n values to a NumPy array of shape (n,).
pub fn to_column<T: numpy::Element>(
    py: Python<'_>,
    values: impl IntoIterator<Item = T>,
) -> Bound<'_, PyArray1<T>> {
    values.into_iter().collect::<Vec<T>>().into_pyarray(py)
}

/// Returns the corners of a box as a NumPy array `[[min], [max]]`, metres.
pub fn corners<'py>(py: Python<'py>, bounds: &Aabb) -> Bound<'py, PyArray2<f64>> {
    let corners: [DVec3; 2] = [bounds.min, bounds.max];
    to_rows(py, corners.into_iter())
}
