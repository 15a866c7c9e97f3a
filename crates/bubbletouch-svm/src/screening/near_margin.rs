//! One-vs-one linear SVMs, solved on the rows near their decision boundaries.
//!
//! If classes are well separated, a hyperplane depends on few rows. With many features, the products of all rows with each other dominate the training time.
//! Each pair of classes is therefore solved on a few rows of each class. The optimality conditions of all rows are then checked. Rows that violate the
//! conditions are added, and the pair is solved again from the last solution. At the end, every row satisfies the conditions, so the solution solves the whole
//! problem. The pairs of a block share rounds: one matrix product multiplies all hyperplanes of a round with the rows of a class.
//!
//! The first rows are selected in a low-dimensional subspace (`first_rows`).

use std::ops::Range;

use crate::dual::DualSolution;
use crate::gram::matrix::{Gram, GramMemory};
use crate::gram::sorted::Sorted;
use crate::linalg::products::own_products;
use crate::linalg::row_products::multiply;
use crate::screening::block_sizes::{CLASSES_AT_ONCE, FEW_DIMENSIONS, OTHERS_AT_ONCE};
use crate::screening::margin_pair::{MarginPair, PairWorkspace, Within};
use crate::screening::margin_rows::{Sides, nearest};
use crate::smo::{SolverGoal, SolverScalar};

/// Number of rounds in which rows are added to the reduced problems in the low-dimensional subspace.
const FEW_ROUNDS: usize = 2;
/// Tolerance of the solver in the low-dimensional subspace. With 0.5, the selected rows differ too much from the support vectors of the solution.
const ROUGH_TOLERANCE: f64 = 0.1;
/// Maximum number of solver iterations on rows projected to a low-dimensional subspace, where classes may not be separable.
const ROUGH_ITERATIONS: u64 = 1000;
/// Number of rows per class in the first round of screening that uses all features.
const ROWS_NEAR_MARGIN: usize = 24;

/// Rows of all classes, with the inner products between the rows of each class.
pub(crate) struct Classes<'a, T> {
    pub sorted: &'a Sorted<T>,
    /// Inner products between all rows of each class.
    within: Vec<Within<T>>,
}

impl<'a, T: SolverScalar> Classes<'a, T> {
    /// Computes the inner products between all rows of each class.
    pub fn new(sorted: &'a Sorted<T>) -> Self {
        let within = |range: &Range<usize>| {
            let own = sorted.points.range(range.clone());
            Within::new(own_products(own.values))
        };
        Self {
            sorted,
            within: sorted.ranges.iter().map(within).collect(),
        }
    }

    /// Returns the positions of the first row of two classes.
    fn starts(&self, classes: [usize; 2]) -> [usize; 2] {
        classes.map(|class| self.sorted.ranges[class].start)
    }

    /// Returns the weights of the two given classes in training.
    fn weights(&self, classes: [usize; 2]) -> [f64; 2] {
        self.starts(classes).map(|row| self.sorted.weights[row])
    }

    /// Returns the numbers of rows of the two given classes.
    fn sizes(&self, classes: [usize; 2]) -> [usize; 2] {
        classes.map(|class| self.sorted.ranges[class].len())
    }
}

/// Binary problems of several pairs of classes, each solved on active rows near the decision boundary.
pub(crate) struct NearMargin<'c, 'a, T> {
    classes: &'c Classes<'a, T>,
    pairs: Vec<MarginPair<T>>,
    memory: GramMemory<T>,
    scratch: PairWorkspace<'c, T>,
    round: Round<T>,
}

/// Result of a screening round for one pair: the hyperplane normal, and its inner products with the rows of both classes.
type Found<'f, T> = (&'f [T], [&'f [T]; 2]);

/// Results of one screening round for several pairs of classes.
#[derive(Default)]
struct Round<T> {
    /// Normals of the hyperplanes of all pairs of classes in the round.
    normals: Vec<T>,
    /// Inner products of each pair's hyperplane normal with all rows of its two classes, class by class.
    products: Vec<T>,
    /// Ranges of the two classes of each pair in `products`.
    places: Vec<[Range<usize>; 2]>,
}

impl<T> Round<T> {
    /// Returns the inner products of a pair's normal vector with all rows of its two classes; `number` is the index of the pair.
    fn products(&self, number: usize) -> [&[T]; 2] {
        let places = self.places[number].each_ref();
        places.map(|place| &self.products[place.clone()])
    }
}

impl<'c, 'a, T: SolverScalar> NearMargin<'c, 'a, T> {
    /// Creates the unsolved problems of the given pairs of classes, which start with the given active rows.
    pub fn new(classes: &'c Classes<'a, T>, pairs: &[(usize, usize)], rows: &[Sides]) -> Self {
        let pair = |&(a, b): &(usize, usize)| {
            MarginPair::new([a, b], classes.sizes([a, b]), classes.weights([a, b]))
        };
        let mut all = Self {
            classes,
            pairs: pairs.iter().map(pair).collect(),
            memory: GramMemory::default(),
            scratch: PairWorkspace::default(),
            round: Round::default(),
        };
        for (pair, rows) in rows.iter().enumerate() {
            all.join(pair, rows, None);
        }
        all
    }

    /// Returns the maximum memory of the screening, bytes, given the row range of each class. The sum contains the inner products of all pairs if all their rows are active, the hyperplanes of a
    /// round, and the projected rows.
    pub fn most_bytes(ranges: &[Range<usize>], n_features: usize) -> usize {
        let sizes = || ranges.iter().map(Range::len);
        let within: usize = sizes().map(|n| n * n).sum();
        let largest = sizes().max().unwrap_or(0);
        let n_pairs = CLASSES_AT_ONCE * OTHERS_AT_ONCE;
        // Each pair is counted in both orders.
        let across = n_pairs * 2 * largest.pow(2);
        let normals = n_pairs * (n_features + 2 * largest);
        let few = sizes().sum::<usize>() * FEW_DIMENSIONS;
        (2 * within + across + normals + few) * size_of::<T>() + Gram::<T>::bytes(2 * largest)
    }

    /// Solves the problems of all pairs for the penalty `c`, until no row violates the optimality conditions by more than `tolerance`. Returns the solution and
    /// the hyperplane normal of each pair. The coefficients belong to all rows of the first class, then of the second.
    pub fn solve(&mut self, c: f64, tolerance: f64) -> Vec<(DualSolution, Vec<T>)> {
        let goal = SolverGoal {
            c,
            tolerance,
            max_steps: u64::MAX,
        };
        self.solve_rounds(goal, usize::MAX, |pair, (normal, _), _| {
            (pair.solution(), normal.to_vec())
        })
    }

    /// Returns the rows of each pair of classes that are near the decision boundary for the penalty `c`, approximately.
    pub fn near_margin(mut self, c: f64) -> Vec<Sides> {
        let goal = SolverGoal {
            c,
            tolerance: ROUGH_TOLERANCE,
            max_steps: ROUGH_ITERATIONS,
        };
        self.solve_rounds(goal, FEW_ROUNDS, |_, (_, products), scratch| {
            nearest(products, ROWS_NEAR_MARGIN, &mut scratch.ranked)
        })
    }

    /// Solves the problems of all pairs in rounds, until the optimality conditions hold or the maximum number of rounds is reached. Returns a result for each
    /// pair, computed after its last round.
    fn solve_rounds<R>(
        &mut self,
        goal: SolverGoal,
        most_rounds: usize,
        mut settled: impl FnMut(&mut MarginPair<T>, Found<T>, &mut PairWorkspace<'c, T>) -> R,
    ) -> Vec<R> {
        let mut results = Vec::new();
        results.resize_with(self.pairs.len(), || None);
        let n_features = self.classes.sorted.centre.len();
        let mut open: Vec<usize> = (0..self.pairs.len()).collect();
        let mut n_rounds = 0;
        while !open.is_empty() {
            n_rounds += 1;
            let mut still_open = Vec::new();
            self.solve_round(&open, goal);
            for (number, &pair) in open.iter().enumerate() {
                let products = self.round.products(number);
                let joining = self.pairs[pair].joining(products, goal, &mut self.scratch);
                match joining {
                    Some(joining) if n_rounds < most_rounds => {
                        still_open.push(pair);
                        self.join(pair, &joining, Some(number));
                    }
                    _ => {
                        let normal = &self.round.normals[number * n_features..][..n_features];
                        let found = (normal, products);
                        let pair = (&mut self.pairs[pair], &mut results[pair]);
                        *pair.1 = Some(settled(pair.0, found, &mut self.scratch));
                    }
                }
            }
            open = still_open;
        }
        results.into_iter().flatten().collect()
    }

    /// Solves pairs of classes on their active rows, and computes the inner products of their hyperplane normals with all rows.
    fn solve_round(&mut self, pairs: &[usize], goal: SolverGoal) {
        let n_features = self.classes.sorted.centre.len();
        let mut round = std::mem::take(&mut self.round);
        round.normals.clear();
        let mut sums = vec![0.0; n_features];
        for &pair in pairs {
            self.pairs[pair].solve(&self.classes.within, &mut self.memory, goal);
            sums.fill(0.0);
            self.add_normal(pair, &mut sums);
            round
                .normals
                .extend(sums.iter().map(|&sum| T::from_f64(sum)));
        }
        round.places.clear();
        round.places.resize(pairs.len(), [0..0, 0..0]);
        let points = self.classes.sorted.points.in_place();
        let (mut normals, mut rows) = (Vec::new(), Vec::new());
        let mut end = 0;
        for (class, range) in self.classes.sorted.ranges.iter().enumerate() {
            normals.clear();
            let start = end;
            for (number, &pair) in pairs.iter().enumerate() {
                let classes = self.pairs[pair].classes();
                if let Some(side) = classes.iter().position(|&own| own == class) {
                    normals.push(&round.normals[number * n_features..][..n_features]);
                    round.places[number][side] = end..end + range.len();
                    end += range.len();
                }
            }
            if end > round.products.len() {
                round.products.resize(end, T::zero());
            }
            if !normals.is_empty() {
                rows.clear();
                rows.extend(range.clone().map(|row| points.row(row)));
                multiply(&normals, &rows, &mut round.products[start..end]);
            }
        }
        self.round = round;
    }

    /// Adds the hyperplane normal of a pair (its active rows multiplied by their coefficients) to `sums`.
    fn add_normal(&self, pair: usize, sums: &mut [f64]) {
        let starts = self.classes.starts(self.pairs[pair].classes());
        let rows = self.pairs[pair].weighing();
        let rows = rows.map(|(side, row, beta)| (starts[side] + row, beta));
        let points = &self.classes.sorted.points;
        points.in_place().add_weighted(sums, rows);
    }

    /// Adds rows of both classes to the reduced problem of a pair; `number` is the number of the pair in the last round.
    fn join(&mut self, pair: usize, joining: &Sides, number: Option<usize>) {
        let classes: &'c Classes<'a, T> = self.classes;
        let starts = classes.starts(self.pairs[pair].classes());
        let products = number.map_or([&[][..]; 2], |number| self.round.products(number));
        let all = (classes.sorted.points.in_place(), starts);
        self.pairs[pair].join(joining, products, all, &mut self.scratch);
    }
}
