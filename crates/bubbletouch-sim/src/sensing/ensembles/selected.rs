//! Ensemble of taxels that are selected on frames of training touches.
//!
//! Each measurement is the reading of one taxel. The methods are in [`Selection`]. Test touches are not used.

use super::ensemble::EnsembleAbout;
use super::principal_components::components;
use super::subsample::{Taxels, random_taxels};
use crate::linalg::pivoted_columns;
use crate::sensing::Selection;
use crate::sensing::selection::greedy_taxels;

// Principal components, and therefore the pivots, depend on the number of components computed together. The memory is that of these components.
pub(crate) const ABOUT: EnsembleAbout =
    EnsembleAbout::learned("selected taxels", |training, _, m, seed| {
        let taxels = match training.selection {
            Selection::Greedy => greedy_taxels(training, m, &seed.named("selected"))?,
            Selection::PivotedQr => pivoted_columns(components(training, m, seed)?),
            Selection::Random => random_taxels(training.frames.ncols(), m, seed),
        };
        Ok(Box::new(Taxels(taxels)))
    });

#[cfg(test)]
mod tests {
    use crate::random::Seed;
    use crate::sensing::{Ensemble, Projection, Selection, TrainingFrames};
    use crate::world::ImageShape;
    use ndarray::Array2;

    const GRID: ImageShape = ImageShape { ny: 4, nx: 5 };

    /// Returns 48 frames of three classes. Only taxels 7 and 12 depend on the class; the other taxels differ at random.
    fn training() -> (Array2<f64>, Vec<usize>) {
        let labels: Vec<usize> = (0..48).map(|frame| frame % 3).collect();
        let frames = Array2::from_shape_fn((48, 20), |(frame, taxel)| {
            let other = ((frame * 37 + taxel * 101) as f64 * 1.7).sin();
            match (taxel, labels[frame]) {
                (7, 0) | (12, 1) => 5.0 + 0.1 * other,
                (7 | 12, _) => 0.1 * other,
                _ => other,
            }
        });
        (frames, labels)
    }

    fn selected(selection: Selection, m: usize) -> Projection {
        let (frames, labels) = training();
        let training = TrainingFrames {
            labels: &labels,
            selection,
            ..TrainingFrames::from(frames.view())
        };
        Projection::learned(Ensemble::Selected, GRID, m, (training, &Seed::new(4))).unwrap()
    }

    #[test]
    fn greedy_selects_the_two_taxels_that_tell_the_classes_apart() {
        let mut taxels = selected(Selection::Greedy, 2).taxels().unwrap().to_vec();
        taxels.sort_unstable();
        assert_eq!(taxels, [7, 12]);
    }

    #[test]
    fn a_measurement_is_the_reading_of_its_taxel_and_a_random_selection_is_a_subsample() {
        let (frames, _) = training();
        for selection in Selection::ALL {
            let projection = selected(selection, 4);
            let measured = projection.measure(frames.view());
            let taxels = projection.taxels().unwrap();
            for (measurement, &taxel) in taxels.iter().enumerate() {
                assert_eq!(measured.column(measurement), frames.column(taxel));
            }
        }
        let drawn = Projection::new(Ensemble::Subsample, GRID, 4, &Seed::new(4)).unwrap();
        assert_eq!(drawn.taxels(), selected(Selection::Random, 4).taxels());
    }

    #[test]
    fn greedy_without_labels_is_refused() {
        let (frames, _) = training();
        let learned = (frames.view(), &Seed::new(4));
        let error = Projection::learned(Ensemble::Selected, GRID, 2, learned).unwrap_err();
        assert!(error.to_string().contains("without labels"), "{error}");
    }
}
