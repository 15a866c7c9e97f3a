//! The equations of the variables between their bounds, kept solved as variables join and leave.
//!
//! `(K + δ) Δ + μ = f` on the free variables, with `Σ Δ = 0`, by the factors `L D Lᵀ` of `K + δ`: those of a variable more are a
//! row of substitution, those of one fewer a change of rank one [Gill, Golub, Murray, Saunders 1974]. δ keeps apart rows that
//! depend on each other to within the rounding of the kernel values; whoever steps in turns is not misled by it, since f says
//! what is left.

use crate::gram::matrix::Gram;
use crate::linalg::factors::{LANES, Piece, add_product, eliminate, substitute, substitute_back};
use crate::linalg::scalar::Scalar;

/// δ as a share of the largest kernel value of a row with itself: above the rounding of kernel values in f32.
const RIDGE: f64 = 1e-5;
/// Variables that may join before the factors are made anew.
const JOINING: usize = 64;

/// The factors of the free variables' kernel values.
#[derive(Default)]
pub(crate) struct FreeFactor {
    /// Which variable has which place; `None` where one has left.
    places: Vec<Option<usize>>,
    /// Pieces of a row, for as many places as there is room for.
    width: usize,
    /// `D Lᵀ`, a row a place: 0 up to and on the diagonal, beyond the last place, and where a variable has left.
    rows: Vec<Piece>,
    /// 1 over D; 0 where a variable has left.
    inverse: Vec<f64>,
    ridge: f64,
}

impl FreeFactor {
    /// Of these variables, but those whose rows depend on those before.
    pub fn new<T: Scalar, G: Gram<T>>(gram: &mut G, free: &[usize]) -> Self {
        let width = (free.len() + JOINING).div_ceil(LANES);
        // Room for all that may join, so that rows stay where they are.
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
            let (row, _) = gram.rows(free[at], free[at]);
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

    /// δ.
    pub fn ridge(&self) -> f64 {
        self.ridge
    }

    /// The free variables, each with its place before it.
    pub fn variables(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let places = self.places.iter().enumerate();
        places.filter_map(|(place, variable)| Some((place, (*variable)?)))
    }

    /// The variable at a place.
    pub fn variable(&self, place: usize) -> usize {
        self.places[place].expect("a place that is asked for is taken")
    }

    /// The values of the free variables among all, by place; 0 where none is.
    pub fn values(&self, all: &[f64]) -> Vec<f64> {
        let places = self.places.iter();
        places.map(|at| at.map_or(0.0, |at| all[at])).collect()
    }

    /// How far each free variable is to move, by place, and what f is on all of them then, given what it is now; `None` where
    /// there is none.
    pub fn solve(&self, f: &[f64]) -> Option<(Vec<f64>, f64)> {
        let n_free = self.variables().count();
        // About their mean: products with 1 are then small.
        let mean = f.iter().sum::<f64>() / n_free as f64;
        let mut sides = vec![[[0.0; LANES]; 2]; self.places.len().div_ceil(LANES)];
        for (place, _) in self.variables() {
            let [of_f, of_one] = &mut sides[place / LANES];
            (of_f[place % LANES], of_one[place % LANES]) = (f[place] - mean, 1.0);
        }
        substitute(&self.rows, self.width, &self.inverse, &mut sides);
        // Sums of the solutions for f and for 1, which are their products with 1.
        let mut sums = [0.0; 2];
        for (at, inverse) in self.inverse.iter().enumerate() {
            let [of_f, of_one] = sides[at / LANES].each_ref().map(|side| side[at % LANES]);
            sums = [
                sums[0] + of_f * of_one * inverse,
                sums[1] + of_one * of_one * inverse,
            ];
        }
        let level = sums[0] / sums[1];
        let difference = |[of_f, of_one]: [Piece; 2]| {
            let mut side = of_f;
            let both = side.iter_mut().zip(of_one);
            both.for_each(|(of_f, of_one)| *of_f -= level * of_one);
            side
        };
        let mut side: Vec<Piece> = sides.into_iter().map(difference).collect();
        let steps = side.as_flattened_mut();
        substitute_back(&self.rows, self.width, &self.inverse, steps);
        let steps = steps[..self.places.len()].to_vec();
        let is_solved = n_free > 0 && steps.iter().all(|step| step.is_finite());
        is_solved.then_some((steps, mean + level))
    }

    /// Takes in a variable that becomes free; whether there was room.
    pub fn join<T: Scalar, G: Gram<T>>(&mut self, gram: &mut G, variable: usize) -> bool {
        let n = self.places.len();
        if n == self.width * LANES {
            return false;
        }
        let mut column = vec![[[0.0; LANES]]; n.div_ceil(LANES)];
        let (row, diagonal) = gram.row_and_diagonal(variable);
        let all = column.as_flattened_mut().as_flattened_mut();
        for (to, place) in all.iter_mut().zip(&self.places) {
            *to = place.map_or(0.0, |other| row[other].wide());
        }
        let mut pivot = diagonal[variable].wide() + self.ridge;
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

    /// Leaves out the variable at a place.
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
    use crate::gram::matrix::Dense;
    use ndarray::Array2;

    const N: usize = 120;

    /// Kernel values of rows of m features with no pattern.
    fn kernel(m: usize) -> Array2<f64> {
        let feature = |(i, j): (usize, usize)| (((i * m + j) as f64).sin() * 1e4).fract();
        let rows = Array2::from_shape_fn((N, m), feature);
        rows.dot(&rows.t())
    }

    /// What is solved for is `(K + δ) Δ + μ = f`, and `Σ Δ = 0`.
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
        let mut gram = Dense::<f64>::default();
        gram.of_whole(kernel.view());
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
        let mut gram = Dense::<f64>::default();
        gram.of_whole(kernel.view());
        let all: Vec<usize> = (0..N).collect();
        let mut factor = FreeFactor::new(&mut gram, &all);
        // Five, and few that δ keeps apart.
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
        let mut gram = Dense::<f64>::default();
        gram.of_whole(kernel.view());
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
