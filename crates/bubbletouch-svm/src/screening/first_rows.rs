//! Selection of the first rows on which screening (`near_margin`) trains each pair of classes.
//!
//! The rows are selected in a low-dimensional subspace spanned by some of the rows. The pairs are solved there by a few rounds of screening with a rough
//! tolerance. The first round starts with the rows that are nearest to the other class along the line between the class means.
//!
//! The 32 nearest rows of each class along this line contain 66 % of a pair's support vectors (6,000 touches of 43 objects, 1,024 features). The 24 rows
//! nearest to the margin in 64 dimensions contain 84 %.

use ndarray::{Array2, Axis};

use crate::gram::sorted::Sorted;
use crate::gram::sorted::pairs;
use crate::linalg::few_dimensions::spanned;
use crate::screening::block_sizes::{CLASSES_AT_ONCE, FEW_DIMENSIONS, OTHERS_AT_ONCE};
use crate::screening::margin_rows::{Ranked, Sides, nearest};
use crate::screening::near_margin::{Classes, NearMargin};
use crate::smo::SolverScalar;

/// Number of rows per class in the first solution in the low-dimensional subspace.
const ROWS_ALONG_MEANS: usize = 16;

/// Selection of the training rows near the decision boundary of each pair of classes, block by block.
pub(crate) struct PairsNearMargin<'a, T> {
    few: Classes<'a, T>,
    all: Classes<'a, T>,
    along_means: Array2<T>,
}

impl<'a, T: SolverScalar> PairsNearMargin<'a, T> {
    /// Creates the selection of rows near the class boundaries; `few` contains the rows projected to a subspace by [`few_dimensions`].
    pub fn new(sorted: &'a Sorted<T>, few: &'a Sorted<T>) -> Self {
        Self {
            along_means: along_means(few),
            few: Classes::new(few),
            all: Classes::new(sorted),
        }
    }

    /// Returns all pairs of classes in blocks whose data fit into the processor's cache.
    pub fn blocks(&self) -> impl Iterator<Item = Vec<(usize, usize)>> {
        let n = self.all.sorted.ranges.len();
        let some = move |start, at_once| start..n.min(start + at_once);
        let own = (0..n).step_by(CLASSES_AT_ONCE);
        own.flat_map(move |start| {
            let others = (start..n).step_by(OTHERS_AT_ONCE);
            others.map(move |other| {
                pairs(some(start, CLASSES_AT_ONCE), some(other, OTHERS_AT_ONCE)).collect()
            })
        })
    }

    /// Returns the unsolved problems of the given pairs of classes, with the rows that are probably near the decision boundary for this C.
    pub fn near(&self, pairs: &[(usize, usize)], c: f64) -> NearMargin<'_, 'a, T> {
        let mut ranked = Ranked::new();
        let rows = pairs.iter().map(|&pair| self.near_means(pair, &mut ranked));
        let rows: Vec<Sides> = rows.collect();
        let rows = NearMargin::new(&self.few, pairs, &rows).near_margin(c);
        NearMargin::new(&self.all, pairs, &rows)
    }

    /// Returns the rows of two classes that are nearest to the other class, measured along the line between the class means.
    fn near_means(&self, (a, b): (usize, usize), ranked: &mut Ranked) -> Sides {
        let along: [Vec<T>; 2] = [a, b].map(|own| {
            let rows = self.few.sorted.ranges[own].clone();
            rows.map(|row| self.along_means[[row, a]] - self.along_means[[row, b]])
                .collect()
        });
        let along = along.each_ref().map(Vec::as_slice);
        nearest(along, ROWS_ALONG_MEANS, ranked)
    }
}

/// Returns all rows projected to a low-dimensional subspace, which is spanned by some of the rows.
pub(crate) fn few_dimensions<T: SolverScalar>(sorted: &Sorted<T>) -> Sorted<T> {
    let directions = spanned(sorted.points.all().values, FEW_DIMENSIONS);
    sorted.along(directions.view())
}

/// Returns the inner product of each row with the mean of each class, n_rows × n_classes.
fn along_means<T: SolverScalar>(sorted: &Sorted<T>) -> Array2<T> {
    let mut means = Array2::zeros((sorted.ranges.len(), sorted.centre.len()));
    for (range, mut mean) in sorted.ranges.iter().zip(means.rows_mut()) {
        let n = T::from_f64(range.len() as f64);
        mean.assign(&(sorted.points.range(range.clone()).values.sum_axis(Axis(0)) / n));
    }
    sorted.points.all().values.dot(&means.t())
}
