//! One-vs-one linear SVMs solved on the rows near their margins.
//!
//! Where classes part well, a hyperplane rests on few rows, yet products of all rows with each other cost most of the
//! training when there are many features. So each pair of classes is solved on a few rows of either, those that lie
//! nearest to the other class along the line between the means; all rows are held against the hyperplane; those that
//! violate the optimality conditions join, and the pair is solved again from where it was. At the end every row satisfies
//! the conditions, so the solution is that of the whole problem. All pairs take such rounds together: a round's
//! hyperplanes meet the rows of a class in one matrix product.

use std::ops::Range;

use ndarray::linalg::general_mat_mul;
use ndarray::{Array2, Axis, s};

use crate::recognition::dual::DualSolution;
use crate::recognition::scalar::Scalar;
use crate::recognition::smo::{Dense, Smo, add_row, extremes, gather};
use crate::recognition::sorted::Sorted;

/// Rows of each class that a pair starts with.
const FIRST_ROWS: usize = 32;
/// Rows that join in a round, at least, while rows violate.
const FEWEST_JOINING: usize = 24;
/// The share of a pair's rows from which on all take part.
const MOST_SHARE: f64 = 0.6;

/// y of a pair's first class and of its second.
const SIGNS: [f64; 2] = [1.0, -1.0];

/// All pairs of classes, each with the rows it is solved on.
pub(crate) struct NearMargin<'a, T> {
    sorted: &'a Sorted<T>,
    /// Products within each class.
    within: Vec<Array2<T>>,
    pairs: Vec<Pair<T>>,
    gram: Dense<T>,
}

/// Two classes, the first of them positive.
struct Pair<T> {
    classes: [usize; 2],
    /// Of each class the rows that take part, by their number within the class, in the order in which they joined.
    rows: [Vec<usize>; 2],
    /// Products of the first's rows with the second's.
    across: Array2<T>,
    /// Coefficients of the first's rows, then of the second's.
    beta: Vec<f64>,
    /// The C that they belong to; 0 before the first.
    c: f64,
    n_iterations: u64,
}

/// What a round found for a pair.
struct Round<T> {
    pair: usize,
    solution: DualSolution,
    /// `w·x` of all rows of both classes.
    products: [Vec<T>; 2],
}

/// A row of a pair that does not take part.
struct Outside {
    /// By how much it exceeds what the optimality conditions allow; below 0: it does not.
    excess: f64,
    /// The place of its class in the pair.
    side: usize,
    /// Its number within the class.
    row: usize,
}

impl<'a, T: Scalar> NearMargin<'a, T> {
    /// All pairs of the classes, not solved yet.
    pub fn new(sorted: &'a Sorted<T>) -> Self {
        let along = along_means(sorted);
        let first = |own: usize, other: usize| {
            let scores = along.slice(s![sorted.ranges()[own].clone(), ..]);
            let scores = scores.rows().into_iter().map(|row| row[own] - row[other]);
            smallest(&scores.collect::<Vec<T>>(), FIRST_ROWS)
        };
        let mut all = Self {
            sorted,
            within: sorted.within(),
            pairs: Vec::new(),
            gram: Dense::default(),
        };
        for (a, b) in sorted.all_pairs() {
            all.pairs.push(Pair::new([a, b]));
            all.join(all.pairs.len() - 1, [first(a, b), first(b, a)]);
        }
        all
    }

    /// Bytes that the products take when all rows of all pairs take part, with the hyperplanes of a round.
    pub fn most_bytes(sorted: &Sorted<T>) -> usize {
        let sizes = || sorted.ranges().iter().map(Range::len);
        let within: usize = sizes().map(|n| n * n).sum();
        let across = (sorted.points().len().pow(2) - within) / 2;
        let largest = sizes().max().unwrap_or(0);
        let normals = sorted.all_pairs().count() * (sorted.centre().len() + 2 * largest);
        (within + across + normals) * size_of::<T>() + Dense::<T>::bytes(2 * largest)
    }

    /// Solves all pairs for this C, starting from the solutions of the last one, to a violation of the optimality conditions
    /// of at most `tolerance`. Coefficients are those of all rows of the first class, then of the second.
    pub fn solve(&mut self, c: f64, tolerance: f64) -> Vec<DualSolution> {
        let mut solved = Vec::new();
        solved.resize_with(self.pairs.len(), || None);
        let mut open: Vec<usize> = (0..self.pairs.len()).collect();
        while !open.is_empty() {
            let mut still_open = Vec::new();
            for round in self.rounds(&open, c, tolerance) {
                let outside = self.outside(&round, c, tolerance);
                if outside.iter().all(|row| row.excess <= 0.0) {
                    let pair = round.pair;
                    solved[pair] = Some(self.of_all_rows(round));
                } else {
                    let joining = self.joining(round.pair, outside);
                    still_open.push(round.pair);
                    self.join(round.pair, joining);
                }
            }
            open = still_open;
        }
        solved.into_iter().flatten().collect()
    }

    /// Solves some pairs on the rows that take part, and multiplies all their rows with the hyperplanes.
    fn rounds(&mut self, pairs: &[usize], c: f64, tolerance: f64) -> Vec<Round<T>> {
        let n_features = self.sorted.centre().len();
        let mut normals = Array2::zeros((pairs.len(), n_features));
        let mut rounds = Vec::with_capacity(pairs.len());
        // In f64, since large coefficients may all but cancel.
        let mut sums = vec![0.0; n_features];
        for (&pair, mut normal) in pairs.iter().zip(normals.rows_mut()) {
            let solution = self.solve_pair(pair, c, tolerance);
            let values = self.sorted.points().all().values;
            sums.fill(0.0);
            for (row, &beta) in self.rows_of(pair).zip(&solution.coefficients) {
                if beta != 0.0 {
                    let row = values.row(row);
                    add_row(
                        &mut sums,
                        row.to_slice().expect("points are stored row by row"),
                        beta,
                    );
                }
            }
            normal
                .iter_mut()
                .zip(&sums)
                .for_each(|(to, &sum)| *to = T::of(sum));
            let products = [Vec::new(), Vec::new()];
            rounds.push(Round {
                pair,
                solution,
                products,
            });
        }
        for (class, range) in self.sorted.ranges().iter().enumerate() {
            let side = |round: &Round<T>| {
                self.pairs[round.pair]
                    .classes
                    .iter()
                    .position(|&own| own == class)
            };
            let own: Vec<usize> = (0..rounds.len())
                .filter(|&at| side(&rounds[at]).is_some())
                .collect();
            let rows = self.sorted.points().range(range.clone()).values;
            let products = normals.select(Axis(0), &own).dot(&rows.t());
            for (&at, products) in own.iter().zip(products.rows()) {
                if let Some(side) = side(&rounds[at]) {
                    rounds[at].products[side] = products.to_vec();
                }
            }
        }
        rounds
    }

    /// The sorted rows of a pair that take part.
    fn rows_of(&self, pair: usize) -> impl Iterator<Item = usize> + '_ {
        [0, 1]
            .into_iter()
            .flat_map(move |side| self.rows_of_side(pair, side))
    }

    fn rows_of_side(&self, pair: usize, side: usize) -> impl Iterator<Item = usize> + '_ {
        let Pair { classes, rows, .. } = &self.pairs[pair];
        let start = self.sorted.ranges()[classes[side]].start;
        rows[side].iter().map(move |row| start + row)
    }

    fn solve_pair(&mut self, pair: usize, c: f64, tolerance: f64) -> DualSolution {
        let pair = &mut self.pairs[pair];
        let [first, second] = &pair.rows;
        let [within_first, within_second] = pair.classes.map(|class| &self.within[class]);
        self.gram.of_blocks(
            first.len(),
            second.len(),
            |i, row| gather(row, whole_row(within_first, first[i]), first),
            |i, row| gather(row, whole_row(within_second, second[i]), second),
            |mut across| across.assign(&pair.across),
        );
        let is_positive: Vec<bool> = (0..pair.beta.len()).map(|i| i < first.len()).collect();
        let mut smo = Smo::resume(
            &mut self.gram,
            &is_positive,
            std::mem::take(&mut pair.beta),
            pair.c,
        );
        let solution = smo.solve(c, tolerance);
        pair.beta.clone_from(&solution.coefficients);
        pair.c = c;
        pair.n_iterations += solution.n_iterations.unwrap_or(0);
        solution
    }

    /// The rows that do not take part.
    ///
    /// All rows hold within the tolerance when none of these is further than half of it beyond the middle of what the others
    /// leave open.
    fn outside(&self, round: &Round<T>, c: f64, tolerance: f64) -> Vec<Outside> {
        let pair = &self.pairs[round.pair];
        let f = |side: usize, row: usize| SIGNS[side] - round.products[side][row].wide();
        let sides = [0, 1].map(|side| pair.rows[side].iter().map(move |&row| (side, row)));
        let [first, second] = sides;
        let (own, is_positive): (Vec<f64>, Vec<bool>) = first
            .chain(second)
            .map(|(side, row)| (f(side, row), side == 0))
            .unzip();
        let (highest, lowest) = extremes(&pair.beta, &is_positive, &own, c);
        let middle = (highest + lowest) / 2.0;
        let mut outside = Vec::new();
        for side in [0, 1] {
            let mut takes_part = vec![false; round.products[side].len()];
            pair.rows[side]
                .iter()
                .for_each(|&row| takes_part[row] = true);
            let rows = (0..takes_part.len()).filter(|&row| !takes_part[row]);
            outside.extend(rows.map(|row| Outside {
                excess: SIGNS[side] * (f(side, row) - middle) - tolerance / 2.0,
                side,
                row,
            }));
        }
        outside
    }

    /// Those of the rows outside that are to join: the worst; all, once most take part.
    fn joining(&self, pair: usize, mut outside: Vec<Outside>) -> [Vec<usize>; 2] {
        let n_in = self.pairs[pair].beta.len();
        let n_violating = outside.iter().filter(|row| row.excess > 0.0).count();
        let n_joining = n_violating.min(FEWEST_JOINING.max(n_violating / 2));
        let n_all = (n_in + outside.len()) as f64;
        if (n_in + n_joining) as f64 <= MOST_SHARE * n_all {
            outside.retain(|row| row.excess > 0.0);
            outside.sort_by(|a, b| b.excess.total_cmp(&a.excess));
            outside.truncate(n_joining);
        }
        [0, 1].map(|side| {
            let own = outside.iter().filter(|outside| outside.side == side);
            own.map(|outside| outside.row).collect()
        })
    }

    /// Lets rows of both classes take part.
    fn join(&mut self, pair: usize, joining: [Vec<usize>; 2]) {
        let before = self.pairs[pair].across.dim();
        self.pairs[pair].take_in(&joining);
        let [first, second] = [0, 1].map(|side| {
            let rows: Vec<usize> = self.rows_of_side(pair, side).collect();
            self.sorted.points().rows(&rows)
        });
        let mut across = Array2::zeros((first.nrows(), second.nrows()));
        across
            .slice_mut(s![..before.0, ..before.1])
            .assign(&self.pairs[pair].across);
        let (old, new) = first.view().split_at(Axis(0), before.0);
        let (_, new_second) = second.view().split_at(Axis(0), before.1);
        let (mut above, mut below) = across.view_mut().split_at(Axis(0), before.0);
        let mut beside = above.slice_mut(s![.., before.1..]);
        general_mat_mul(T::one(), &old, &new_second.t(), T::zero(), &mut beside);
        general_mat_mul(T::one(), &new, &second.t(), T::zero(), &mut below);
        self.pairs[pair].across = across;
    }

    /// The solution in terms of all rows of both classes.
    fn of_all_rows(&mut self, round: Round<T>) -> DualSolution {
        let pair = &mut self.pairs[round.pair];
        let n_first = round.products[0].len();
        let mut coefficients = vec![0.0; n_first + round.products[1].len()];
        let places = pair.rows[0].iter().copied();
        let places = places.chain(pair.rows[1].iter().map(|row| n_first + row));
        for (place, &beta) in places.zip(&pair.beta) {
            coefficients[place] = beta;
        }
        DualSolution {
            coefficients,
            n_iterations: Some(std::mem::take(&mut pair.n_iterations)),
            ..round.solution
        }
    }
}

impl<T: Scalar> Pair<T> {
    fn new(classes: [usize; 2]) -> Self {
        Self {
            classes,
            rows: [Vec::new(), Vec::new()],
            across: Array2::zeros((0, 0)),
            beta: Vec::new(),
            c: 0.0,
            n_iterations: 0,
        }
    }

    /// Lets rows of both classes take part, with coefficients of 0.
    fn take_in(&mut self, joining: &[Vec<usize>; 2]) {
        let mut beta = self.beta.iter().copied();
        let mut grown = Vec::new();
        for (rows, joining) in self.rows.iter_mut().zip(joining) {
            grown.extend(beta.by_ref().take(rows.len()));
            grown.resize(grown.len() + joining.len(), 0.0);
            rows.extend(joining);
        }
        self.beta = grown;
    }
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

/// The positions of the n smallest values, ascending by value; of equals the first.
fn smallest<T: Scalar>(values: &[T], n: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].wide().total_cmp(&values[b].wide()));
    order.truncate(n);
    order
}

fn whole_row<T>(products: &Array2<T>, row: usize) -> &[T] {
    products
        .row(row)
        .to_slice()
        .expect("a product is stored row by row")
}
