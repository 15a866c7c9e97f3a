//! The solver's two passes over all variables, written so that the compiler makes vector instructions of them.
//!
//! Every slice is a whole number of [`LANES`] long ([`padded`]). Each lane keeps its own extreme; where the extreme of all is
//! gets looked up afterwards, the lowest index of equals, so results do not depend on the processor.

use crate::recognition::scalar::Scalar;

/// Values handled side by side: two vector registers of eight f32, four of four f64.
pub(super) const LANES: usize = 16;

/// The smallest whole number of lanes that holds n values.
pub(super) fn padded(n: usize) -> usize {
    n.next_multiple_of(LANES)
}

/// The largest of what the lanes hold; −∞ when they hold nothing larger.
#[inline(always)]
fn largest<T: Scalar>(lanes: &[T; LANES]) -> T {
    lanes
        .iter()
        .fold(T::neg_infinity(), |a, &b| if b > a { b } else { a })
}

/// The first index of a value that is the largest.
#[inline(always)]
fn first<T: Scalar>(n_chunks: usize, largest: T, value: impl Fn(usize, usize) -> T) -> usize {
    for chunk in 0..n_chunks {
        // Without an early exit among the lanes, they are compared all at once.
        let mut is_here = false;
        for lane in 0..LANES {
            is_here |= value(chunk, lane) == largest;
        }
        if is_here {
            let lane = (0..LANES).find(|&lane| value(chunk, lane) == largest);
            return chunk * LANES + lane.unwrap_or(0);
        }
    }
    0
}

/// `f − step (row_i − row_j)` in place, and where the largest of `f + up` is: the next variable to raise. `None` when none
/// can be.
#[inline(always)]
pub(super) fn step_and_select<T: Scalar>(
    f: &mut [T],
    (row_i, row_j): (&[T], &[T]),
    up: &[T],
    step: T,
) -> Option<usize> {
    let mut lanes = [T::neg_infinity(); LANES];
    let f = f.as_chunks_mut::<LANES>().0;
    let row_i = row_i.as_chunks::<LANES>().0;
    let row_j = row_j.as_chunks::<LANES>().0;
    let up = up.as_chunks::<LANES>().0;
    for (((f, row_i), row_j), up) in f.iter_mut().zip(row_i).zip(row_j).zip(up) {
        for lane in 0..LANES {
            f[lane] = f[lane] - step * (row_i[lane] - row_j[lane]);
            let value = f[lane] + up[lane];
            lanes[lane] = if value > lanes[lane] {
                value
            } else {
                lanes[lane]
            };
        }
    }
    let highest = largest(&lanes);
    (highest > T::neg_infinity()).then(|| {
        first(f.len(), highest, |chunk, lane| {
            f[chunk][lane] + up[chunk][lane]
        })
    })
}

/// Where the largest of `f + up` is.
#[inline(always)]
pub(super) fn select_up<T: Scalar>(f: &[T], up: &[T]) -> Option<usize> {
    let mut best = None;
    let mut highest = T::neg_infinity();
    for (index, (&f, &up)) in f.iter().zip(up).enumerate() {
        if f + up > highest {
            highest = f + up;
            best = Some(index);
        }
    }
    best
}

/// What the second pass found.
pub(super) struct Down<T> {
    /// The variable to lower with `i`: the largest gain of the dual objective, to second order [Fan, Chen, Lin 2005];
    /// `None` when no pair violates the optimality conditions.
    pub j: Option<usize>,
    /// How far they are violated: the largest of f that can be raised less the smallest that can be lowered.
    pub violation: T,
}

/// The variable to lower when i, whose f is `highest`, is raised. `row` is row i of the Gram matrix; `low` is 0 where a
/// variable can be lowered and +∞ elsewhere; `gains` is scratch.
#[inline(always)]
pub(super) fn select_down<T: Scalar>(
    (f, low): (&[T], &[T]),
    (row, diagonal): (&[T], &[T]),
    (highest, own): (T, T),
    smallest_curvature: T,
    gains: &mut [T],
) -> Down<T> {
    let mut lanes = [T::zero(); LANES];
    let mut violations = [T::zero(); LANES];
    let two = T::one() + T::one();
    let f = f.as_chunks::<LANES>().0;
    let low = low.as_chunks::<LANES>().0;
    let row = row.as_chunks::<LANES>().0;
    let diagonal = diagonal.as_chunks::<LANES>().0;
    let gains = gains.as_chunks_mut::<LANES>().0;
    let chunks = f.iter().zip(low).zip(row).zip(diagonal);
    for ((((f, low), row), diagonal), gains) in chunks.zip(gains.iter_mut()) {
        for lane in 0..LANES {
            let difference = highest - (f[lane] + low[lane]);
            let difference = if difference > T::zero() {
                difference
            } else {
                T::zero()
            };
            let curvature = own + diagonal[lane] - two * row[lane];
            let curvature = if curvature > smallest_curvature {
                curvature
            } else {
                smallest_curvature
            };
            let gain = difference * difference / curvature;
            gains[lane] = gain;
            lanes[lane] = if gain > lanes[lane] {
                gain
            } else {
                lanes[lane]
            };
            violations[lane] = if difference > violations[lane] {
                difference
            } else {
                violations[lane]
            };
        }
    }
    let best = largest(&lanes);
    Down {
        j: (best > T::zero()).then(|| first(gains.len(), best, |chunk, lane| gains[chunk][lane])),
        violation: largest(&violations),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values with no pattern; some lanes repeat, so that ties occur.
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
        let diagonal: Vec<f64> = values(n, 2.0).iter().map(|v| v + 3.0).collect();
        let mut f = values(n, 0.9);
        let mut plain = f.clone();

        let found = step_and_select(&mut f, (&row_i, &row_j), &up, 0.3);
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
        assert_eq!(found, Some(best.1));
        assert_eq!(select_up(&f, &up), Some(best.1));

        let (highest, i) = best;
        let down = select_down(
            (&f, &low),
            (&row_i, &diagonal),
            (highest, diagonal[i]),
            1e-12,
            &mut vec![0.0; n],
        );
        let (mut gain, mut at, mut violation) = (0.0, None, 0.0_f64);
        for j in 0..n {
            let difference = highest - f[j] - low[j];
            if difference > 0.0 {
                let curvature = (diagonal[i] + diagonal[j] - 2.0 * row_i[j]).max(1e-12);
                violation = violation.max(difference);
                if difference * difference / curvature > gain {
                    gain = difference * difference / curvature;
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
        let low = [f32::INFINITY; LANES];
        let row = [0.0; LANES];
        let down = select_down(
            (&f, &low),
            (&row, &[1.0; LANES]),
            (1.0, 1.0),
            1e-12,
            &mut [0.0; LANES],
        );
        assert!(down.j.is_none() && down.violation == 0.0);
    }
}
