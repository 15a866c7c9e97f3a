//! Limited-memory BFGS for smooth convex functions [Nocedal & Wright 2006, algorithm 7.5], optionally preconditioned.

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

/// Iterations before which the approximate inverse Hessian is computed. The second one has the curvature near the minimum; further ones save no iterations.
const PREPARED_AT: [usize; 2] = [0, 30];

/// Smooth convex function to minimise.
pub(crate) trait Objective {
    /// Returns the value and the gradient at a point.
    fn evaluate(&mut self, at: &Array1<f64>) -> (f64, Array1<f64>);

    /// Computes an approximate inverse Hessian H₀ at a point.
    fn prepare(&mut self, _at: &Array1<f64>) {}

    /// Returns `H₀ v` for a vector v; a multiple of H₀ has the same effect. The default H₀ is the identity.
    fn precondition(&self, vector: &Array1<f64>) -> Array1<f64> {
        vector.clone()
    }
}

/// Step of an iteration, with the change of the gradient.
struct Pair {
    step: Array1<f64>,
    change: Array1<f64>,
    /// Inner product of the step and the change of the gradient, above 0.
    curvature: f64,
}

/// Result of an L-BFGS minimisation.
#[derive(Clone, Debug)]
pub(crate) struct Minimum {
    pub at: Array1<f64>,
    pub n_iterations: usize,
    /// Whether the minimisation stopped before reaching its tolerance: at the iteration cap, or because rounding errors hide any further decrease.
    pub is_capped: bool,
}

/// Minimises a convex function by L-BFGS from the start `at`, until no component of the gradient exceeds `tolerance`.
pub(crate) fn minimise(
    function: &mut impl Objective,
    mut at: Array1<f64>,
    tolerance: f64,
    max_iterations: usize,
) -> Minimum {
    let (mut value, mut gradient) = function.evaluate(&at);
    let mut pairs: VecDeque<Pair> = VecDeque::with_capacity(MEMORY);
    for n_iterations in 0..=max_iterations {
        let is_capped = gradient.iter().any(|g| g.abs() > tolerance);
        if !is_capped || n_iterations == max_iterations {
            return Minimum {
                at,
                n_iterations,
                is_capped,
            };
        }
        if PREPARED_AT.contains(&n_iterations) {
            function.prepare(&at);
        }
        let direction = direction(&pairs, &gradient, function);
        let slope = direction.dot(&gradient);
        // Without curvature information, the length of the first step is at most 1: H₀ may have any scale.
        let mut step = if pairs.is_empty() {
            1.0 / slope.abs().sqrt().max(1.0)
        } else {
            1.0
        };
        let mut accepted = None;
        for _ in 0..MAX_HALVINGS {
            let next = &at + &(&direction * step);
            let (next_value, next_gradient) = function.evaluate(&next);
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
        let (step, change) = (&next - &at, &next_gradient - &gradient);
        let curvature = step.dot(&change);
        // Convexity implies s·y ≥ 0; a pair below rounding contains no curvature information.
        if curvature > f64::EPSILON * change.dot(&change) {
            if pairs.len() == MEMORY {
                pairs.pop_front();
            }
            pairs.push_back(Pair {
                step,
                change,
                curvature,
            });
        }
        (at, value, gradient) = (next, next_value, next_gradient);
    }
    unreachable!("the last iteration returns")
}

/// Returns the L-BFGS search direction `−H g`, where g is the gradient and H the inverse Hessian. The two-loop recursion estimates H from pairs (step s, change y
/// of the gradient) and from H₀, multiplied by `s·y / (y·H₀y)` of the last pair.
fn direction(
    pairs: &VecDeque<Pair>,
    gradient: &Array1<f64>,
    function: &impl Objective,
) -> Array1<f64> {
    let mut direction = -gradient;
    let mut factors = Vec::with_capacity(pairs.len());
    for pair in pairs.iter().rev() {
        let factor = pair.step.dot(&direction) / pair.curvature;
        direction.scaled_add(-factor, &pair.change);
        factors.push(factor);
    }
    let mut direction = function.precondition(&direction);
    if let Some(Pair {
        change, curvature, ..
    }) = pairs.back()
    {
        direction *= curvature / change.dot(&function.precondition(change));
    }
    for (pair, factor) in pairs.iter().zip(factors.iter().rev()) {
        let correction = factor - pair.change.dot(&direction) / pair.curvature;
        direction.scaled_add(correction, &pair.step);
    }
    direction
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    /// Function without an approximate inverse Hessian.
    struct Plain<F>(F);

    impl<F: Fn(&Array1<f64>) -> (f64, Array1<f64>)> Objective for Plain<F> {
        fn evaluate(&mut self, at: &Array1<f64>) -> (f64, Array1<f64>) {
            self.0(at)
        }
    }

    /// Quadratic function whose H₀ is the inverse Hessian times the given factor.
    struct Bowl {
        scale: Array1<f64>,
        bottom: Array1<f64>,
        factor: f64,
    }

    impl Objective for Bowl {
        fn evaluate(&mut self, at: &Array1<f64>) -> (f64, Array1<f64>) {
            let from = at - &self.bottom;
            (
                0.5 * (&from * &from * &self.scale).sum(),
                &from * &self.scale,
            )
        }

        fn precondition(&self, vector: &Array1<f64>) -> Array1<f64> {
            self.factor * vector / &self.scale
        }
    }

    #[test]
    fn an_ill_conditioned_bowl_is_solved_to_its_bottom() {
        let scale = array![1.0, 1e4, 1e-2, 30.0];
        let bottom = array![1.0, -2.0, 3.0, 0.5];
        let mut bowl = Plain(|x: &Array1<f64>| {
            let from = x - &bottom;
            (0.5 * (&from * &from * &scale).sum(), &from * &scale)
        });
        let found = minimise(&mut bowl, Array1::zeros(4), 1e-9, 200);
        assert!(!found.is_capped, "{found:?}");
        assert!((&found.at - &bottom).iter().all(|d| d.abs() < 1e-6));
        assert!(minimise(&mut bowl, Array1::zeros(4), 1e-9, 2).is_capped);
    }

    #[test]
    fn a_bowl_whose_curvature_is_known_takes_two_iterations() {
        for factor in [1.0, 0.3] {
            let mut bowl = Bowl {
                scale: array![1.0, 1e4, 1e-2, 30.0],
                bottom: array![1.0, -2.0, 3.0, 0.5],
                factor,
            };
            let found = minimise(&mut bowl, Array1::zeros(4), 1e-9, 200);
            assert!(found.n_iterations <= 2, "{found:?}");
            assert!((&found.at - &bowl.bottom).iter().all(|d| d.abs() < 1e-6));
        }
    }

    #[test]
    fn a_function_without_minimum_ends_at_the_cap_and_says_so() {
        let mut slope = Plain(|x: &Array1<f64>| ((-x[0]).exp(), array![-(-x[0]).exp()]));
        let found = minimise(&mut slope, array![0.0], 1e-300, 50);
        assert!(found.is_capped && found.n_iterations <= 50);
    }
}
