//! The labelled measurements: linfa's data set, checked before any classifier sees it.

use linfa::DatasetBase;
use ndarray::{Array1, Array2, ArrayBase, ArrayView1, ArrayView2, Axis, Data, Ix2};

use crate::{Error, Result};

/// Labelled measurements: linfa's data set of `features` (n_rows × m) and one label per row, `0..n_classes`.
pub type Dataset = DatasetBase<Array2<f64>, Array1<usize>>;

/// A data set of features (n_rows × m) and labels (n_rows), checked.
///
/// # Errors
/// No rows, no columns, another number of labels than rows, or a NaN or infinite feature (named by row and column).
pub fn dataset(features: Array2<f64>, labels: Array1<usize>) -> Result<Dataset> {
    check_features(features.view())?;
    check_labels(features.nrows(), labels.view())?;
    Ok(DatasetBase::new(features, labels))
}

/// The rows of a data set at these indices, in this order (a copy).
///
/// # Errors
/// An index beyond the last row.
pub fn rows(data: &Dataset, indices: &[usize]) -> Result<Dataset> {
    if let Some(&row) = indices.iter().find(|&&row| row >= data.records.nrows()) {
        let last = data.records.nrows();
        return Err(Error::input(
            "rows",
            row,
            format!("an index below {last} is allowed"),
        ));
    }
    let features = data.records.select(Axis(0), indices);
    dataset(features, data.targets.select(Axis(0), indices))
}

/// Refuses empty features and any that is NaN or infinite, naming its row and column.
///
/// # Errors
/// Empty features, or a NaN or infinite one.
pub fn check_features(features: ArrayView2<f64>) -> Result<()> {
    let (n_rows, n_columns) = features.dim();
    if n_rows == 0 || n_columns == 0 {
        let given = format!("{n_rows} rows of {n_columns} values");
        return Err(Error::input(
            "features",
            given,
            "at least one row and one column are needed",
        ));
    }
    let is_bad = |row: ArrayView1<f64>| match row.as_slice() {
        Some(row) => !all_finite(row),
        None => !row.iter().all(|x| x.is_finite()),
    };
    let bad = features.rows().into_iter().position(is_bad);
    let found = bad.and_then(|row| {
        let column = features.row(row).iter().position(|x| !x.is_finite())?;
        Some((row, column))
    });
    match found {
        None => Ok(()),
        Some((row, column)) => Err(Error::input(
            format!("features, row {row}, column {column}"),
            features[[row, column]],
            "only finite numbers are allowed",
        )),
    }
}

/// Whether no value is NaN or infinite. Without an early way out, several are looked at side by side.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
pub fn all_finite(values: &[f64]) -> bool {
    /// All bits of an exponent are set in NaN and in infinities alone.
    const EXPONENT: u64 = 0x7ff << 52;
    let mut is_bad = 0;
    for value in values {
        is_bad |= u64::from(value.to_bits() & EXPONENT == EXPONENT);
    }
    is_bad == 0
}

/// Refuses labels that are not one per row.
///
/// # Errors
/// Another number of labels than rows.
pub fn check_labels(n_rows: usize, labels: ArrayView1<usize>) -> Result<()> {
    if labels.len() == n_rows {
        return Ok(());
    }
    Err(Error::input(
        "labels",
        format!("{} labels", labels.len()),
        format!("one for each of the {n_rows} rows is needed"),
    ))
}

/// Refuses features of another width than the model was trained on, and any that is NaN or infinite.
///
/// # Errors
/// Another number of columns than `width`, or a NaN or infinite feature.
pub fn check_width<D: Data<Elem = f64>>(features: &ArrayBase<D, Ix2>, width: usize) -> Result<()> {
    if features.ncols() != width {
        return Err(Error::input(
            "features",
            format!("{} columns", features.ncols()),
            format!("the {width} columns of training are needed"),
        ));
    }
    if features.nrows() == 0 {
        return Ok(());
    }
    check_features(features.view())
}

/// The distinct labels, ascending.
pub fn distinct(labels: ArrayView1<usize>) -> Vec<usize> {
    let mut classes = labels.to_vec();
    classes.sort_unstable();
    classes.dedup();
    classes
}

/// The distinct labels of data that a classifier can be trained on.
///
/// # Errors
/// Empty data, a NaN or infinite feature, another number of labels than rows, or a single class.
pub fn checked_classes(data: &Dataset) -> Result<Vec<usize>> {
    check_features(data.records.view())?;
    check_labels(data.records.nrows(), data.targets.view())?;
    let classes = distinct(data.targets.view());
    if classes.len() < 2 {
        let given = format!("the single class {}", classes[0]);
        return Err(Error::input(
            "labels",
            given,
            "at least two classes are needed",
        ));
    }
    Ok(classes)
}

/// For every row, the position of its label in `classes` (ascending, and holding every label).
pub fn positions(labels: ArrayView1<usize>, classes: &[usize]) -> Vec<usize> {
    labels
        .iter()
        .map(|&label| classes.partition_point(|&class| class < label))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn a_bad_feature_is_named_by_row_and_column() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let error = dataset(array![[0.0, 1.0], [2.0, bad]], array![0, 1]).unwrap_err();
            assert!(error.to_string().starts_with("features, row 1, column 1: "));
        }
    }

    #[test]
    fn empty_or_mismatched_data_is_refused() {
        assert!(dataset(Array2::zeros((0, 3)), Array1::zeros(0)).is_err());
        assert!(dataset(Array2::zeros((3, 0)), Array1::zeros(3)).is_err());
        assert!(dataset(Array2::zeros((3, 1)), Array1::zeros(2)).is_err());
    }

    #[test]
    fn rows_come_in_the_order_asked() {
        let data = dataset(array![[0.0], [1.0], [2.0]], array![5, 6, 7]).unwrap();
        let some = rows(&data, &[2, 0]).unwrap();
        assert_eq!(some.records, array![[2.0], [0.0]]);
        assert_eq!(some.targets, array![7, 5]);
        assert!(rows(&data, &[3]).is_err());
    }
}
