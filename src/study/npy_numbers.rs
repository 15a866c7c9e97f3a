//! Numbers out of `.npy` files, whatever NumPy wrote them as.

use crate::error::{Error, Result};
use ndarray::{Array, Array1, Array2, Dimension};
use ndarray_npy::{ReadNpyError, ReadNpyExt, ReadableElement};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// Reads a matrix of any type of float, integer or bool.
///
/// # Errors
/// No such file; no `.npy` file of two dimensions and one of these types.
pub fn read_matrix(path: &Path) -> Result<Array2<f64>> {
    const WHAT: &str = "n × m of float64, float32, int8 to int64, uint8 to uint32 or bool";
    if let Some(exact) = read_as::<f64, _>(path, WHAT)? {
        return Ok(exact);
    }
    if let Some(single) = read_as::<f32, _>(path, WHAT)? {
        return Ok(single.mapv(f64::from));
    }
    if let Some(mask) = read_as::<bool, _>(path, WHAT)? {
        return Ok(mask.mapv(|value| f64::from(u8::from(value))));
    }
    match read_integers(path, WHAT)? {
        Some(integers) => Ok(integers.mapv(|value| value as f64)),
        None => Err(wrong_type(path, WHAT)),
    }
}

/// Reads a class for each row of features, below the number of rows; of two classes also false and true.
///
/// # Errors
/// No such file; another type, or other dimensions; no labels; one out of its range, by its position.
pub fn read_labels(path: &Path, n_rows: usize) -> Result<Vec<usize>> {
    const WHAT: &str = "one dimension of int8 to int64, uint8 to uint32 or bool";
    if let Some(labels) = read_as::<bool, _>(path, WHAT)? {
        return some(path, labels.mapv(usize::from).to_vec(), "labels");
    }
    let labels = read_indices(path, WHAT, n_rows)?;
    some(path, labels, "labels")
}

/// Reads numbers of rows, or a mask: a bool for each row.
///
/// # Errors
/// As [`read_labels`]; a mask of another number of rows.
pub fn read_rows(path: &Path, n_rows: usize) -> Result<Vec<usize>> {
    const WHAT: &str =
        "one dimension of int8 to int64 or uint8 to uint32, or a bool for each row of features";
    let Some(mask) = read_as::<bool, _>(path, WHAT)? else {
        let rows = read_indices(path, WHAT, n_rows)?;
        return some(path, rows, "rows");
    };
    let mask: Array1<bool> = mask;
    if mask.len() != n_rows {
        let given = format!("a mask of {} rows", mask.len());
        let allowed = format!("one of {n_rows}, as there are rows of features");
        return Err(Error::input(path.display(), given, allowed));
    }
    let rows = (0..n_rows).filter(|&row| mask[row]).collect();
    some(path, rows, "rows")
}

fn some(path: &Path, numbers: Vec<usize>, what: &str) -> Result<Vec<usize>> {
    match numbers.is_empty() {
        true => Err(Error::input(
            path.display(),
            format!("no {what}"),
            "at least one",
        )),
        false => Ok(numbers),
    }
}

/// Whole numbers from 0 to below `n_rows`.
fn read_indices(path: &Path, what: &str, n_rows: usize) -> Result<Vec<usize>> {
    let numbers: Option<Array1<i64>> = read_integers(path, what)?;
    let numbers = numbers.ok_or_else(|| wrong_type(path, what))?;
    let index = |(position, &number): (usize, &i64)| {
        let index = usize::try_from(number).ok().filter(|&index| index < n_rows);
        index.ok_or_else(|| {
            Error::input(
                format!("{}, position {position}", path.display()),
                number,
                format!(
                    "0 to {}, as there are {n_rows} rows of features",
                    n_rows.saturating_sub(1)
                ),
            )
        })
    };
    numbers.iter().enumerate().map(index).collect()
}

/// Integers of any type that an i64 holds; `None` if the file has others.
fn read_integers<D: Dimension>(path: &Path, what: &str) -> Result<Option<Array<i64, D>>> {
    macro_rules! first_of {
        ($($integer:ty),*) => {
            $(if let Some(integers) = read_as::<$integer, D>(path, what)? {
                return Ok(Some(integers.mapv(i64::from)));
            })*
        };
    }
    first_of!(i64, i32, i16, i8, u32, u16, u8);
    Ok(None)
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
