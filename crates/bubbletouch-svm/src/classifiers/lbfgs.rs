//! Limited-memory BFGS for smooth convex functions [Nocedal & Wright 2006, algorithm 7.5].

use std::collections::VecDeque;

use ndarray::Array1;

/// Number of recent steps that L-BFGS stores, each with the change of the gradient: 10, as in SciPy. With a larger value, more memory is used; with a smaller
/// value, more iterations are needed.
const MEMORY: usize = 10;

/// Minimum decrease of the function in an accepted step, relative to the decrease predicted by the gradient (Armijo's condition).
const SUFFICIENT_DECREASE: f64 = 1e-4;

/// Limit below which relative changes of the function value are treated as rounding errors.
const ROUNDING: f64 = 1e-14;

/// Maximum number of step halvings in a line search; after more halvings, the decrease is below the rounding error.
const MAX_HALVINGS: usize = 40;

/// Result of an L-BFGS minimisation.
#[derive(Clone, Debug)]
pub(crate) struct Minimum {
    pub at: Array1<f64>,
    pub n_iterations: usize,
    /// Whether the minimisation stopped before reaching its tolerance: at the iteration cap, or because rounding errors hide any further decrease.
    pub is_capped: bool,
}

/// Minimises a convex function by L-BFGS from the start `at`, until no component of the gradient exceeds `tolerance`.
///
/// `function` returns the value and the gradient.
pub fn minimise(
    mut function: impl FnMut(&Array1<f64>) -> (f64, Array1<f64>),
    mut at: Array1<f64>,
    tolerance: f64,
    max_iterations: usize,
) -> Minimum {
    let (mut value, mut gradient) = function(&at);
    let mut pairs = VecDeque::with_capacity(MEMORY);
    for n_iterations in 0..=max_iterations {
        let is_capped = gradient.iter().any(|g| g.abs() > tolerance);
        if !is_capped || n_iterations == max_iterations {
            return Minimum {
                at,
                n_iterations,
                is_capped,
            };
        }
        let direction = direction(&pairs, &gradient);
        let slope = direction.dot(&gradient);
        // Without curvature information, the length of the first step is at most 1.
        let mut step = if pairs.is_empty() {
            1.0 / slope.abs().sqrt().max(1.0)
        } else {
            1.0
        };
        let mut accepted = None;
        for _ in 0..MAX_HALVINGS {
            let next = &at + &(&direction * step);
            let (next_value, next_gradient) = function(&next);
            let decreases = next_value <= value + SUFFICIENT_DECREASE * step * slope;
            // Near the minimum, rounding hides the decrease of the value, but not the decrease of the slope [Hager, Zhang 2005].
            let flattens = next_value <= value + ROUNDING * value.abs()
                && direction.dot(&next_gradient).abs() <= 0.9 * slope.abs();
            if decreases || flattens {
                accepted = Some((next, next_value, next_gradient));
                break;
            }
            step *= 0.5;
        }
        let Some((next, next_value, next_gradient)) = accepted else {
            return Minimum {
                at,
                n_iterations,
                is_capped,
            };
        };
        let pair = (&next - &at, &next_gradient - &gradient);
        // Convexity implies s·y ≥ 0; a pair below rounding contains no curvature information.
        if pair.0.dot(&pair.1) > f64::EPSILON * pair.1.dot(&pair.1) {
            if pairs.len() == MEMORY {
                pairs.pop_front();
            }
            pairs.push_back(pair);
        }
        (at, value, gradient) = (next, next_value, next_gradient);
    }
    unreachable!("the last iteration returns")
}

/// Returns the L-BFGS search direction `−H g`, where g is the gradient and H the inverse Hessian. The two-loop recursion estimates H from pairs (step, change
/// of the gradient).
fn direction(pairs: &VecDeque<(Array1<f64>, Array1<f64>)>, gradient: &Array1<f64>) -> Array1<f64> {
    let mut direction = -gradient;
    let mut factors = Vec::with_capacity(pairs.len());
    for (s, y) in pairs.iter().rev() {
        let factor = s.dot(&direction) / s.dot(y);
        direction.scaled_add(-factor, y);
        factors.push(factor);
    }
    if let Some((s, y)) = pairs.back() {
        direction *= s.dot(y) / y.dot(y);
    }
    for ((s, y), factor) in pairs.iter().zip(factors.iter().rev()) {
        let correction = factor - y.dot(&direction) / s.dot(y);
        direction.scaled_add(correction, s);
    }
    direction
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn an_ill_conditioned_bowl_is_solved_to_its_bottom() {
        let scale = array![1.0, 1e4, 1e-2, 30.0];
        let bottom = array![1.0, -2.0, 3.0, 0.5];
        let bowl = |x: &Array1<f64>| {
            let from = x - &bottom;
            (0.5 * (&from * &from * &scale).sum(), &from * &scale)
        };
        let found = minimise(bowl, Array1::zeros(4), 1e-9, 200);
        assert!(!found.is_capped, "{found:?}");
        assert!((&found.at - &bottom).iter().all(|d| d.abs() < 1e-6));
        assert!(minimise(bowl, Array1::zeros(4), 1e-9, 2).is_capped);
    }

    #[test]
    fn a_function_without_minimum_ends_at_the_cap_and_says_so() {
        let slope = |x: &Array1<f64>| ((-x[0]).exp(), array![-(-x[0]).exp()]);
        let found = minimise(slope, array![0.0], 1e-300, 50);
        assert!(found.is_capped && found.n_iterations <= 50);
    }
}
