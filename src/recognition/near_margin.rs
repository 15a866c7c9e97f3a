//! One-vs-one linear SVMs solved on the rows near their margins.
//!
//! Where classes part well, a hyperplane rests on few rows, yet products of all rows with each other cost most of the
//! training when there are many features. So each pair of classes is solved on a few rows of either; all rows are held
//! against the hyperplane; those that violate the optimality conditions join, and the pair is solved again from where it
//! was. At the end every row satisfies the conditions, so the solution is that of the whole problem. All pairs take such
//! rounds together: a round's hyperplanes meet the rows of a class in one matrix product.
//!
//! Which rows to start with is found where it costs little: in the few dimensions that some of the rows span, by a few
//! rounds of the same, to a rough tolerance. Those begin with the rows nearest to the other class along the line between
//! the means. Of 6,000 touches of 43 objects in 1,024 features, 66 % of the rows that support a pair are among the 32 of
//! either class that are nearest along that line, 84 % among the 24 that are nearest to the margin in 64 dimensions.

use std::ops::Range;

use ndarray::{Array2, Axis};

use crate::recognition::dual::DualSolution;
use crate::recognition::few_dimensions::spanned;
use crate::recognition::margin_pair::{MarginPair, PairGoal, Sides, nearest};
use crate::recognition::packed::Packed;
use crate::recognition::scalar::Scalar;
use crate::recognition::smo::{Dense, Room};
use crate::recognition::sorted::Sorted;

/// Dimensions in which the first rows are looked for. More find them better and cost more.
const FEW_DIMENSIONS: usize = 64;
/// Rounds in the few dimensions.
const FEW_ROUNDS: usize = 2;
/// The tolerance in the few dimensions: at 0.5 the rows found are no longer those of the solution.
const ROUGH_TOLERANCE: f64 = 0.1;
/// Iterations of a solve in the few dimensions, at most: classes that all features part may overlap there.
const ROUGH_ITERATIONS: u64 = 1000;
/// Rows of each class that a pair starts with in the few dimensions.
const ROWS_ALONG_MEANS: usize = 16;
/// Rows of each class that a pair starts with in all dimensions.
const ROWS_NEAR_MARGIN: usize = 24;

/// All pairs of classes, each with the rows it is solved on.
pub(crate) struct NearMargin<'a, T> {
    sorted: &'a Sorted<T>,
    /// The rows of each class, packed.
    packed: Vec<Packed<'a, T>>,
    /// Products within each class.
    within: Vec<Array2<T>>,
    pairs: Vec<MarginPair<T>>,
    room: Room<T>,
}

/// What a round found for a pair.
struct Round<T> {
    pair: usize,
    solution: DualSolution,
    /// `w·x` of all rows of both classes.
    products: [Vec<T>; 2],
}

impl<'a, T: Scalar> NearMargin<'a, T> {
    /// All pairs of the classes, not solved yet, on the rows that are near the margin for this C.
    pub fn new(sorted: &'a Sorted<T>, c: f64) -> Self {
        let directions = spanned(sorted.points().all().values, FEW_DIMENSIONS);
        let few = sorted.along(directions.view());
        let near = NearMargin::of_rows(&few, near_means(&few)).near_margin(c);
        Self::of_rows(sorted, near)
    }

    /// All pairs of the classes, on these rows.
    fn of_rows(sorted: &'a Sorted<T>, rows: Vec<Sides>) -> Self {
        let sizes = |pair: [usize; 2]| pair.map(|class| sorted.ranges()[class].len());
        let pairs = sorted.all_pairs().map(|(a, b)| [a, b]);
        let ranges = sorted.ranges().iter();
        let packed: Vec<Packed<T>> = ranges
            .map(|range| sorted.points().range(range.clone()).packed())
            .collect();
        let mut all = Self {
            sorted,
            within: packed.iter().map(Packed::own_products).collect(),
            packed,
            pairs: pairs
                .map(|pair| MarginPair::new(pair, sizes(pair)))
                .collect(),
            room: Room::new(),
        };
        for (pair, rows) in rows.iter().enumerate() {
            all.join(pair, rows);
        }
        all
    }

    /// Bytes that the products take when all rows of all pairs take part, with the hyperplanes of a round, packed rows, and all
    /// rows in few dimensions.
    pub fn most_bytes(sorted: &Sorted<T>) -> usize {
        let sizes = || sorted.ranges().iter().map(Range::len);
        let within: usize = sizes().map(|n| n * n).sum();
        let across = (sorted.points().len().pow(2) - within) / 2;
        let largest = sizes().max().unwrap_or(0);
        let normals = sorted.all_pairs().count() * (sorted.centre().len() + 2 * largest);
        let few = sorted.points().len() * FEW_DIMENSIONS;
        let packed = |n| Packed::<T>::bytes(n, sorted.centre().len() + FEW_DIMENSIONS);
        (within + across + normals + few) * size_of::<T>()
            + sizes().map(packed).sum::<usize>()
            + Dense::<T>::bytes(2 * largest)
    }

    /// Solves all pairs for this C, starting from the solutions of the last one, to a violation of the optimality conditions
    /// of at most `tolerance`. Coefficients are those of all rows of the first class, then of the second.
    pub fn solve(&mut self, c: f64, tolerance: f64) -> Vec<DualSolution> {
        let goal = PairGoal {
            c,
            tolerance,
            most_iterations: None,
        };
        self.settle(goal, usize::MAX, |pair, round| {
            pair.of_all_rows(round.solution)
        })
    }

    /// The rows of all pairs that are near the margin for this C, roughly.
    fn near_margin(mut self, c: f64) -> Vec<Sides> {
        let goal = PairGoal {
            c,
            tolerance: ROUGH_TOLERANCE,
            most_iterations: Some(ROUGH_ITERATIONS),
        };
        self.settle(goal, FEW_ROUNDS, |_, round| {
            nearest(&round.products, ROWS_NEAR_MARGIN)
        })
    }

    /// Solves all pairs in rounds, until no row violates the optimality conditions or the rounds are over; what is made of
    /// each pair's last round.
    fn settle<R>(
        &mut self,
        goal: PairGoal,
        most_rounds: usize,
        mut settled: impl FnMut(&mut MarginPair<T>, Round<T>) -> R,
    ) -> Vec<R> {
        let mut results = Vec::new();
        results.resize_with(self.pairs.len(), || None);
        let mut open: Vec<usize> = (0..self.pairs.len()).collect();
        let mut n_rounds = 0;
        while !open.is_empty() {
            n_rounds += 1;
            let mut still_open = Vec::new();
            for round in self.rounds(&open, goal) {
                let pair = round.pair;
                let joining = self.pairs[pair].joining(&round.products, goal);
                match joining.filter(|_| n_rounds < most_rounds) {
                    Some(joining) => {
                        still_open.push(pair);
                        self.join(pair, &joining);
                    }
                    None => results[pair] = Some(settled(&mut self.pairs[pair], round)),
                }
            }
            open = still_open;
        }
        results.into_iter().flatten().collect()
    }

    /// Solves some pairs on the rows that take part, and multiplies all their rows with the hyperplanes.
    fn rounds(&mut self, pairs: &[usize], goal: PairGoal) -> Vec<Round<T>> {
        let mut normals = Array2::zeros((pairs.len(), self.sorted.centre().len()));
        let mut rounds = Vec::with_capacity(pairs.len());
        let mut sums = vec![0.0; normals.ncols()];
        for (&pair, mut normal) in pairs.iter().zip(normals.rows_mut()) {
            let solution = self.pairs[pair].solve(&self.within, &mut self.room, goal);
            sums.fill(0.0);
            self.add_normal(pair, &mut sums);
            normal
                .iter_mut()
                .zip(&sums)
                .for_each(|(to, &sum)| *to = T::of(sum));
            rounds.push(Round {
                pair,
                solution,
                products: [Vec::new(), Vec::new()],
            });
        }
        for (class, range) in self.sorted.ranges().iter().enumerate() {
            let side = |round: &Round<T>| {
                let classes = self.pairs[round.pair].classes();
                classes.iter().position(|&own| own == class)
            };
            let own: Vec<usize> = (0..rounds.len())
                .filter(|&at| side(&rounds[at]).is_some())
                .collect();
            let mut products = Array2::zeros((own.len(), range.len()));
            let own_normals = normals.select(Axis(0), &own);
            self.packed[class].multiply(own_normals.view(), products.view_mut());
            for (&at, products) in own.iter().zip(products.rows()) {
                if let Some(side) = side(&rounds[at]) {
                    rounds[at].products[side] = products.to_vec();
                }
            }
        }
        rounds
    }

    /// Adds a pair's `w = Σ β_i x_i`.
    fn add_normal(&self, pair: usize, sums: &mut [f64]) {
        let starts = self.starts(pair);
        let rows = self.pairs[pair].weighing();
        let rows = rows.map(|(side, row, beta)| (starts[side] + row, beta));
        self.sorted.points().in_place().add_weighted(sums, rows);
    }

    /// Lets rows of both classes of a pair take part.
    fn join(&mut self, pair: usize, joining: &Sides) {
        let starts = self.starts(pair);
        self.pairs[pair].join(joining, self.sorted.points().in_place(), starts);
    }

    /// Where the rows of a pair's classes begin.
    fn starts(&self, pair: usize) -> [usize; 2] {
        let classes = self.pairs[pair].classes();
        classes.map(|class| self.sorted.ranges()[class].start)
    }
}

/// The rows of all pairs that are nearest to the other class along the line between the means.
fn near_means<T: Scalar>(sorted: &Sorted<T>) -> Vec<Sides> {
    let along = along_means(sorted);
    let both = |(a, b): (usize, usize)| {
        let along_both = [a, b].map(|own| {
            let rows = sorted.ranges()[own].clone();
            rows.map(|row| along[[row, a]] - along[[row, b]]).collect()
        });
        nearest(&along_both, ROWS_ALONG_MEANS)
    };
    sorted.all_pairs().map(both).collect()
}

/// Products of all rows with the means of the classes: n_rows × n_classes.
fn along_means<T: Scalar>(sorted: &Sorted<T>) -> Array2<T> {
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
