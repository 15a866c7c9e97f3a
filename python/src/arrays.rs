//! Conversion of NumPy arrays to and from the library's types.
//!
//! Inputs of any real type are accepted as float64. A copy is made only of other types and of strided arrays.

use crate::errors::bad_input;
use bubbletouch::geometry::Aabb;
use glam::DVec3;
use ndarray::Array2;
use numpy::{
    Element, IntoPyArray, PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn,
    PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyAny;

/// Object of Python.
pub type Object<'py> = Bound<'py, PyAny>;

/// NumPy array with one axis.
pub type Vector<'py, T = f64> = Bound<'py, PyArray1<T>>;

/// NumPy array with two axes.
pub type Matrix<'py, T = f64> = Bound<'py, PyArray2<T>>;

/// Converts the input to a NumPy array with `numpy.asarray`.
fn asarray<'py>(py: Python<'py>, array: &Object<'py>) -> PyResult<Object<'py>> {
    static ASARRAY: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    ASARRAY.import(py, "numpy", "asarray")?.call1((array,))
}

/// Numbers of a NumPy array, borrowed for reading: float64 in C order.
pub struct Numbers<'py>(PyReadonlyArrayDyn<'py, f64>);

impl Numbers<'_> {
    /// Returns the lengths of the array's axes.
    pub fn shape(&self) -> &[usize] {
        self.0.shape()
    }

    /// Returns the numbers of the array in C order.
    pub fn values(&self) -> &[f64] {
        self.0.as_slice().expect("the array is in C order")
    }

    /// Returns a copy of the numbers, given an array of two axes.
    pub fn matrix(&self) -> Array2<f64> {
        let shape = (self.shape()[0], self.shape()[1]);
        let matrix = Array2::from_shape_vec(shape, self.values().to_vec());
        matrix.expect("as many numbers as the shape")
    }

    /// Checks that all numbers are finite.
    ///
    /// # Errors
    /// If a number is not finite; the message begins with `place`.
    pub fn finite(self, place: &str, allowed: &str) -> PyResult<Self> {
        match self.values().iter().find(|value| !value.is_finite()) {
            Some(bad) => Err(bad_input(place, bad, allowed)),
            None => Ok(self),
        }
    }
}

/// Converts an array of real numbers of any shape to float64, in C order.
///
/// # Errors
/// If the input is not an array of real numbers, or if somebody writes to it; the message begins with `place`.
pub fn numbers<'py>(place: &str, given: &Object<'py>) -> PyResult<Numbers<'py>> {
    let array = match given.cast::<PyArrayDyn<f64>>() {
        Ok(array) if is_plain(array) => array.clone(),
        _ => converted(place, given)?,
    };
    let array = array.try_readonly();
    array
        .map(Numbers)
        .map_err(|error| bad_input(place, error, "an array that nobody writes to meanwhile"))
}

/// Returns whether an array is no subclass, such as a masked array, and its elements are aligned and in C order.
fn is_plain<T: Element>(array: &Bound<PyArrayDyn<T>>) -> bool {
    let is_exact = array.is_exact_instance_of::<PyUntypedArray>();
    is_exact && array.is_c_contiguous() && array.data().is_aligned()
}

fn converted<'py>(place: &str, given: &Object<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    static IS_MASKED: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let py = given.py();
    let is_masked = IS_MASKED.import(py, "numpy.ma", "is_masked")?;
    if is_masked.call1((given,))?.is_truthy()? {
        return Err(bad_input(place, "masked values", "an array without a mask"));
    }
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

/// Converts an array of real numbers whose shape satisfies `is_shape` to float64, in C order.
///
/// # Errors
/// If the input is not an array of real numbers, or if it has another shape; `allowed` describes the allowed shapes.
pub fn array<'py>(
    place: &str,
    given: &Object<'py>,
    allowed: &str,
    is_shape: impl Fn(&[usize]) -> bool,
) -> PyResult<Numbers<'py>> {
    let array = numbers(place, given)?;
    match is_shape(array.shape()) {
        true => Ok(array),
        false => Err(bad_input(place, shape_of(array.shape()), allowed)),
    }
}

/// Returns a shape as text in Python's notation, such as `shape (3, 7)`.
pub fn shape_of(shape: &[usize]) -> String {
    let sides: Vec<String> = shape.iter().map(ToString::to_string).collect();
    match &sides[..] {
        [side] => format!("shape ({side},)"),
        sides => format!("shape ({})", sides.join(", ")),
    }
}

/// Reads n rows of N numbers from an n × N array.
///
/// # Errors
/// If the shape is wrong. The library checks that the numbers are finite; its error names them.
pub fn rows<const N: usize>(place: &str, given: &Object) -> PyResult<Vec<[f64; N]>> {
    let is_shape = |shape: &[usize]| matches!(shape, [_, n] if *n == N);
    let array = array(place, given, &format!("(n, {N})"), is_shape)?;
    Ok(array.values().as_chunks::<N>().0.to_vec())
}

/// Reads n points or directions from an n × 3 array.
///
/// # Errors
/// If the shape is wrong.
pub fn points(place: &str, given: &Object) -> PyResult<Vec<DVec3>> {
    Ok(rows::<3>(place, given)?
        .into_iter()
        .map(DVec3::from)
        .collect())
}

/// Rows of N numbers: a common row of all items of a batch, or a row for each item.
pub struct Rows<const N: usize> {
    rows: Vec<[f64; N]>,
    is_common: bool,
}

impl<const N: usize> Rows<N> {
    /// Creates a common row of all items.
    pub fn common(row: [f64; N]) -> Self {
        let (rows, is_common) = (vec![row], true);
        Self { rows, is_common }
    }

    /// Reads an array of shape (N,) or (n, N); for N = 1, a number or (n,).
    ///
    /// # Errors
    /// If the shape is wrong, or a number is not finite.
    pub fn read(place: &str, given: &Object) -> PyResult<Self> {
        let row: &[usize] = if N == 1 { &[] } else { &[N] };
        let allowed = match N {
            1 => "a number, or (n,)".to_owned(),
            _ => format!("({N},), or (n, {N})"),
        };
        let is_shape =
            |shape: &[usize]| shape == row || matches!(shape, [_, rest @ ..] if rest == row);
        let array = array(place, given, &allowed, is_shape)?.finite(place, "finite numbers")?;
        Ok(Self {
            rows: array.values().as_chunks::<N>().0.to_vec(),
            is_common: array.shape() == row,
        })
    }

    /// Returns the number of rows; `None` for a common row.
    pub fn n(&self) -> Option<usize> {
        (!self.is_common).then_some(self.rows.len())
    }

    /// Returns the row of an item.
    pub fn at(&self, item: usize) -> [f64; N] {
        self.rows[if self.is_common { 0 } else { item }]
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

/// Returns n numbers from an array of n numbers, or from a single number that is repeated n times.
///
/// # Errors
/// If the shape is wrong.
pub fn each(place: &str, given: &Object, n: usize) -> PyResult<Vec<f64>> {
    let is_shape = |shape: &[usize]| shape.is_empty() || shape == [n];
    let allowed = format!("({n},), or one number for all");
    let array = array(place, given, &allowed, is_shape)?;
    Ok(match array.shape() {
        [] => vec![array.values()[0]; n],
        _ => array.values().to_vec(),
    })
}

/// Converts numbers of an array to whole numbers from 0.
///
/// # Errors
/// If a number has a fractional part, is negative or is too large; `allowed` describes the allowed numbers.
pub fn whole_numbers<T: TryFrom<u64>>(
    place: &str,
    values: &[f64],
    allowed: &str,
) -> PyResult<Vec<T>> {
    let whole = |&value: &f64| {
        let is_whole = value.fract() == 0.0 && (0.0..2f64.powi(53)).contains(&value);
        let number = is_whole.then_some(value as u64);
        let number = number.and_then(|number| T::try_from(number).ok());
        number.ok_or_else(|| bad_input(place, value, allowed))
    };
    values.iter().map(whole).collect()
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

/// Frames of taxels of an argument.
pub struct Frames {
    /// Readings, shape (n_frames, n_taxels).
    pub values: Array2<f64>,
    /// Shape of the argument.
    pub shape: Vec<usize>,
}

/// Reads frames of n taxels as an array n_frames × n. The shape of the input is (n_frames, …), where the lengths after the first have the product n, or the
/// shape of one frame.
///
/// # Errors
/// If the number of taxels is wrong, the frames of a grid have other sides than `sides` (rows, columns), or a number is not finite.
pub fn frames(
    place: &str,
    given: &Object,
    n_taxels: usize,
    sides: Option<[usize; 2]>,
) -> PyResult<Frames> {
    let is_shape = |shape: &[usize]| is_of_frames(shape, n_taxels, sides);
    let allowed = match sides {
        Some([ny, nx]) => format!("(n, {ny}, {nx}) or (n, {n_taxels}), or one frame"),
        None => format!("(n, …) with {n_taxels} taxels a frame"),
    };
    let array = array(place, given, &allowed, is_shape)?;
    let values = array.values();
    if let Some(at) = values.iter().position(|value| !value.is_finite()) {
        let place = format!("{place}, frame {}, taxel {}", at / n_taxels, at % n_taxels);
        return Err(bad_input(place, values[at], "only finite numbers"));
    }
    let frames = Array2::from_shape_vec((values.len() / n_taxels, n_taxels), values.to_vec());
    Ok(Frames {
        values: frames.expect("as many values as frames times taxels"),
        shape: array.shape().to_vec(),
    })
}

/// Converts rows of N numbers to an n × N array for Python.
pub fn to_matrix<const N: usize>(py: Python<'_>, rows: Vec<[f64; N]>) -> Matrix<'_> {
    Array2::from(rows).into_pyarray(py)
}

/// Converts points to an n × 3 array for Python.
pub fn to_rows<'py>(py: Python<'py>, points: impl Iterator<Item = DVec3>) -> Matrix<'py> {
    to_matrix(py, points.map(DVec3::into).collect())
}

/// Converts n values to a NumPy array of shape (n,).
pub fn to_column<T: numpy::Element>(
    py: Python<'_>,
    values: impl IntoIterator<Item = T>,
) -> Vector<'_, T> {
    values.into_iter().collect::<Vec<T>>().into_pyarray(py)
}

/// Returns the corners of a box as a NumPy array `[[min], [max]]`, metres.
pub fn corners<'py>(py: Python<'py>, bounds: &Aabb) -> Matrix<'py> {
    to_rows(py, [bounds.min, bounds.max].into_iter())
}
