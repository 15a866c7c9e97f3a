//! Linear equations of the free variables; their factors are updated when a variable becomes free or reaches a bound.
//!
//! The equations `(K + δ) Δ + μ = f` on the free variables, with `Σ Δ = 0`, are solved by the factors `L D Lᵀ` of `K + δ`. Adding a variable adds a row by
//! substitution. Removing a variable is a rank-one change [Gill, Golub, Murray, Saunders 1974]. The ridge δ separates rows that are linearly dependent within
//! the rounding of the kernel values. Repeated steps correct the error due to δ, because f contains the remaining residual.

use crate::gram::matrix::Gram;
use crate::linalg::factors::{LANES, Lanes, add_product, eliminate, substitute, substitute_back};
use crate::linalg::scalar::Scalar;

/// Ridge δ (constant added to the diagonal), relative to the largest diagonal kernel value; larger than the rounding error of f32.
const RIDGE: f64 = 1e-5;
/// Number of variables that can be added to the factors before the next complete factorisation of the matrix.
const JOINING: usize = 64;

/// Factors of the kernel matrix of the free variables (multipliers between 0 and C).
#[derive(Default)]
pub(crate) struct FreeFactor {
    /// Variable at each position of the factors; `None` if the variable was removed from the equations.
    places: Vec<Option<usize>>,
    /// Number of blocks of values in each row; this number limits the number of variables.
    width: usize,
    /// Rows of the factor `D Lᵀ`, one per position. Entries are 0 up to the diagonal, beyond the last position, and for removed variables.
    rows: Vec<Lanes>,
    /// Inverse of the diagonal factor D, one value per position; 0 for removed variables.
    inverse: Vec<f64>,
    ridge: f64,
}

impl FreeFactor {
    /// Factorises the kernel matrix of the given variables; variables that depend linearly on earlier variables are omitted.
    pub fn new<T: Scalar>(gram: &mut Gram<T>, free: &[usize]) -> Self {
        let width = (free.len() + JOINING).div_ceil(LANES);
        // The capacity includes all variables that may be added, so that rows are not moved.
        let mut rows = Vec::with_capacity(width * LANES * width);
        rows.resize(free.len() * width, [0.0; LANES]);
        let mut factor = Self {
            places: free.iter().copied().map(Some).collect(),
            width,
            rows,
            inverse: vec![0.0; free.len()],
            ridge: 0.0,
        };
        let mut largest = f64::MIN_POSITIVE;
        for (at, to) in factor.rows.chunks_exact_mut(width).enumerate() {
            let to = to.as_flattened_mut();
            let row = gram.row(free[at]);
            for j in at..free.len() {
                to[j] = row[free[j]].wide();
            }
            largest = largest.max(to[at]);
        }
        factor.ridge = RIDGE * largest;
        eliminate(&mut factor.rows, width, &mut factor.inverse, factor.ridge);
        for (place, inverse) in factor.places.iter_mut().zip(&factor.inverse) {
            *place = place.filter(|_| *inverse != 0.0);
        }
        factor
    }

    /// Returns the ridge δ that is added to the diagonal of the kernel matrix.
    pub fn ridge(&self) -> f64 {
        self.ridge
    }

    /// Returns the free variables as pairs (position in the factors, variable).
    pub fn variables(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let places = self.places.iter().enumerate();
        places.filter_map(|(place, variable)| Some((place, (*variable)?)))
    }

    /// Returns the variable at a position of the factors.
    pub fn variable(&self, place: usize) -> usize {
        self.places[place].expect("a place that is asked for is taken")
    }

    /// Returns the values of the free variables in the order of their positions in the factors; 0 for removed variables.
    pub fn values(&self, all: &[f64]) -> Vec<f64> {
        let places = self.places.iter();
        places.map(|at| at.map_or(0.0, |at| all[at])).collect()
    }

    /// Solves the equations that make the gradient f equal on all free variables. Returns the change of each free variable, by position, and the resulting
    /// value of f. Returns `None` if there are no free variables.
    pub fn solve(&self, f: &[f64]) -> Option<(Vec<f64>, f64)> {
        let n_free = self.variables().count();
        // f is centred at its mean, so that products with 1 are small.
        let mean = f.iter().sum::<f64>() / n_free as f64;
        let mut sides = vec![[[0.0; LANES]; 2]; self.places.len().div_ceil(LANES)];
        for (place, _) in self.variables() {
            let [of_f, of_one] = &mut sides[place / LANES];
            (of_f[place % LANES], of_one[place % LANES]) = (f[place] - mean, 1.0);
        }
        substitute(&self.rows, self.width, &self.inverse, &mut sides);
        // Sums over all positions of the solutions for f and for the vector of ones.
        let mut sums = [0.0; 2];
        for (at, inverse) in self.inverse.iter().enumerate() {
            let [of_f, of_one] = sides[at / LANES].each_ref().map(|side| side[at % LANES]);
            sums = [
                sums[0] + of_f * of_one * inverse,
                sums[1] + of_one * of_one * inverse,
            ];
        }
        let level = sums[0] / sums[1];
        let difference = |[of_f, of_one]: [Lanes; 2]| {
            let mut side = of_f;
            let both = side.iter_mut().zip(of_one);
            both.for_each(|(of_f, of_one)| *of_f -= level * of_one);
            side
        };
        let mut side: Vec<Lanes> = sides.into_iter().map(difference).collect();
        let steps = side.as_flattened_mut();
        substitute_back(&self.rows, self.width, &self.inverse, steps);
        let steps = steps[..self.places.len()].to_vec();
        let is_solved = n_free > 0 && steps.iter().all(|step| step.is_finite());
        is_solved.then_some((steps, mean + level))
    }

    /// Adds a variable to the factors when it becomes free; returns `false` if the capacity is exhausted.
    pub fn join<T: Scalar>(&mut self, gram: &mut Gram<T>, variable: usize) -> bool {
        let n = self.places.len();
        if n == self.width * LANES {
            return false;
        }
        let mut column = vec![[[0.0; LANES]]; n.div_ceil(LANES)];
        let mut pivot = gram.diagonal(variable).wide() + self.ridge;
        let row = gram.row(variable);
        let all = column.as_flattened_mut().as_flattened_mut();
        for (to, place) in all.iter_mut().zip(&self.places) {
            *to = place.map_or(0.0, |other| row[other].wide());
        }
        substitute(&self.rows, self.width, &self.inverse, &mut column);
        let column = column.as_flattened().as_flattened();
        for (place, row) in self.rows.chunks_exact_mut(self.width).enumerate() {
            row.as_flattened_mut()[n] = column[place];
            pivot -= column[place] * column[place] * self.inverse[place];
        }
        self.rows.resize((n + 1) * self.width, [0.0; LANES]);
        self.inverse.push(1.0 / pivot.max(self.ridge));
        self.places.push(Some(variable));
        true
    }

    /// Removes the variable at a position of the factors.
    pub fn leave(&mut self, place: usize) {
        let (before, rest) = self.rows.split_at_mut(place * self.width);
        let (own, after) = rest.split_at_mut(self.width);
        for row in before.chunks_exact_mut(self.width) {
            row.as_flattened_mut()[place] = 0.0;
        }
        let weight = std::mem::take(&mut self.inverse[place]);
        add_product(after, own, (place + 1, weight), &mut self.inverse);
        own.fill([0.0; LANES]);
        self.places[place] = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    const N: usize = 120;

    /// Returns the kernel matrix of irregular test rows with m features.
    fn kernel(m: usize) -> Array2<f64> {
        let feature = |(i, j): (usize, usize)| (((i * m + j) as f64).sin() * 1e4).fract();
        let rows = Array2::from_shape_fn((N, m), feature);
        rows.dot(&rows.t())
    }

    /// Asserts that the solution Δ of the equations and its level μ satisfy `(K + δ) Δ + μ = f` and `Σ Δ = 0`.
    fn assert_solves(factor: &FreeFactor, kernel: &Array2<f64>) {
        let f: Vec<f64> = (0..N).map(|i| (i as f64 * 0.7).cos()).collect();
        let (steps, level) = factor.solve(&factor.values(&f)).unwrap();
        let mut sum = 0.0;
        for (place, variable) in factor.variables() {
            let others = factor.variables();
            let product: f64 = others
                .map(|(at, j)| kernel[[variable, j]] * steps[at])
                .sum();
            let left = f[variable] - level - product - factor.ridge() * steps[place];
            assert!(left.abs() < 1e-9, "{variable}: {left}");
            sum += steps[place];
        }
        assert!(sum.abs() < 1e-9, "{sum}");
        let n_free = factor.variables().count();
        let n_moving = steps.iter().filter(|step| **step != 0.0).count();
        assert_eq!(n_moving, n_free);
    }

    #[test]
    fn variables_join_and_leave() {
        let kernel = kernel(150);
        let mut gram = Gram::whole(kernel.view());
        let mut factor = FreeFactor::new(&mut gram, &(0..50).collect::<Vec<_>>());
        assert_solves(&factor, &kernel);
        for (joins, leaves) in [(50, 3), (51, 40), (52, 50), (53, 0), (54, 49), (3, 53)] {
            assert!(factor.join(&mut gram, joins));
            assert_solves(&factor, &kernel);
            let mut places = factor.variables();
            let (place, _) = places.find(|(_, variable)| *variable == leaves).unwrap();
            assert_eq!(factor.variable(place), leaves);
            drop(places);
            factor.leave(place);
            assert_solves(&factor, &kernel);
        }
        let mut free: Vec<usize> = factor.variables().map(|(_, variable)| variable).collect();
        free.sort_unstable();
        let left = [0, 3, 40, 49, 50, 53];
        let expected: Vec<usize> = (0..55).filter(|i| !left.contains(i)).chain([3]).collect();
        let mut expected = expected;
        expected.sort_unstable();
        assert_eq!(free, expected);
    }

    #[test]
    fn rows_that_depend_on_those_before_have_no_place_until_they_join() {
        let kernel = kernel(5);
        let mut gram = Gram::whole(kernel.view());
        let all: Vec<usize> = (0..N).collect();
        let mut factor = FreeFactor::new(&mut gram, &all);
        // Five variables, few of which are separated only by δ.
        let n = factor.variables().count();
        assert!((5..10).contains(&n), "{n}");
        assert_solves(&factor, &kernel);
        assert!(factor.join(&mut gram, 100));
        assert_eq!(factor.variables().count(), n + 1);
        assert_solves(&factor, &kernel);
    }

    #[test]
    fn when_there_is_no_room_none_joins() {
        let kernel = kernel(150);
        let mut gram = Gram::whole(kernel.view());
        let mut factor = FreeFactor::new(&mut gram, &[0]);
        let n_joined = (1..N).take_while(|&i| factor.join(&mut gram, i)).count();
        assert!((JOINING..N - 1).contains(&n_joined), "{n_joined}");
        assert_solves(&factor, &kernel);
        for place in 0..=n_joined {
            factor.leave(place);
        }
        assert!(factor.solve(&factor.values(&[0.0; N])).is_none());
    }
}
