//! Ensemble of the first principal components of training frames.
//!
//! Row r of Φ is the unit direction, orthogonal to earlier rows, with the largest variance of the frames about their mean. Among
//! all m × n matrices, Φ preserves the most variance of these frames. Test touches are not used. A skin with this ensemble
//! needs a matrix of m × n numbers, and training touches that it reads in full.

use super::dense::Dense;
use super::ensemble::{EnsembleAbout, TrainingFrames};
use crate::error::{Error, Result};
use crate::random::Seed;
use crate::sensing::pca::Pca;
use ndarray::Array2;

// The last digits of a component depend on the number of components computed together, so that the measurements are not nested.
pub(crate) const ABOUT: EnsembleAbout =
    EnsembleAbout::learned("principal components", |training, _, m, seed| {
        Ok(Box::new(Dense(components(training, m, seed)?)))
    });

/// Returns the first m principal components of training frames, shape (m, n_taxels).
///
/// # Errors
/// If the frames differ in fewer than m directions.
pub(crate) fn components(training: &TrainingFrames, m: usize, seed: &Seed) -> Result<Array2<f64>> {
    let frames = training.frames;
    let components = Pca::new(frames.to_owned(), m, &seed.named("principal_components")).components;
    match components.nrows() {
        found if found < m => {
            let given = format!("{m} principal components");
            let n_frames = frames.nrows();
            let allowed =
                format!("at most {found}, in which {n_frames} frames of training touches differ");
            Err(Error::input("measurements", given, allowed))
        }
        _ => Ok(components),
    }
}

#[cfg(test)]
mod tests {
    use crate::random::Seed;
    use crate::sensing::{Ensemble, Projection};
    use crate::world::ImageShape;
    use ndarray::Array2;

    /// Returns test frames that combine three patterns; the first pattern has the largest variance.
    fn frames() -> Array2<f64> {
        Array2::from_shape_fn((40, 12), |(i, j)| {
            let pattern = |k: usize| ((j * (k + 1)) as f64 * 0.7 + k as f64).sin();
            (0..3)
                .map(|k| ((i * i * (k + 2)) as f64).sin() * pattern(k) / (1 + k) as f64)
                .sum()
        })
    }

    #[test]
    fn more_of_them_than_frames_differ_in_and_none_to_learn_from_are_refused() {
        let frames = frames();
        let ensemble = Ensemble::PrincipalComponents;
        let learned = (frames.view(), &Seed::new(1));
        let error =
            Projection::learned(ensemble, ImageShape { ny: 3, nx: 4 }, 4, learned).unwrap_err();
        assert!(error.to_string().contains("at most 3"), "{error}");
        let error =
            Projection::new(ensemble, ImageShape { ny: 3, nx: 4 }, 2, &Seed::new(1)).unwrap_err();
        assert!(error.to_string().contains("learned"), "{error}");
    }
}
