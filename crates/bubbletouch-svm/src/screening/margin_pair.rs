//! Binary problem of two classes, solved on a subset of rows (the active rows).

use ndarray::Array2;

use crate::dual::DualSolution;
use crate::gram::matrix::{Gram, GramMemory, gather};
use crate::linalg::row_products::{Rows, multiply};
use crate::linalg::transposed::write_columns;
use crate::screening::margin_rows::{Ranked, RankedRow, SIGNS, Sides, find_below, smallest};
use crate::smo::reached::Reached;
use crate::smo::variables::extremes;
use crate::smo::{Smo, SolverGoal, SolverScalar};

/// Minimum number of rows that each round adds to the reduced problem of a pair while rows violate the optimality conditions.
const MIN_JOINING: usize = 24;
/// Maximum fraction of a pair's rows in its reduced problem; if it is exceeded, all rows of the pair are used.
const MAX_SHARE: f64 = 0.6;

/// Inner products between the rows of one class.
pub(crate) struct Within<T> {
    products: Array2<T>,
    diagonal: Vec<T>,
}

impl<T: SolverScalar> Within<T> {
    /// Creates the inner products of the rows of one class from an n × n matrix.
    pub fn new(products: Array2<T>) -> Self {
        Self {
            diagonal: products.diag().to_vec(),
            products,
        }
    }

    /// Returns the inner products of one row with all rows of its class.
    fn row(&self, row: usize) -> &[T] {
        let n = self.diagonal.len();
        &self
            .products
            .as_slice()
            .expect("a product is stored row by row")[row * n..][..n]
    }
}

/// Scratch memory that is reused by successive pairs of classes.
pub(crate) struct PairWorkspace<'r, T> {
    /// Active rows (rows in the reduced problem) of both classes.
    rows: [Vec<&'r [T]>; 2],
    /// Inner products between newly active rows of one class and active rows of the other class.
    across: Vec<T>,
    /// Rows ranked by their distance from the margin.
    pub ranked: Ranked,
    /// Numbers of the rows of one class whose inner products are below a bound.
    below: Vec<usize>,
}

impl<T> Default for PairWorkspace<'_, T> {
    fn default() -> Self {
        Self {
            rows: [Vec::new(), Vec::new()],
            across: Vec::new(),
            ranked: Ranked::new(),
            below: Vec::new(),
        }
    }
}

/// Binary problem of two classes, reduced to active rows near the decision boundary, with its solution; the first class is positive.
pub(crate) struct MarginPair<T> {
    classes: [usize; 2],
    /// Weights of the two classes in training.
    weights: [f64; 2],
    /// Active rows of both classes, in the order in which they became active.
    rows: Sides,
    /// Whether each row of the first and of the second class is active.
    takes_part: [Vec<bool>; 2],
    /// Inner products between active rows of the two classes, row by row: first × second class, and second × first class.
    across: [Vec<T>; 2],
    /// Coefficients (label times multiplier) of the active rows of the first class, then of the second class.
    beta: Vec<f64>,
    /// Approximate gradient of the dual objective for each active row: its label minus its inner product with the hyperplane normal.
    f: Vec<f64>,
    /// Penalty C of the last solution; 0 before the first solution.
    c: f64,
    n_iterations: u64,
    /// Whether the last solver run on this pair reached its tolerance.
    is_solved: bool,
}

impl<T: SolverScalar> MarginPair<T> {
    /// Creates a pair of classes with the given numbers of rows, none of which is active, and weights.
    pub fn new(classes: [usize; 2], sizes: [usize; 2], weights: [f64; 2]) -> Self {
        Self {
            classes,
            weights,
            rows: [Vec::new(), Vec::new()],
            takes_part: sizes.map(|n| vec![false; n]),
            across: [Vec::new(), Vec::new()],
            beta: Vec::new(),
            f: Vec::new(),
            c: 0.0,
            n_iterations: 0,
            is_solved: false,
        }
    }

    /// Returns the positions of the two classes of the pair.
    pub fn classes(&self) -> [usize; 2] {
        self.classes
    }

    /// Adds rows of both classes to the active rows, with coefficients of 0. The argument `products` contains the inner products of all rows with the
    /// hyperplane normal; it is empty before the first solution. The positions of the first row of each class are in `starts`.
    pub fn join<'r>(
        &mut self,
        joining: &Sides,
        products: [&[T]; 2],
        (all, starts): (Rows<'r, T>, [usize; 2]),
        scratch: &mut PairWorkspace<'r, T>,
    ) {
        let before = self.rows.each_ref().map(Vec::len);
        self.take_in(joining, products);
        let PairWorkspace { rows, across, .. } = scratch;
        for (side, to) in rows.iter_mut().enumerate() {
            to.clear();
            to.extend(
                self.rows[side]
                    .iter()
                    .map(|row| all.row(starts[side] + row)),
            );
        }
        let [first, second] = &*rows;
        // Products of new rows of the first class with all rows of the second, and of old rows of the first with new rows of the second.
        let n_new = second.len() - before[1];
        across.resize(first.len() * second.len(), T::zero());
        let (right, below) = across.split_at_mut(before[0] * n_new);
        multiply(&first[..before[0]], &second[before[1]..], right);
        let below = &mut below[..(first.len() - before[0]) * second.len()];
        multiply(&first[before[0]..], second, below);
        let old = std::mem::take(&mut self.across[0]);
        let mut to = Vec::with_capacity(first.len() * second.len());
        for row in 0..before[0] {
            to.extend_from_slice(&old[row * before[1]..][..before[1]]);
            to.extend_from_slice(&right[row * n_new..][..n_new]);
        }
        to.extend_from_slice(below);
        self.across[1].resize(to.len(), T::zero());
        let whole: Vec<&[T]> = to.chunks_exact(second.len().max(1)).collect();
        write_columns(&whole, &mut self.across[1], first.len());
        self.across[0] = to;
    }

    fn take_in(&mut self, joining: &Sides, products: [&[T]; 2]) {
        let n = self.beta.len() + joining[0].len() + joining[1].len();
        let (mut beta, mut f) = (Vec::with_capacity(n), Vec::with_capacity(n));
        let mut start = 0;
        for (side, joining) in joining.iter().enumerate() {
            let end = start + self.rows[side].len();
            beta.extend_from_slice(&self.beta[start..end]);
            f.extend_from_slice(&self.f[start..end]);
            start = end;
            for &row in joining {
                beta.push(0.0);
                let product = products[side].get(row).map_or(0.0, |value| value.wide());
                f.push(SIGNS[side] - product);
                self.takes_part[side][row] = true;
            }
            self.rows[side].extend(joining);
        }
        (self.beta, self.f) = (beta, f);
    }

    /// Solves the problem of the pair on its active rows, starting from the last solution. The argument `within` contains the inner products within each class;
    /// the Gram matrix reuses `memory`.
    pub fn solve(&mut self, within: &[Within<T>], memory: &mut GramMemory<T>, goal: SolverGoal) {
        let (beta, f) = (std::mem::take(&mut self.beta), std::mem::take(&mut self.f));
        let [first, second] = &self.rows;
        let within = self.classes.map(|class| &within[class]);
        let diagonal = |side: usize| {
            let rows = self.rows[side].iter();
            rows.map(move |&row| within[side].diagonal[row])
        };
        let write = |i: usize, to: &mut [T]| {
            let (left, right) = to.split_at_mut(first.len());
            if i < first.len() {
                gather(left, within[0].row(first[i]), first);
                right.copy_from_slice(&self.across[0][i * second.len()..][..second.len()]);
            } else {
                let i = i - first.len();
                left.copy_from_slice(&self.across[1][i * first.len()..][..first.len()]);
                gather(right, within[1].row(second[i]), second);
            }
        };
        let diagonal = diagonal(0).chain(diagonal(1));
        let mut gram = Gram::new(diagonal, write, std::mem::take(memory));
        let limits = self.limits();
        let mut smo = Smo::from_start(&mut gram, &limits, (beta, f), self.c);
        let reached = smo.reach_by_equations(goal);
        (self.beta, self.f) = smo.into_variables();
        *memory = gram.into_memory();
        self.c = goal.c;
        self.n_iterations += reached.n_iterations;
        self.is_solved = reached.is_solved;
    }

    /// Returns the limits of the coefficients of the active rows.
    fn limits(&self) -> Vec<f64> {
        let [first, second] = [0, 1].map(|side| SIGNS[side] * self.weights[side]);
        let mut limits = vec![first; self.rows[0].len()];
        limits.resize(limits.len() + self.rows[1].len(), second);
        limits
    }

    /// Returns the active rows as triples: class (0 or 1), row number within the class, and coefficient.
    pub fn weighing(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let of_side = |side: usize| self.rows[side].iter().map(move |&row| (side, row));
        let rows = of_side(0).chain(of_side(1)).zip(&self.beta);
        rows.map(|((side, row), &beta)| (side, row, beta))
    }

    /// Returns the rows to add to the active rows: those that violate the optimality conditions most, or all others if most rows are active. Returns `None` if
    /// no row violates the conditions. `products` contains the inner product of each row with the hyperplane normal.
    ///
    /// An inactive row violates the conditions if it lies more than half the tolerance beyond the middle of the interval allowed by the active rows.
    pub fn joining(
        &self,
        products: [&[T]; 2],
        goal: SolverGoal,
        scratch: &mut PairWorkspace<T>,
    ) -> Option<Sides> {
        let (highest, lowest) = extremes(&self.beta, &self.limits(), &self.f, goal.c);
        let middle = (highest + lowest) / 2.0;
        // Rows that violate the conditions, ascending by violation.
        let violating = &mut scratch.ranked;
        violating.clear();
        for (number, products) in products.into_iter().enumerate() {
            // f exceeds the middle by more than half the tolerance if w·x, times its sign, is below this bound.
            let bound =
                T::from_f64(SIGNS[number] * (SIGNS[number] - middle) - goal.tolerance / 2.0);
            let sign = T::from_f64(SIGNS[number]);
            find_below(products, sign, bound, &mut scratch.below);
            for &row in &scratch.below {
                if !self.takes_part[number][row] {
                    let beyond = (sign * products[row] - bound).wide();
                    violating.push(RankedRow::new(beyond, (number, row)));
                }
            }
        }
        if violating.is_empty() {
            return None;
        }
        let n_joining = violating.len().min(MIN_JOINING.max(violating.len() / 2));
        let n_all = (products[0].len() + products[1].len()) as f64;
        if (self.beta.len() + n_joining) as f64 > MAX_SHARE * n_all {
            return Some([0, 1].map(|side| self.outside(side).collect()));
        }
        let mut joining = [0, 1].map(|_| Vec::with_capacity(n_joining));
        for row in smallest(violating, n_joining) {
            let (side, row) = row.place();
            joining[side].push(row);
        }
        Some(joining)
    }

    /// Returns the numbers of the inactive rows of one class (0 or 1).
    fn outside(&self, side: usize) -> impl Iterator<Item = usize> + '_ {
        let takes_part = &self.takes_part[side];
        (0..takes_part.len()).filter(|&row| !takes_part[row])
    }

    /// Returns the last solution of the pair of classes, with coefficients of all rows (0 for inactive rows).
    pub fn solution(&mut self) -> DualSolution {
        let n_first = self.takes_part[0].len();
        let mut coefficients = vec![0.0; n_first + self.takes_part[1].len()];
        for (side, row, beta) in self.weighing() {
            coefficients[side * n_first + row] = beta;
        }
        let reached = Reached {
            is_solved: self.is_solved,
            n_iterations: std::mem::take(&mut self.n_iterations),
        };
        DualSolution {
            coefficients,
            ..reached.solution(&self.beta, &self.limits(), &self.f, self.c)
        }
    }
}
