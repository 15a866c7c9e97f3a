//! Features in single or double precision (`f32`, `f64`).

use std::borrow::Cow;

use linfa::DatasetBase;
use ndarray::{Array1, Array2, ArrayBase, CowArray, Data, Ix2};

use crate::dataset::Dataset;

/// Floating-point type of features: `f32` or `f64`. Models are trained and evaluated in `f64`.
pub trait Precision: linfa::Float {
    /// Returns the data set in `f64`; `f32` features are converted, `f64` features are borrowed.
    fn double(data: &DatasetBase<Array2<Self>, Array1<usize>>) -> Cow<'_, Dataset>;

    /// Returns the features (n_rows × m) in `f64`: `f32` features are converted, and `f64` features are borrowed.
    fn double_features<D: Data<Elem = Self>>(
        features: &ArrayBase<D, Ix2>,
    ) -> CowArray<'_, f64, Ix2>;
}

impl Precision for f64 {
    fn double(data: &Dataset) -> Cow<'_, Dataset> {
        Cow::Borrowed(data)
    }

    fn double_features<D: Data<Elem = Self>>(
        features: &ArrayBase<D, Ix2>,
    ) -> CowArray<'_, f64, Ix2> {
        features.view().into()
    }
}

impl Precision for f32 {
    fn double(data: &DatasetBase<Array2<Self>, Array1<usize>>) -> Cow<'_, Dataset> {
        let features = data.records.mapv(f64::from);
        Cow::Owned(DatasetBase::new(features, data.targets.clone()))
    }

    fn double_features<D: Data<Elem = Self>>(
        features: &ArrayBase<D, Ix2>,
    ) -> CowArray<'_, f64, Ix2> {
        features.mapv(f64::from).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::svm_params::SvmParams;
    use linfa::traits::{Fit, Predict};

    #[test]
    fn single_precision_gives_the_model_of_the_same_numbers_in_double_precision() {
        let single = Array2::from_shape_fn((60, 3), |(row, column)| {
            (row % 3) as f32 + 0.6 * ((row * 5 + column * 7) as f32).sin()
        });
        let labels = Array1::from_iter((0..60).map(|row| row % 3));
        let double = DatasetBase::new(single.mapv(f64::from), labels.clone());
        let single = DatasetBase::new(single, labels);
        let params = SvmParams::default();
        let (a, b) = (params.fit(&single).unwrap(), params.fit(&double).unwrap());
        assert_eq!(a.problems(), b.problems());
        assert_eq!(a.predict(&single.records), b.predict(&double.records));
    }
}
