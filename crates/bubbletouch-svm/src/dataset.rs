//! Labelled measurements as a linfa data set, with validity checks.

use linfa::DatasetBase;
use linfa::dataset::Label;
use ndarray::{Array1, Array2, ArrayBase, ArrayView1, ArrayView2, Axis, Data, Ix2};

use crate::{Error, Result};

/// Labelled measurements: a linfa data set of `features` (n_rows × m) and one label in `0..n_classes` per row.
pub type Dataset = DatasetBase<Array2<f64>, Array1<usize>>;

/// Creates a checked data set from features (n_rows × m) and labels (n_rows).
///
/// # Errors
/// If there are no rows or columns, or the number of labels differs from the number of rows. If a feature is NaN or infinite (the error names row and column).
pub fn dataset(features: Array2<f64>, labels: Array1<usize>) -> Result<Dataset> {
    check_features(features.view())?;
    check_labels(features.nrows(), labels.view())?;
    Ok(DatasetBase::new(features, labels))
}

/// Returns a data set with copies of the rows at the given indices, in the given order.
///
/// # Errors
/// If an index is beyond the last row.
#[doc(hidden)]
pub fn rows(data: &Dataset, indices: &[usize]) -> Result<Dataset> {
    check_rows(data, indices)?;
    let features = data.records.select(Axis(0), indices);
    let selected = dataset(features, data.targets.select(Axis(0), indices))?;
    Ok(match data.weights() {
        Some(weights) => selected.with_weights(indices.iter().map(|&row| weights[row]).collect()),
        None => selected,
    })
}

/// Checks that a data set contains the rows at the given indices.
///
/// # Errors
/// If an index is beyond the last row.
pub(crate) fn check_rows(data: &Dataset, indices: &[usize]) -> Result<()> {
    let n_rows = data.records.nrows();
    match indices.iter().find(|&&row| row >= n_rows) {
        None => Ok(()),
        Some(row) => {
            let allowed = format!("an index below {n_rows} is allowed");
            Err(Error::input("rows", row, allowed))
        }
    }
}

/// Training rows whose classes are numbered from 0.
#[derive(Clone, Copy)]
pub(crate) struct LabelledRows<'a> {
    /// Features, shape n_rows × m.
    pub features: ArrayView2<'a, f64>,
    /// Number of the class of each row.
    pub labels: ArrayView1<'a, usize>,
    /// Weight of each row; empty if all weights are 1.
    pub weights: &'a [f32],
}

impl<'a> From<&'a Dataset> for LabelledRows<'a> {
    fn from(data: &'a Dataset) -> Self {
        Self {
            features: data.records.view(),
            labels: data.targets.view(),
            weights: data.weights().unwrap_or_default(),
        }
    }
}

impl LabelledRows<'_> {
    /// Checks that there is one label and one weight per row, and that all weights are positive.
    ///
    /// # Errors
    /// If the numbers of labels, weights and rows differ, or a weight is not above 0; the error names the row.
    pub fn check(&self) -> Result<()> {
        let n_rows = self.features.nrows();
        check_labels(n_rows, self.labels)?;
        if ![0, n_rows].contains(&self.weights.len()) {
            let given = format!("{} of {n_rows} rows", self.weights.len());
            return Err(Error::input("weights", given, "one per row is needed"));
        }
        let is_wrong = |weight: &f32| !(*weight > 0.0 && weight.is_finite());
        match self.weights.iter().position(is_wrong) {
            None => Ok(()),
            Some(row) => Err(Error::input(
                format!("weights, row {row}"),
                self.weights[row],
                "a finite number above 0 is allowed; leave rows of weight 0 out",
            )),
        }
    }
}

/// Checks that the rows have no weights, for methods that do not use them.
///
/// # Errors
/// If the data set has weights.
pub(crate) fn check_unweighted(data: &Dataset) -> Result<()> {
    match data.weights() {
        None => Ok(()),
        Some(weights) => Err(Error::input(
            "weights",
            format!("{} weights of rows", weights.len()),
            "no weights are allowed here; SvmParams::train uses them",
        )),
    }
}

/// Returns the distinct labels, ascending, and the position of each row's label among them.
pub(crate) fn numbered<L: Label>(labels: ArrayView1<L>) -> (Vec<L>, Array1<usize>) {
    let classes = distinct(labels);
    let numbers = positions(labels, &classes).into();
    (classes, numbers)
}

/// Checks that the features are not empty and all finite.
///
/// # Errors
/// If the features are empty, or one is NaN or infinite; the error names row and column.
#[doc(hidden)]
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

/// Returns the squared Euclidean norm of each row of features, shape (n_rows,).
///
/// # Errors
/// If a square overflows; the error names the row.
#[doc(hidden)]
pub fn squared_norms(features: ArrayView2<f64>) -> Result<Array1<f64>> {
    let norms = features.map_axis(Axis(1), |row| row.dot(&row));
    match norms.iter().position(|norm| !norm.is_finite()) {
        None => Ok(norms),
        Some(row) => Err(Error::input(
            format!("features, row {row}"),
            "values whose squares overflow",
            "scaled features are needed",
        )),
    }
}

/// Returns whether all values are finite. The loop has no early exit, so that it runs in vector instructions.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
#[doc(hidden)]
pub fn all_finite(values: &[f64]) -> bool {
    /// Bits of the exponent of an f64; all are 1 only in NaN and infinities.
    const EXPONENT: u64 = 0x7ff << 52;
    let mut is_bad = 0;
    for value in values {
        is_bad |= u64::from(value.to_bits() & EXPONENT == EXPONENT);
    }
    is_bad == 0
}

/// Checks that there is one label per row.
///
/// # Errors
/// If the number of labels differs from the number of rows.
#[doc(hidden)]
pub fn check_labels<L>(n_rows: usize, labels: ArrayView1<L>) -> Result<()> {
    if labels.len() == n_rows {
        return Ok(());
    }
    Err(Error::input(
        "labels",
        format!("{} labels", labels.len()),
        format!("one for each of the {n_rows} rows is needed"),
    ))
}

/// Checks that the features have as many columns as the training data and are finite.
///
/// # Errors
/// If the number of columns differs from `width`, or a feature is NaN or infinite.
#[doc(hidden)]
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

/// Returns the distinct labels, ascending.
#[doc(hidden)]
pub fn distinct<L: Label>(labels: ArrayView1<L>) -> Vec<L> {
    let mut classes = labels.to_vec();
    classes.sort_unstable();
    classes.dedup();
    classes
}

/// Returns the distinct labels, ascending, and checks that a classifier can be trained on the data.
///
/// # Errors
/// If the data are empty or have a single class, a feature is not finite, or the numbers of labels and rows differ.
#[doc(hidden)]
pub fn checked_classes(data: &Dataset) -> Result<Vec<usize>> {
    check_features(data.records.view())?;
    check_labels(data.records.nrows(), data.targets.view())?;
    let classes = distinct(data.targets.view());
    check_two_classes(&classes)?;
    Ok(classes)
}

/// Checks that a classifier has at least two classes.
///
/// # Errors
/// If there is a single class.
pub(crate) fn check_two_classes<L: std::fmt::Debug>(classes: &[L]) -> Result<()> {
    if classes.len() > 1 {
        return Ok(());
    }
    let given = format!("the single class {:?}", classes[0]);
    Err(Error::input(
        "labels",
        given,
        "at least two classes are needed",
    ))
}

/// Returns the position of each row's label in the ascending list `classes`, which contains all labels.
#[doc(hidden)]
pub fn positions<L: Label>(labels: ArrayView1<L>, classes: &[L]) -> Vec<usize> {
    let labels = labels.iter();
    labels
        .map(|label| classes.partition_point(|class| class < label))
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
