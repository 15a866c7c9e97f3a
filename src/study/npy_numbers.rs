//! Numbers out of `.npy` files, whatever NumPy wrote them as.

use crate::error::{Error, Result};
use ndarray::{Array, Array1, Array2, Dimension, IxDyn};
use ndarray_npy::{ReadNpyError, ReadNpyExt, ReadableElement};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// What a file holds.
#[derive(Clone, Copy, PartialEq)]
enum Elements {
    Floats,
    Integers,
    Truths,
}

/// Reads a matrix of any type of float, integer or bool.
///
/// # Errors
/// No such file; no `.npy` file of two dimensions and one of these types.
pub fn read_matrix(path: &Path) -> Result<Array2<f64>> {
    const WHAT: &str = "n × m of float64, float32, int8 to int64, uint8 to uint32 or bool";
    Ok(read(path, WHAT)?.0)
}

/// Reads frames of any type of float, integer or bool, one after the other whatever the dimensions of the file: so many rows of so many numbers.
///
/// # Errors
/// No such file; no `.npy` file of so many numbers of one of these types.
pub fn read_frames(path: &Path, shape: (usize, usize)) -> Result<Array2<f64>> {
    const WHAT: &str = "n × rows × columns or n × F × rows × columns of float64, float32, int8 to int64, uint8 to uint32 or bool";
    let (frames, _) = read::<IxDyn>(path, WHAT)?;
    let given = format!("{} numbers", frames.len());
    let frames = frames.as_standard_layout().into_owned();
    let frames = frames.into_shape_with_order(shape);
    frames.map_err(|_| Error::input(path.display(), given, format!("a .npy file, {WHAT}")))
}

/// Reads whole numbers from zero on, one dimension of them.
///
/// # Errors
/// No such file; another type, or other dimensions; a number below zero or beyond 2⁵³, by its position.
pub fn read_whole_numbers(path: &Path) -> Result<Vec<usize>> {
    const WHAT: &str = "one dimension of int8 to int64, uint8 to uint32 or bool";
    let (numbers, elements): (Array1<f64>, _) = read(path, WHAT)?;
    if elements == Elements::Floats {
        return Err(wrong_type(path, WHAT));
    }
    // Beyond it f64 does not tell neighbours apart.
    let wrong = |number: &f64| !(0.0..=2.0_f64.powi(53)).contains(number);
    if let Some(position) = numbers.iter().position(wrong) {
        let place = format!("{}, position {position}", path.display());
        let allowed = "zero or more, up to 2^53";
        return Err(Error::input(place, numbers[position], allowed));
    }
    Ok(numbers.iter().map(|&number| number as usize).collect())
}

/// Reads a class for each row of features, below the number of rows; of two classes also false and true.
///
/// # Errors
/// No such file; another type, or other dimensions; no labels; one out of its range, by its position.
pub fn read_labels(path: &Path, n_rows: usize) -> Result<Vec<usize>> {
    const WHAT: &str = "one dimension of int8 to int64, uint8 to uint32 or bool";
    let (labels, elements) = read(path, WHAT)?;
    match elements {
        Elements::Floats => Err(wrong_type(path, WHAT)),
        // Of a single row, too.
        Elements::Truths => indices((path, "labels"), &labels, n_rows.max(2)),
        Elements::Integers => indices((path, "labels"), &labels, n_rows),
    }
}

/// Reads numbers of rows, or a mask: a bool for each row.
///
/// # Errors
/// As [`read_labels`]; a mask of another number of rows.
pub fn read_rows(path: &Path, n_rows: usize) -> Result<Vec<usize>> {
    const WHAT: &str =
        "one dimension of int8 to int64 or uint8 to uint32, or a bool for each row of features";
    let (mut rows, elements) = read(path, WHAT)?;
    match elements {
        Elements::Floats => return Err(wrong_type(path, WHAT)),
        Elements::Truths if rows.len() != n_rows => {
            let given = format!("a mask of {} rows", rows.len());
            let allowed = format!("one of {n_rows}, as there are rows of features");
            return Err(Error::input(path.display(), given, allowed));
        }
        Elements::Truths => {
            let chosen = (0..n_rows).filter(|&row| rows[row] > 0.0);
            rows = chosen.map(|row| row as f64).collect();
        }
        Elements::Integers => {}
    }
    indices((path, "rows"), &rows, n_rows)
}

/// At least one number, each from 0 to below `n_rows`.
fn indices(
    (path, what): (&Path, &str),
    numbers: &Array1<f64>,
    n_rows: usize,
) -> Result<Vec<usize>> {
    if numbers.is_empty() {
        let given = format!("no {what}");
        return Err(Error::input(path.display(), given, "at least one"));
    }
    let wrong = |&number: &f64| !(0.0..n_rows as f64).contains(&number);
    if let Some(position) = numbers.iter().position(wrong) {
        let place = format!("{}, position {position}", path.display());
        let last = n_rows.saturating_sub(1);
        let allowed = format!("0 to {last}, as there are {n_rows} rows of features");
        return Err(Error::input(place, numbers[position], allowed));
    }
    Ok(numbers.iter().map(|&number| number as usize).collect())
}

/// The numbers of a file, and what they were.
fn read<D: Dimension>(path: &Path, what: &str) -> Result<(Array<f64, D>, Elements)> {
    if let Some(exact) = read_as::<f64, D>(path, what)? {
        return Ok((exact, Elements::Floats));
    }
    if let Some(truths) = read_as::<bool, D>(path, what)? {
        return Ok((truths.mapv(f64::from), Elements::Truths));
    }
    macro_rules! first_of {
        ($($type:ty: $elements:expr),*) => {
            $(if let Some(numbers) = read_as::<$type, D>(path, what)? {
                return Ok((numbers.mapv(|number| number as f64), $elements));
            })*
        };
    }
    use Elements::{Floats, Integers as I};
    first_of!(f32: Floats, i64: I, i32: I, i16: I, i8: I, u32: I, u16: I, u8: I);
    Err(wrong_type(path, what))
}

/// An array whose elements are of this type; `None` if they are of another.
fn read_as<A: ReadableElement, D: Dimension>(
    path: &Path,
    what: &str,
) -> Result<Option<Array<A, D>>> {
    let refuse =
        |given: String| Error::input(path.display(), given, format!("a .npy file, {what}"));
    let file = File::open(path).map_err(|error| refuse(format!("cannot be read ({error})")))?;
    match Array::read_npy(BufReader::new(file)) {
        Ok(array) => Ok(Some(array)),
        Err(ReadNpyError::WrongDescriptor(_)) => Ok(None),
        Err(error) => Err(refuse(error.to_string())),
    }
}

fn wrong_type(path: &Path, what: &str) -> Error {
    let allowed = format!("a .npy file, {what}");
    Error::input(path.display(), "elements of another type", allowed)
}
