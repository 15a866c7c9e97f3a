//! The rows that pairs of classes are first solved on, [near their margins](crate::screening::near_margin).
//!
//! They are found where it costs little: in the few dimensions that some of the rows span, by a few
//! rounds of the same, to a rough tolerance. Those begin with the rows nearest to the other class along the line between
//! the means. Of 6,000 touches of 43 objects in 1,024 features, 66 % of the rows that support a pair are among the 32 of
//! either class that are nearest along that line, 84 % among the 24 that are nearest to the margin in 64 dimensions.

use std::ops::Range;

use ndarray::{Array2, Axis};

use crate::gram::sorted::Sorted;
use crate::gram::sorted::pairs;
use crate::linalg::few_dimensions::spanned;
use crate::screening::block_sizes::{CLASSES_AT_ONCE, FEW_DIMENSIONS, OTHERS_AT_ONCE};
use crate::screening::margin_rows::{Ranked, Sides, nearest};
use crate::screening::near_margin::{Classes, NearMargin};
use crate::smo::SolverScalar;

/// Rows of each class that a pair starts with in the few dimensions.
const ROWS_ALONG_MEANS: usize = 16;

/// All pairs of classes, solved in turn.
pub(crate) struct PairsNearMargin<'a, T> {
    few: Classes<'a, T>,
    all: Classes<'a, T>,
    along_means: Array2<T>,
}

impl<'a, T: SolverScalar> PairsNearMargin<'a, T> {
    /// Of these rows, and of the same in [`few_dimensions`].
    pub fn new(sorted: &'a Sorted<T>, few: &'a Sorted<T>) -> Self {
        Self {
            along_means: along_means(few),
            few: Classes::new(few),
            all: Classes::new(sorted),
        }
    }

    /// Pairs of some classes with a few others, in turn all: so few that what is known of them stays in the cache.
    pub fn blocks(&self) -> impl Iterator<Item = Vec<(usize, usize)>> {
        let n = self.all.sorted.ranges().len();
        let some = move |start, at_once| start..n.min(start + at_once);
        let own = (0..n).step_by(CLASSES_AT_ONCE);
        own.flat_map(move |start| {
            let others = (start..n).step_by(OTHERS_AT_ONCE);
            others.map(move |other| {
                to_and_fro(some(start, CLASSES_AT_ONCE), some(other, OTHERS_AT_ONCE))
            })
        })
    }

    /// Some pairs, not solved yet, on the rows that are near the margin for this C.
    pub fn near(&self, pairs: &[(usize, usize)], c: f64) -> NearMargin<'_, 'a, T> {
        let mut ranked = Ranked::new();
        let rows = pairs.iter().map(|&pair| self.near_means(pair, &mut ranked));
        let rows: Vec<Sides> = rows.collect();
        let rows = NearMargin::new(&self.few, pairs, &rows).near_margin(c);
        NearMargin::new(&self.all, pairs, &rows)
    }

    /// The rows of a pair that are nearest to the other class along the line between the means.
    fn near_means(&self, (a, b): (usize, usize), ranked: &mut Ranked) -> Sides {
        let along: [Vec<T>; 2] = [a, b].map(|own| {
            let rows = self.few.sorted.ranges()[own].clone();
            rows.map(|row| self.along_means[[row, a]] - self.along_means[[row, b]])
                .collect()
        });
        let along = along.each_ref().map(Vec::as_slice);
        nearest(along, ROWS_ALONG_MEANS, ranked)
    }
}

/// The pairs of some classes with others that come after them: with the others there and back in turn, so that the rows of the
/// last are still in the cache.
fn to_and_fro(own: Range<usize>, others: Range<usize>) -> Vec<(usize, usize)> {
    let mut all = Vec::new();
    for a in own {
        let start = all.len();
        all.extend(pairs(a..a + 1, others.clone()));
        if a % 2 == 1 {
            all[start..].reverse();
        }
    }
    all
}

/// The rows in the few dimensions that some of them span.
pub(crate) fn few_dimensions<T: SolverScalar>(sorted: &Sorted<T>) -> Sorted<T> {
    let directions = spanned(sorted.points().all().values, FEW_DIMENSIONS);
    sorted.along(directions.view())
}

/// Products of all rows with the means of the classes: n_rows × n_classes.
fn along_means<T: SolverScalar>(sorted: &Sorted<T>) -> Array2<T> {
    let mut means = Array2::zeros((sorted.ranges().len(), sorted.centre().len()));
    for (range, mut mean) in sorted.ranges().iter().zip(means.rows_mut()) {
        let n = T::of(range.len() as f64);
        mean.assign(
            &(sorted
                .points()
                .range(range.clone())
                .values
                .sum_axis(Axis(0))
                / n),
        );
    }
    sorted.points().all().values.dot(&means.t())
}
