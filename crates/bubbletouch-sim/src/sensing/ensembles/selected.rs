//! Ensemble of taxels that are selected on frames of training touches.
//!
//! Each measurement is the reading of one taxel. The methods are in [`Selection`]. Test touches are not used.

use super::ensemble::{EnsembleAbout, Operator, Source, TrainingFrames};
use super::principal_components::components;
use super::subsample::{Taxels, random_taxels};
use crate::error::Result;
use crate::random::Seed;
use crate::sensing::Selection;
use crate::sensing::selection::{greedy_taxels, pivoted_columns};

pub(crate) const ABOUT: EnsembleAbout = EnsembleAbout {
    words: "selected taxels",
    // Principal components, and therefore the pivots, depend on the number of components computed together.
    is_prefix_nested: false,
    is_whole_frame: false,
    needs_rows: false,
    // The principal components from which pivots are chosen.
    bytes: |m, n| 16.0 * n * m,
    source: Source::Learned(learn),
};

fn learn(training: &TrainingFrames, m: usize, seed: &Seed) -> Result<Box<dyn Operator>> {
    let taxels = match training.selection {
        Selection::Greedy => greedy_taxels(training, m, &seed.named("selected"))?,
        Selection::PivotedQr => pivoted_columns(components(training, m, seed)?),
        Selection::Random => random_taxels(training.frames.ncols(), m, seed),
    };
    Ok(Box::new(Taxels(taxels)))
}

#[cfg(test)]
mod tests {
    use crate::random::Seed;
    use crate::sensing::{Ensemble, Projection, Selection, TrainingFrames};
    use crate::world::ImageShape;
    use ndarray::{Array2, ArrayView2};

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

    fn selected<'a>(
        selection: Selection,
        frames: ArrayView2<'a, f64>,
        labels: &'a [usize],
    ) -> Vec<usize> {
        let training = TrainingFrames {
            labels,
            selection,
            ..TrainingFrames::from(frames)
        };
        let seed = Seed::new(4);
        let projection = Projection::learned(Ensemble::Selected, GRID, 2, (training, &seed));
        projection.unwrap().taxels().unwrap().to_vec()
    }

    #[test]
    fn greedy_selects_the_two_taxels_that_tell_the_classes_apart() {
        let (frames, labels) = training();
        let mut taxels = selected(Selection::Greedy, frames.view(), &labels);
        taxels.sort_unstable();
        assert_eq!(taxels, [7, 12]);
    }

    #[test]
    fn the_random_selection_is_the_subsample_of_the_same_seed() {
        let (frames, labels) = training();
        let drawn = Projection::new(Ensemble::Subsample, GRID, 2, &Seed::new(4)).unwrap();
        let random = selected(Selection::Random, frames.view(), &labels);
        assert_eq!(drawn.taxels().unwrap(), random);
    }

    #[test]
    fn a_measurement_is_the_reading_of_its_taxel() {
        let (frames, labels) = training();
        for selection in Selection::ALL {
            let training = TrainingFrames {
                labels: &labels,
                selection,
                ..TrainingFrames::from(frames.view())
            };
            let seed = Seed::new(4);
            let learned = Projection::learned(Ensemble::Selected, GRID, 4, (training, &seed));
            let projection = learned.unwrap();
            let measured = projection.measure(frames.view());
            let taxels = projection.taxels().unwrap();
            for (measurement, &taxel) in taxels.iter().enumerate() {
                assert_eq!(measured.column(measurement), frames.column(taxel));
            }
        }
    }

    #[test]
    fn greedy_without_labels_is_refused() {
        let (frames, _) = training();
        let learned = (frames.view(), &Seed::new(4));
        let error = Projection::learned(Ensemble::Selected, GRID, 2, learned).unwrap_err();
        assert!(error.to_string().contains("without labels"), "{error}");
    }
}
