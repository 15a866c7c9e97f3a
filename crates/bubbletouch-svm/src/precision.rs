//! Features in single or double precision (`f32`, `f64`).

use ndarray::{ArrayBase, CowArray, Data, Ix2};

/// Floating-point type of features: `f32` or `f64`. Features of both types are read as `f64`; the precision of kernel values depends on the parameters and not on
/// this type (see the table of solvers on the [front page](crate)).
pub trait Precision: linfa::Float {
    /// Returns the features (n_rows × m) in `f64`: `f32` features are converted, and `f64` features are borrowed.
    fn double_features<D: Data<Elem = Self>>(
        features: &ArrayBase<D, Ix2>,
    ) -> CowArray<'_, f64, Ix2>;
}

impl Precision for f64 {
    fn double_features<D: Data<Elem = Self>>(
        features: &ArrayBase<D, Ix2>,
    ) -> CowArray<'_, f64, Ix2> {
        features.view().into()
    }
}

impl Precision for f32 {
    fn double_features<D: Data<Elem = Self>>(
        features: &ArrayBase<D, Ix2>,
    ) -> CowArray<'_, f64, Ix2> {
        features.mapv(f64::from).into()
    }
}

#[cfg(test)]
mod tests {
    use crate::svm_params::SvmParams;
    use linfa::DatasetBase;
    use linfa::traits::{Fit, Predict};
    use ndarray::{Array1, Array2};

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
