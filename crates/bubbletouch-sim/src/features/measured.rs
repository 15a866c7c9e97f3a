//! Measurement features: measurements without the effect of a constant pressure, scaled to norm 1, or both.
//!
//! **Centred.** An equal pressure on all taxels, x = a·1, has the measurements y = a·u with u = Φ1. Centring removes this
//! component from each frame: `y − u (u·y) / (u·u)` is the component of the measurements orthogonal to u. The features of a touch therefore
//! do not change if a constant is added to all taxels. Only the measurements and Φ are needed. If every
//! row of Φ has sum one (block averages, single taxels), then u = 1, and centring subtracts the mean of each frame's
//! measurements. Nothing is removed if u = 0 (scrambled Hadamard measurements without a block's mean). A
//! single measurement with u ≠ 0 becomes zero.
//!
//! Centring the frame before the measurement would give another result, y − mean(x) u. The measurements do not contain the mean of the frame. The two results have
//! equal invariance.
//!
//! **Unit norm.** All F·m values of a touch are divided by their Euclidean norm, so features do not depend on the stiffness of the
//! skin. Ratios between the frames of a touch are preserved. A touch of zeros stays zero.

use super::Features;
use ndarray::{ArrayView1, ArrayViewMut1, ArrayViewMut2};

/// Largest rounding error, in double precision, of a measurement of a frame of ones whose exact value is 0. Smaller measurements of this frame count as 0.
/// (Rows of the projection have norms of about 1, and at most 2²⁴ taxels.)
const ROUNDING: f64 = 1e-12;

impl Features {
    /// Converts measurements of touches, shape (n_touches, number of frames × m), to features in place. `of_ones` are the m measurements of a frame of ones.
    /// Image features leave the values unchanged.
    ///
    /// # Panics
    /// If a row does not consist of whole frames.
    pub fn apply(self, mut rows: ArrayViewMut2<f64>, of_ones: ArrayView1<f64>) {
        let m = of_ones.len();
        assert!(m > 0 && rows.ncols().is_multiple_of(m), "whole frames");
        let felt = of_ones.mapv(|u| if u.abs() <= ROUNDING { 0.0 } else { u });
        let square = felt.dot(&felt);
        for mut row in rows.outer_iter_mut() {
            if self.is_centred() && square > 0.0 {
                for mut frame in row.exact_chunks_mut(m) {
                    let share = felt.dot(&frame) / square;
                    frame.scaled_add(-share, &felt);
                }
            }
            if self.is_unit_norm() {
                scale_to_one(row);
            }
        }
    }

    fn is_centred(self) -> bool {
        matches!(self, Self::Centred | Self::CentredUnitNorm)
    }

    fn is_unit_norm(self) -> bool {
        matches!(self, Self::UnitNorm | Self::CentredUnitNorm)
    }
}

/// Divides a row by its norm. The row is first scaled by its largest value, so that squares neither overflow nor underflow.
fn scale_to_one(mut row: ArrayViewMut1<f64>) {
    let largest = row.iter().fold(0.0_f64, |largest, v| largest.max(v.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return;
    }
    row /= largest;
    let norm = row.dot(&row).sqrt();
    row /= norm;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use crate::sensing::{Ensemble, Projection};
    use crate::world::ImageShape;
    use ndarray::{Array1, Array2, Axis, array, concatenate};
    use rand::Rng;

    const GRID: ImageShape = ImageShape { ny: 8, nx: 8 };
    const M: usize = 16;

    /// Returns twelve irregular test frames of 8 × 8 taxels.
    fn frames() -> Array2<f64> {
        let mut rng = Seed::new(3).named("frames").rng();
        Array2::from_shape_fn((12, 64), |_| 1e-3 * rng.r#gen::<f64>())
    }

    /// Returns a projection, and its measurements of a frame of ones.
    fn projection(ensemble: Ensemble) -> (Projection, Array1<f64>) {
        let projection = Projection::new(ensemble, GRID, M, &Seed::new(5)).unwrap();
        let of_ones = projection.measure(Array2::ones((1, 64)).view());
        (projection, of_ones.row(0).to_owned())
    }

    fn features(kind: Features, ensemble: Ensemble, frames: &Array2<f64>) -> Array2<f64> {
        let (projection, of_ones) = projection(ensemble);
        let mut rows = projection.measure(frames.view());
        kind.apply(rows.view_mut(), of_ones.view());
        rows
    }

    fn largest_difference(a: &Array2<f64>, b: &Array2<f64>) -> f64 {
        (a - b).iter().fold(0.0_f64, |most, d| most.max(d.abs()))
    }

    const ENSEMBLES: [Ensemble; 5] = [
        Ensemble::Gaussian,
        Ensemble::Sbhe,
        Ensemble::BlockAverage,
        Ensemble::Subsample,
        Ensemble::Identity,
    ];

    #[test]
    fn raw_features_are_the_measurements_bit_by_bit() {
        let (projection, _) = projection(Ensemble::Gaussian);
        let measured = projection.measure(frames().view());
        assert_eq!(
            features(Features::Raw, Ensemble::Gaussian, &frames()),
            measured
        );
    }

    #[test]
    fn unit_norm_rows_have_norm_one_and_do_not_change_with_scale() {
        for ensemble in ENSEMBLES {
            for kind in [Features::UnitNorm, Features::CentredUnitNorm] {
                let rows = features(kind, ensemble, &frames());
                for row in rows.outer_iter() {
                    assert!((row.dot(&row).sqrt() - 1.0).abs() < 1e-14);
                }
                for scale in [1e-200, 0.1, 7.0, 1e200] {
                    let scaled = features(kind, ensemble, &(frames() * scale));
                    assert!(largest_difference(&rows, &scaled) < 1e-12, "{scale}");
                }
            }
        }
    }

    #[test]
    fn a_touch_of_nothing_stays_nothing_and_a_response_that_is_only_rounding_is_none() {
        let mut rows = array![[0.0, 0.0, 0.0], [1.0, 2.0, 3.0]];
        Features::CentredUnitNorm.apply(rows.view_mut(), array![1.0, 1.0, 1.0].view());
        let half = 0.5_f64.sqrt();
        let expected = array![[0.0, 0.0, 0.0], [-half, 0.0, half]];
        assert!(largest_difference(&rows, &expected) < 1e-15);
        let mut rows = array![[1.0, 2.0]];
        Features::Centred.apply(rows.view_mut(), array![3e-16, -1e-17].view());
        assert_eq!(rows, array![[1.0, 2.0]]);
    }

    #[test]
    fn a_constant_on_all_taxels_does_not_change_centred_features() {
        for ensemble in ENSEMBLES {
            let (_, of_ones) = projection(ensemble);
            let rows = features(Features::Centred, ensemble, &frames());
            let raised = features(Features::Centred, ensemble, &(frames() + 4e-3));
            assert!(largest_difference(&rows, &raised) < 1e-15, "{ensemble:?}");
            // The operation is a projection, so a second application changes nothing, and its effect is nonzero.
            let mut twice = rows.clone();
            Features::Centred.apply(twice.view_mut(), of_ones.view());
            assert!(largest_difference(&rows, &twice) < 1e-15, "{ensemble:?}");
            let raw = features(Features::Raw, ensemble, &(frames() + 4e-3));
            let moved = largest_difference(&rows, &raw) > 1e-4;
            let feels = of_ones.iter().any(|u| u.abs() > ROUNDING);
            assert_eq!(moved, feels, "{ensemble:?}");
        }
        // Rows of these ensembles sum to one.
        for ensemble in &ENSEMBLES[2..] {
            let measured = features(Features::Raw, *ensemble, &frames());
            let means = measured.mean_axis(Axis(1)).unwrap().insert_axis(Axis(1));
            let centred = features(Features::Centred, *ensemble, &frames());
            assert!(largest_difference(&centred, &(measured - means)) < 1e-15);
        }
    }

    #[test]
    fn frames_are_centred_each_and_scaled_together() {
        let (projection, u) = projection(Ensemble::Gaussian);
        let one = projection.measure(frames().view());
        let two = projection.measure((frames() * 3.0).view());
        let mut both = concatenate![Axis(1), one, two];
        Features::Centred.apply(both.view_mut(), u.view());
        let alone = features(Features::Centred, Ensemble::Gaussian, &frames());
        let first = both.slice(ndarray::s![.., ..M]).to_owned();
        assert!(largest_difference(&first, &alone) < 1e-15);
        let ratio = &both.slice(ndarray::s![.., M..]) / &alone;
        Features::UnitNorm.apply(both.view_mut(), u.view());
        let kept = &both.slice(ndarray::s![.., M..]) / &both.slice(ndarray::s![.., ..M]);
        assert!(largest_difference(&ratio, &kept) < 1e-9);
    }
}
