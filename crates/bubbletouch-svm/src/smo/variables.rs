//! Variables of the dual problem, and the update of one pair of variables.

use crate::linalg::lanes::padded;
use crate::linalg::scalar::Scalar;

/// Number of variables processed in parallel.
const LANES: usize = 8;
/// Number of variables whose gradients are compared in parallel in the search for the largest and smallest gradient. With 64, the compiler generates a
/// vectorised loop; with 8, it unrolls the loop and inserts many shuffles.
const EXTREMES_LANES: usize = 64;

/// Returns the mark of a variable: 0 if the variable can move, otherwise −∞.
#[inline(always)]
fn mark<T: Scalar>(can_move: bool) -> T {
    if can_move {
        T::zero()
    } else {
        T::neg_infinity()
    }
}

/// Sets the marks of every variable. The mark `up` is 0 if the coefficient β can increase, and `low` is 0 if it can decrease; otherwise they are −∞.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
fn mark_all<T: Scalar>(beta: &[f64], limits: &[f64], c: f64, up: &mut [T], low: &mut [T]) {
    let n = beta.len();
    let (limits, up, low) = (&limits[..n], &mut up[..n], &mut low[..n]);
    for i in 0..n {
        let (lowest, highest) = bounds(limits[i], c);
        up[i] = mark(beta[i] < highest);
        low[i] = mark(beta[i] > lowest);
    }
}

/// Returns the lower and upper bound of a row's coefficient, given the penalty C and the row's limit: its label times its weight in training. The bounds are
/// (0, C) for the limit 1, (−C, 0) for −1, and (0, 0) for an excluded row (limit 0).
#[inline(always)]
pub(crate) fn bounds(limit: f64, c: f64) -> (f64, f64) {
    (c * limit.min(0.0), c * limit.max(0.0))
}

/// Returns the label of each row, given the limits of the coefficients: 1, −1, or 0 for an excluded row.
pub(crate) fn signs(limits: &[f64]) -> Vec<f64> {
    let sign = |limit: &f64| match *limit == 0.0 {
        true => 0.0,
        false => limit.signum(),
    };
    limits.iter().map(sign).collect()
}

/// Returns whether every coefficient is within its bounds for the penalty `c`.
pub(crate) fn are_within(beta: &[f64], limits: &[f64], c: f64) -> bool {
    beta.iter().zip(limits).all(|(beta, limit)| {
        let (lowest, highest) = bounds(*limit, c);
        (lowest..=highest).contains(beta)
    })
}

/// Variables of a binary problem during the pairwise steps of the solver. Slices are padded to whole lanes with variables that cannot move.
#[derive(Clone, Debug)]
pub(crate) struct Variables<T> {
    /// Coefficient of each row: its label times its multiplier.
    pub beta: Vec<f64>,
    /// Limit of each coefficient: its label times its weight in training; see [`bounds`].
    limits: Vec<f64>,
    c: f64,
    /// Gradient of the dual objective along each coefficient: `y − Kβ`, where y are the labels and K is the Gram matrix.
    pub f: Vec<T>,
    /// Mark of each variable: 0 if its coefficient can increase, otherwise −∞.
    pub up: Vec<T>,
    /// Mark of each variable: 0 if its coefficient can decrease, otherwise −∞.
    pub low: Vec<T>,
    /// Temporary values for the selection of the variable to decrease.
    pub gains: Vec<T>,
}

impl<T: Scalar> Variables<T> {
    pub fn new(beta: &[f64], limits: &[f64], f: &[f64], c: f64) -> Self {
        let n = beta.len();
        let mut own_f = Vec::with_capacity(padded(n));
        own_f.extend(f.iter().map(|&f| T::from_f64(f)));
        own_f.resize(padded(n), T::zero());
        let mut variables = Self {
            beta: beta.to_vec(),
            limits: limits.to_vec(),
            c,
            f: own_f,
            up: vec![T::neg_infinity(); padded(n)],
            low: vec![T::neg_infinity(); padded(n)],
            gains: vec![T::zero(); padded(n)],
        };
        mark_all(beta, limits, c, &mut variables.up, &mut variables.low);
        variables
    }

    /// Returns a copy that contains only the variables at the given indices.
    pub fn select(&self, indices: &[usize]) -> Self {
        let beta: Vec<f64> = indices.iter().map(|&i| self.beta[i]).collect();
        let limits: Vec<f64> = indices.iter().map(|&i| self.limits[i]).collect();
        let f: Vec<f64> = indices.iter().map(|&i| self.f[i].wide()).collect();
        Self::new(&beta, &limits, &f, self.c)
    }

    /// Updates the marks of variable i; writes only changed marks, because vector loads after scalar stores are slow.
    #[inline(always)]
    fn mark(&mut self, i: usize) {
        let (lowest, highest) = bounds(self.limits[i], self.c);
        let (up, low) = (mark(self.beta[i] < highest), mark(self.beta[i] > lowest));
        if self.up[i] != up {
            self.up[i] = up;
        }
        if self.low[i] != low {
            self.low[i] = low;
        }
    }

    /// Increases coefficient i and decreases coefficient j by an equal amount, up to the optimum or to the first bound. Returns the amount.
    #[inline(always)]
    pub fn step(&mut self, i: usize, j: usize, curvature: f64) -> f64 {
        let wanted = (self.f[i].wide() - self.f[j].wide()) / curvature;
        let (lowest, highest) = (
            bounds(self.limits[j], self.c).0,
            bounds(self.limits[i], self.c).1,
        );
        let (room_i, room_j) = (highest - self.beta[i], self.beta[j] - lowest);
        let step = wanted.min(room_i).min(room_j);
        // β is set exactly to a reached bound, without rounding error.
        self.beta[i] = if step == room_i {
            highest
        } else {
            self.beta[i] + step
        };
        self.beta[j] = if step == room_j {
            lowest
        } else {
            self.beta[j] - step
        };
        self.mark(i);
        self.mark(j);
        step
    }

    /// Returns the variables that can still move; shrinking omits the others. The largest gradient of variables that can increase is `highest`, the smallest
    /// gradient of variables that can decrease is `lowest`. All omitted variables are at a bound, and their gradients point out of the allowed range [Joachims
    /// 1999].
    pub fn worth_keeping(&self, highest: T, lowest: T) -> Vec<usize> {
        (0..self.beta.len())
            .filter(|&i| {
                let can_rise = self.up[i] == T::zero();
                let can_fall = self.low[i] == T::zero();
                match (can_rise, can_fall) {
                    (true, true) => true,
                    (true, false) => self.f[i] >= lowest,
                    (false, true) => self.f[i] <= highest,
                    (false, false) => false,
                }
            })
            .collect()
    }
}

/// Returns the largest gradient f of variables that can increase and the smallest f of variables that can decrease, given feasible coefficients β and
/// their limits.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
pub(crate) fn extremes(beta: &[f64], limits: &[f64], f: &[f64], c: f64) -> (f64, f64) {
    // Each lane has its own extreme; the lanes are combined by halving.
    let mut highest = [f64::NEG_INFINITY; EXTREMES_LANES];
    let mut lowest = [f64::INFINITY; EXTREMES_LANES];
    let chunks = beta
        .chunks(EXTREMES_LANES)
        .zip(limits.chunks(EXTREMES_LANES));
    for ((beta, limits), f) in chunks.zip(f.chunks(EXTREMES_LANES)) {
        let n = beta.len();
        let (limits, f) = (&limits[..n], &f[..n]);
        let (highest, lowest) = (&mut highest[..n], &mut lowest[..n]);
        for at in 0..n {
            let (low, high) = bounds(limits[at], c);
            let raised = if beta[at] < high {
                f[at]
            } else {
                f64::NEG_INFINITY
            };
            let lowered = if beta[at] > low { f[at] } else { f64::INFINITY };
            highest[at] = larger(raised, highest[at]);
            lowest[at] = smaller(lowered, lowest[at]);
        }
    }
    let mut width = EXTREMES_LANES / 2;
    while width > 0 {
        for lane in 0..width {
            highest[lane] = larger(highest[lane + width], highest[lane]);
            lowest[lane] = smaller(lowest[lane + width], lowest[lane]);
        }
        width /= 2;
    }
    (highest[0], lowest[0])
}

/// Returns the larger of `a` and `b`; `b` must not be NaN.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Returns the smaller of `a` and `b`; `b` must not be NaN.
#[inline(always)]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// Returns the two terms `Σ y β` and `β K β` of the dual objective, with the Gram matrix K. The objective is the first term minus half of the second.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
pub(super) fn linear_and_quadratic(beta: &[f64], y: &[f64], f: &[f64]) -> (f64, f64) {
    let (beta, last_beta) = beta.as_chunks::<LANES>();
    let (y, last_y) = y.as_chunks::<LANES>();
    let (f, last_f) = f.as_chunks::<LANES>();
    let n = beta.len();
    let (y, f) = (&y[..n], &f[..n]);
    // Each lane has its own sum; the lanes are added at the end.
    let (mut linear, mut quadratic) = ([0.0; LANES], [0.0; LANES]);
    for at in 0..n {
        for lane in 0..LANES {
            linear[lane] += beta[at][lane] * y[at][lane];
            quadratic[lane] += beta[at][lane] * (y[at][lane] - f[at][lane]);
        }
    }
    for at in 0..last_beta.len() {
        linear[at] += last_beta[at] * last_y[at];
        quadratic[at] += last_beta[at] * (last_y[at] - last_f[at]);
    }
    (linear.iter().sum(), quadratic.iter().sum())
}

/// Returns the sum of the gradient f over the variables between their bounds, and the number of these variables.
#[multiversion::multiversion(targets("x86_64+avx512f", "x86_64+avx2+fma"))]
fn sum_of_free(beta: &[f64], limits: &[f64], f: &[f64], c: f64) -> (f64, f64) {
    let (beta, last_beta) = beta.as_chunks::<LANES>();
    let (limits, last_limits) = limits.as_chunks::<LANES>();
    let (f, last_f) = f.as_chunks::<LANES>();
    let n = beta.len();
    let (limits, f) = (&limits[..n], &f[..n]);
    // Each lane has its own sum; the lanes are added at the end.
    let (mut sum, mut n_free) = ([0.0; LANES], [0.0; LANES]);
    for at in 0..n {
        for lane in 0..LANES {
            let is_free = weight_if_free(beta[at][lane], limits[at][lane], c);
            sum[lane] += is_free * f[at][lane];
            n_free[lane] += is_free;
        }
    }
    for at in 0..last_beta.len() {
        let is_free = weight_if_free(last_beta[at], last_limits[at], c);
        sum[at] += is_free * last_f[at];
        n_free[at] += is_free;
    }
    (sum.iter().sum(), n_free.iter().sum())
}

/// Returns 1 for a variable between its bounds, otherwise 0.
#[inline(always)]
fn weight_if_free(beta: f64, limit: f64, c: f64) -> f64 {
    let (low, high) = bounds(limit, c);
    f64::from(u8::from((beta > low) & (beta < high)))
}

/// Returns the offset ρ: the mean of −f over the variables between their bounds. If there are none, returns the middle of the interval that the others allow
/// (LIBSVM's rule).
pub(super) fn rho(beta: &[f64], limits: &[f64], f: &[f64], c: f64) -> f64 {
    let (sum, n_free) = sum_of_free(beta, limits, f, c);
    if n_free > 0.0 {
        return -sum / n_free;
    }
    match extremes(beta, limits, f, c) {
        (highest, lowest) if highest.is_finite() && lowest.is_finite() => -(highest + lowest) / 2.0,
        (highest, _) if highest.is_finite() => -highest,
        (_, lowest) => -lowest,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_ends_exactly_at_a_bound() {
        // In f64, 0.56 + (7.2 − 0.56) is above 7.2.
        let mut variables = Variables::<f64>::new(&[0.56, 0.0], &[1.0, -1.0], &[50.0, -50.0], 7.2);
        variables.step(0, 1, 1.0);
        assert_eq!(
            (variables.beta[0], variables.up[0]),
            (7.2, f64::NEG_INFINITY)
        );
    }

    #[test]
    fn extremes_are_those_of_all_that_can_move_however_many_there_are() {
        let c = 2.0;
        for n in [0, 1, 7, 63, 64, 65, 150] {
            let y: Vec<f64> = (0..n).map(|i| [1.0, -1.0, 0.0][i % 3]).collect();
            let beta = |i: usize| c * y[i] * [0.0, 0.3, 1.0, 1.0][i / 3 % 4];
            let beta: Vec<f64> = (0..n).map(beta).collect();
            let f: Vec<f64> = (0..n).map(|i| (i as f64 * 1.7).sin()).collect();
            let (mut highest, mut lowest) = (f64::NEG_INFINITY, f64::INFINITY);
            for i in 0..n {
                let (low, high) = bounds(y[i], c);
                if beta[i] < high {
                    highest = highest.max(f[i]);
                }
                if beta[i] > low {
                    lowest = lowest.min(f[i]);
                }
            }
            assert_eq!(extremes(&beta, &y, &f, c), (highest, lowest), "{n}");
        }
    }
}
