//! Two passes of the solver over all variables, written for automatic vectorisation. For f32, there are explicit vector instructions (`passes_512`) if the
//! processor supports them.
//!
//! The length of every slice is a multiple of [`LANES`] ([`padded`]). Each lane has its own extreme value. The position of the overall extreme is searched
//! afterwards. Of equal values, the one with the lowest index is chosen, so results do not depend on the processor.

use crate::linalg::lanes::LANES;
use crate::linalg::scalar::Scalar;

/// Returns the largest value of `a_i + b_i` over all indices i. Each lane has its own maximum; the lanes are combined at the end.
#[inline(always)]
fn largest_sum<T: Scalar>(a: &[T], b: &[T]) -> T {
    let mut lanes = [T::neg_infinity(); LANES];
    for (a, b) in a
        .as_chunks::<LANES>()
        .0
        .iter()
        .zip(b.as_chunks::<LANES>().0)
    {
        for lane in 0..LANES {
            let value = a[lane] + b[lane];
            lanes[lane] = if value > lanes[lane] {
                value
            } else {
                lanes[lane]
            };
        }
    }
    lanes
        .iter()
        .fold(T::neg_infinity(), |a, &b| if b > a { b } else { a })
}

/// Returns the largest value of `a`, at least 0.
#[inline(always)]
fn largest<T: Scalar>(a: &[T]) -> T {
    let mut lanes = [T::zero(); LANES];
    for a in a.as_chunks::<LANES>().0 {
        for lane in 0..LANES {
            lanes[lane] = if a[lane] > lanes[lane] {
                a[lane]
            } else {
                lanes[lane]
            };
        }
    }
    lanes
        .iter()
        .fold(T::zero(), |a, &b| if b > a { b } else { a })
}

/// Returns the first index below n for which `is` returns true. All lanes of a chunk are tested together.
#[inline(always)]
fn first(n: usize, is: impl Fn(usize) -> bool) -> usize {
    for start in (0..n).step_by(LANES) {
        let mut is_here = false;
        for lane in 0..LANES {
            is_here |= is(start + lane);
        }
        if is_here {
            return (start..start + LANES)
                .find(|&index| is(index))
                .unwrap_or(start);
        }
    }
    0
}

/// Returns the next variable to increase: the first index with the largest gradient f among the variables that can increase. The mark `up` is 0 for these
/// variables and −∞ for others.
#[inline(always)]
pub(super) fn select_up<T: Scalar>(f: &[T], up: &[T]) -> Option<usize> {
    let up = &up[..f.len()];
    let highest = largest_sum(f, up);
    if highest > T::neg_infinity() {
        Some(first(f.len(), |at| f[at] + up[at] == highest))
    } else {
        None
    }
}

/// Moves the variables i and j: subtracts `step (row_i − row_j)` from the gradient f, and returns the next variable to increase.
#[multiversion::multiversion(targets("x86_64+avx2+fma"))]
pub(crate) fn step_along<T: Scalar>(
    f: &mut [T],
    (row_i, row_j): (&[T], &[T]),
    step: T,
    up: &[T],
) -> Option<usize> {
    let n = f.len();
    let (row_i, row_j) = (&row_i[..n], &row_j[..n]);
    for at in 0..n {
        f[at] -= step * (row_i[at] - row_j[at]);
    }
    select_up(f, up)
}

/// Second variable of a pairwise step (the variable that decreases), with the violation of the optimality conditions.
pub(crate) struct Down<T> {
    /// Variable to decrease while variable `i` increases; `None` if no pair violates the optimality conditions. The variable has the largest second-order gain
    /// of the dual objective [Fan, Chen, Lin 2005].
    pub j: Option<usize>,
    /// Violation of the optimality conditions: largest gradient of a variable that can increase minus smallest gradient of a variable that can decrease.
    pub violation: T,
}

/// Selects the variable to decrease in a pairwise step that increases variable i, whose gradient is `highest`. The mark `low` is 0 for variables that can
/// decrease and −∞ for others. Inverse curvatures of the pairs with i are in `inverses`; `gains` is scratch memory.
#[multiversion::multiversion(targets("x86_64+avx2+fma"))]
pub(crate) fn select_down<T: Scalar>(
    (f, low): (&[T], &[T]),
    inverses: &[T],
    highest: T,
    gains: &mut [T],
) -> Down<T> {
    let n = gains.len();
    let (f, low, inverses) = (&f[..n], &low[..n], &inverses[..n]);
    for at in 0..n {
        let difference = highest - f[at] + low[at];
        let difference = if difference > T::zero() {
            difference
        } else {
            T::zero()
        };
        gains[at] = difference * difference * inverses[at];
    }
    let best = largest(gains);
    let gains = &*gains;
    Down {
        j: if best > T::zero() {
            Some(first(n, |at| gains[at] == best))
        } else {
            None
        },
        violation: violation(f, low, highest),
    }
}

/// Returns the violation of the optimality conditions, at least 0. The violation is `highest` minus the smallest gradient f among variables that can decrease.
#[inline(always)]
fn violation<T: Scalar>(f: &[T], low: &[T], highest: T) -> T {
    let mut lanes = [T::zero(); LANES];
    for (f, low) in f
        .as_chunks::<LANES>()
        .0
        .iter()
        .zip(low.as_chunks::<LANES>().0)
    {
        for lane in 0..LANES {
            let value = highest - f[lane] + low[lane];
            lanes[lane] = if value > lanes[lane] {
                value
            } else {
                lanes[lane]
            };
        }
    }
    lanes
        .iter()
        .fold(T::zero(), |a, &b| if b > a { b } else { a })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns irregular test values, some of which are equal.
    fn values(n: usize, salt: f64) -> Vec<f64> {
        (0..n)
            .map(|i| ((i % 37) as f64 * 1.7 + salt).sin())
            .collect()
    }

    #[test]
    fn the_passes_find_what_a_plain_loop_finds() {
        let n = 5 * LANES;
        let infinite = |i: usize, every: usize| i.is_multiple_of(every);
        let up: Vec<f64> = (0..n)
            .map(|i| {
                if infinite(i, 3) {
                    f64::NEG_INFINITY
                } else {
                    0.0
                }
            })
            .collect();
        let low: Vec<f64> = (0..n)
            .map(|i| if infinite(i, 4) { f64::INFINITY } else { 0.0 })
            .collect();
        let (row_i, row_j) = (values(n, 0.1), values(n, 0.5));
        let inverses: Vec<f64> = values(n, 2.0).iter().map(|v| v + 3.0).collect();
        let mut f = values(n, 0.9);
        let mut plain = f.clone();

        let next = step_along(&mut f, (&row_i, &row_j), 0.3, &up);
        for i in 0..n {
            plain[i] -= 0.3 * (row_i[i] - row_j[i]);
        }
        assert_eq!(f, plain);
        let mut best = (f64::NEG_INFINITY, 0);
        for i in 0..n {
            if plain[i] + up[i] > best.0 {
                best = (plain[i] + up[i], i);
            }
        }
        assert_eq!(next, Some(best.1));
        assert_eq!(select_up(&f, &up), next);

        let highest = best.0;
        let down = select_down((&f, &low), &inverses, highest, &mut vec![0.0; n]);
        let (mut gain, mut at, mut violation) = (0.0, None, 0.0_f64);
        for j in 0..n {
            let difference = highest - f[j] + low[j];
            if difference > 0.0 {
                violation = violation.max(difference);
                if difference * difference * inverses[j] > gain {
                    gain = difference * difference * inverses[j];
                    at = Some(j);
                }
            }
        }
        assert_eq!(down.j, at);
        assert_eq!(down.violation, violation);
    }

    #[test]
    fn nothing_is_found_where_nothing_can_move() {
        let f = vec![1.0_f32; LANES];
        assert_eq!(select_up(&f, &[f32::NEG_INFINITY; LANES]), None);
        let low = [f32::NEG_INFINITY; LANES];
        let down = select_down((&f, &low), &[1.0; LANES], 1.0, &mut [0.0; LANES]);
        assert!(down.j.is_none() && down.violation == 0.0);
    }
}
