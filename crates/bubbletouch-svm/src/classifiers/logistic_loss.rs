//! Minimum of the regularised loss of a multinomial logistic regression, by Newton's method with conjugate gradients [Nocedal & Wright 2006, algorithm 7.1].
//!
//! With labels y_i, row weights v_i, weights w_k, biases b_k and p(k | x) ∝ exp(w_k·x + b_k), the objective is
//!
//! `F = (1/n) Σ_i −v_i ln p(y_i | x_i) + ½ penalty Σ_k |w_k|²`.
//!
//! The Newton step d solves `H d = −g`, where g is the gradient and H the Hessian of F. A product with H needs two matrix products with the features and no
//! exponential, because the probabilities of the point are stored. Products that only steer the search are computed in f32; those that decide about its end are
//! computed in f64. The features are centred and divided by their root mean squares, so their units do not matter; a [`Preconditioner`] takes their correlations
//! into account. Steps are halved until F decreases, which needs no further product with the features.
//!
//! The predicted decrease `−½ g·d` estimates F − min F. Training stops after the step whose predicted decrease is at most `tolerance · F`.

use ndarray::linalg::general_mat_mul;
use ndarray::{Array1, Array2, ArrayView2, Axis, NdFloat, Zip, concatenate, s};

use crate::class_model::normalise;
use crate::classifiers::logistic_preconditioner::Preconditioner;
use crate::linear_model::LinearModel;

/// Relative residual at which the conjugate gradients stop. With a smaller value, each Newton step takes more products; with a larger value, more Newton steps
/// are needed.
const TRUNCATION: f64 = 0.5;

/// Predicted decrease, relative to the objective, below which products are computed in f64. With a smaller value, rounding errors of f32 predominate.
const SINGLE_PRECISION: f64 = 1e-5;

/// Relative residual below which the rounding errors of the products predominate.
const ROUNDING: f64 = 1e-7;

/// Number of products that must add less than a tenth to the predicted decrease before it ends the training [Strakoš & Tichý 2002]. With a smaller value, the
/// training ends far from the minimum if the objective is flat along some direction; with a larger value, the last step needs more products.
const LAST_PRODUCTS: usize = 40;

/// Minimum number of rows per feature with which conjugate gradients are preconditioned by a Kronecker product. With a smaller value, the memory of the product
/// may be much larger than that of the features; with a larger value, more trainings take two to three times as long.
const MIN_ROWS_PER_FEATURE: usize = 4;

/// Minimum decrease of the objective in an accepted step, relative to the decrease predicted by the gradient (Armijo's condition).
const SUFFICIENT_DECREASE: f64 = 1e-4;

/// Maximum number of step halvings; after more halvings, the decrease is below the rounding error.
const MAX_HALVINGS: usize = 40;

/// Objective of labelled rows as a function of the coefficients, shape n_classes × (m + 1): the weights of each class and, in the last column, its bias. The
/// weights are those of the scaled features.
pub(crate) struct LogisticLoss<'a> {
    /// Features minus their means, divided by their scales, shape n × m.
    scaled: Array2<f64>,
    single: Array2<f32>,
    means: Array1<f64>,
    /// Root mean square of each centred feature; 1 where it is 0.
    scales: Array1<f64>,
    /// Class of each row, as an index.
    label: &'a [usize],
    row_weights: Array1<f64>,
    n_classes: usize,
    /// Penalty of the square of each coefficient of a class, shape (m + 1,).
    penalties: Array1<f64>,
}

/// Result of the minimisation.
pub(crate) struct Minimum {
    pub model: LinearModel,
    pub n_iterations: usize,
    /// Whether the predicted decrease is above the tolerance: at the iteration cap, or because rounding errors hide any further decrease.
    pub is_capped: bool,
}

/// Coefficients with the values of all rows that the objective needs.
struct Point {
    at: Array2<f64>,
    /// Scores `w_k·x_i + b_k`, shape n × n_classes.
    scores: Array2<f64>,
    value: f64,
}

/// Approximate Newton step.
struct NewtonStep {
    step: Array2<f64>,
    /// Predicted decrease of the objective.
    decrease: f64,
    /// Number of products with the Hessian.
    n_products: usize,
}

impl<'a> LogisticLoss<'a> {
    /// Creates the objective of rows (n × m, at least one) with labels from 0 to n_classes − 1 and a weight per row.
    pub(crate) fn new(
        (features, label, row_weights): (ArrayView2<f64>, &'a [usize], Array1<f64>),
        n_classes: usize,
        penalty: f64,
    ) -> Self {
        let means = features.mean_axis(Axis(0)).expect("at least one row");
        let mut scaled = features.as_standard_layout().into_owned();
        scaled -= &means;
        let scales = scaled.map_axis(Axis(0), |column| {
            let square = column.dot(&column) / column.len() as f64;
            if square > 0.0 { square.sqrt() } else { 1.0 }
        });
        scaled /= &scales;
        let of_weights = scales.mapv(|scale| penalty / (scale * scale));
        Self {
            single: scaled.mapv(|x| x as f32),
            scaled,
            means,
            label,
            row_weights,
            n_classes,
            penalties: concatenate![Axis(0), of_weights, Array1::zeros(1)],
            scales,
        }
    }

    /// Minimises the objective from coefficients of 0, with at most `max_iterations` Newton steps.
    pub(crate) fn minimise(&self, tolerance: f64, max_iterations: usize) -> Minimum {
        let at = Array2::zeros((self.n_classes, self.means.len() + 1));
        let scores = Array2::zeros((self.label.len(), self.n_classes));
        let mut point = self.point(at, scores);
        let (mut kronecker, mut n_products) = (None, 0);
        for n_iterations in 1..=max_iterations {
            let (p, gradient) = self.gradient(&point);
            let (weights, penalties) = (&self.row_weights, &self.penalties);
            if self.refresh_products().is_some_and(|n| n_products >= n) {
                let new = Preconditioner::kronecker(&self.scaled, &p, weights, penalties);
                kronecker = Some(new);
                n_products = 0;
            }
            let diagonal;
            let preconditioner = match &kronecker {
                Some(kronecker) => kronecker,
                None => {
                    diagonal = Preconditioner::diagonal(&p, weights, penalties);
                    &diagonal
                }
            };
            let least = [tolerance, SINGLE_PRECISION].map(|part| part * point.value);
            let NewtonStep {
                step,
                decrease,
                n_products: n_new,
            } = self.newton_step(&p, &gradient, preconditioner, least);
            n_products += n_new;
            let slope = dot(&gradient, &step);
            let next = self.lower_point(&point, &step, slope);
            let is_last = decrease <= tolerance * point.value;
            let is_stuck = next.is_none();
            point = next.unwrap_or(point);
            if is_last || is_stuck {
                return self.minimum(point, n_iterations, !is_last);
            }
        }
        self.minimum(point, max_iterations, true)
    }

    fn minimum(&self, point: Point, n_iterations: usize, is_capped: bool) -> Minimum {
        let weights = &point.at.slice(s![.., ..-1]) / &self.scales;
        let bias = point.at.slice(s![.., -1]);
        // Adding a number to all biases changes no probability; their mean is 0.
        let bias = &bias - bias.mean().unwrap_or(0.0) - weights.dot(&self.means);
        Minimum {
            model: LinearModel { weights, bias },
            n_iterations,
            is_capped,
        }
    }

    fn point(&self, at: Array2<f64>, scores: Array2<f64>) -> Point {
        let losses = Zip::from(scores.rows()).and(&self.row_weights);
        let mut label = self.label.iter();
        let mut loss = 0.0;
        losses.for_each(|scores, weight| {
            let label = *label.next().expect("one label a row");
            let place = (0..scores.len())
                .fold(0, |best, k| if scores[k] > scores[best] { k } else { best });
            // The largest term of the sum is 1. ln_1p keeps the digits of a small loss.
            let others = scores.iter().enumerate().filter(|(k, _)| *k != place);
            let others: f64 = others.map(|(_, score)| (score - scores[place]).exp()).sum();
            loss += weight * (others.ln_1p() + (scores[place] - scores[label]));
        });
        let squares = at.mapv(|w| w * w).dot(&self.penalties).sum();
        Point {
            value: loss / self.label.len() as f64 + 0.5 * squares,
            at,
            scores,
        }
    }

    /// Returns the point `at + t·step` with the first t of 1, ½, ¼, … that decreases the objective; `None` if none does.
    fn lower_point(&self, from: &Point, step: &Array2<f64>, slope: f64) -> Option<Point> {
        let of_step = scores(&self.scaled, step);
        let mut length = 1.0;
        for _ in 0..MAX_HALVINGS {
            let mut at = from.at.clone();
            at.scaled_add(length, step);
            let mut scores = from.scores.clone();
            scores.scaled_add(length, &of_step);
            let next = self.point(at, scores);
            if next.value <= from.value + SUFFICIENT_DECREASE * length * slope {
                return Some(next);
            }
            length *= 0.5;
        }
        None
    }

    /// Returns the number of products with the Hessian that take as long as a new Kronecker product. Returns `None` if this product needs much more memory than
    /// the features.
    fn refresh_products(&self) -> Option<usize> {
        let (n, m) = self.scaled.dim();
        (MIN_ROWS_PER_FEATURE * m <= n).then(|| m * (n + m) / (n * self.n_classes))
    }

    /// Returns an approximate Newton step at the point with probabilities `p` and the given gradient. The step ends the training if its predicted decrease is at
    /// most `least`; products are computed in f32 while it is above `single`.
    fn newton_step(
        &self,
        p: &Array2<f64>,
        gradient: &Array2<f64>,
        preconditioner: &Preconditioner,
        [least, single_above]: [f64; 2],
    ) -> NewtonStep {
        let single = p.mapv(|p| p as f32);
        let mut residual = -gradient;
        let mut step = Array2::zeros(gradient.dim());
        let mut scaled = preconditioner.solve(&residual);
        let mut direction = scaled.clone();
        let mut product = dot(&residual, &scaled);
        let first = product;
        let mut decrease = 0.0;
        let mut decreases = Vec::new();
        for _ in 0..10 * step.len() {
            let mut turned = if decrease > least.max(single_above) {
                let steps = direction.mapv(|step| step as f32);
                let turned = self.curvature(&self.single, &single, &steps);
                turned.mapv(f64::from)
            } else {
                self.curvature(&self.scaled, p, &direction)
            };
            turned += &(&direction * &self.penalties);
            let length = product / dot(&direction, &turned);
            if !(length > 0.0 && length.is_finite()) {
                break;
            }
            step.scaled_add(length, &direction);
            residual.scaled_add(-length, &turned);
            decrease += 0.5 * length * product;
            scaled = preconditioner.solve(&residual);
            let last = product;
            product = dot(&residual, &scaled);
            decreases.push(decrease);
            let before = decreases.iter().rev().nth(LAST_PRODUCTS);
            let is_steady = before.is_some_and(|before| decrease - before <= 0.1 * decrease);
            let truncation = if decrease > least {
                TRUNCATION
            } else {
                ROUNDING
            };
            if product <= truncation * truncation * first || decrease <= least && is_steady {
                break;
            }
            direction *= product / last;
            direction += &scaled;
        }
        NewtonStep {
            step,
            decrease,
            n_products: decreases.len(),
        }
    }

    /// Returns the probabilities of all rows (n × n_classes), and the gradient of the objective.
    fn gradient(&self, point: &Point) -> (Array2<f64>, Array2<f64>) {
        let mut p = point.scores.clone();
        normalise(&mut p);
        p.mapv_inplace(f64::exp);
        let mut residuals = p.clone();
        for ((mut row, &label), weight) in residuals
            .rows_mut()
            .into_iter()
            .zip(self.label)
            .zip(&self.row_weights)
        {
            // 1 − p would lose the digits of a small residual.
            row[label] = 0.0;
            row[label] = -row.sum();
            row *= *weight;
        }
        let gradient = sums(&self.scaled, &residuals) + &point.at * &self.penalties;
        (p, gradient)
    }

    /// Returns the product of a direction with the Hessian of the mean loss (without the penalty), at the point with probabilities `p`.
    fn curvature<T: NdFloat>(
        &self,
        features: &Array2<T>,
        p: &Array2<T>,
        direction: &Array2<T>,
    ) -> Array2<T> {
        let mut changes = scores(features, direction);
        let rows = changes.rows_mut().into_iter().zip(p.rows());
        for (((mut row, p), &label), &weight) in rows.zip(self.label).zip(&self.row_weights) {
            // The probability of the label is usually near 1; differences from its change keep their digits.
            let of_label = row[label];
            row -= of_label;
            let mean = row.dot(&p);
            let weight = T::from(weight).expect("a finite number");
            Zip::from(&mut row)
                .and(p)
                .for_each(|change, p| *change = weight * *p * (*change - mean));
        }
        sums(features, &changes)
    }
}

/// Returns the scores of all rows of features (n × m), shape n × n_classes.
fn scores<T: NdFloat>(features: &Array2<T>, at: &Array2<T>) -> Array2<T> {
    features.dot(&at.slice(s![.., ..-1]).t()) + at.slice(s![.., -1])
}

/// Returns the mean over the rows of `values[i, k] · (x_i, 1)`, shape n_classes × (m + 1).
pub(super) fn sums<T: NdFloat>(features: &Array2<T>, values: &Array2<T>) -> Array2<T> {
    let per_row = T::one() / T::from(features.nrows()).expect("a number of rows");
    let mut sums = Array2::zeros((values.ncols(), features.ncols() + 1));
    let of_weights = &mut sums.slice_mut(s![.., ..-1]);
    general_mat_mul(per_row, &values.t(), features, T::zero(), of_weights);
    let of_bias = values.sum_axis(Axis(0)) * per_row;
    sums.column_mut(features.ncols()).assign(&of_bias);
    sums
}

fn dot(a: &Array2<f64>, b: &Array2<f64>) -> f64 {
    Zip::from(a).and(b).fold(0.0, |sum, a, b| sum + a * b)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns 40 rows with weights, and the objective of three classes.
    fn loss(label: &[usize]) -> LogisticLoss<'_> {
        let features = Array2::from_shape_fn((label.len(), 3), |(i, j)| {
            5.0 + ((i * 131 + j * 71) as f64 * 0.417).sin() * 3f64.powi(j as i32)
        });
        let weights = Array1::from_shape_fn(label.len(), |i| 0.5 + (i % 3) as f64);
        LogisticLoss::new((features.view(), label, weights), 3, 0.3)
    }

    #[test]
    fn gradient_and_hessian_are_the_derivatives_of_the_objective() {
        let label: Vec<usize> = (0..40).map(|i| i * i % 3).collect();
        let loss = loss(&label);
        let point = |at: &Array2<f64>| loss.point(at.clone(), scores(&loss.scaled, at));
        let at = Array2::from_shape_fn((3, 4), |(k, j)| ((k * 4 + j) as f64 * 1.3).sin() * 0.1);
        let (p, gradient) = loss.gradient(&point(&at));
        let scores = scores(&loss.scaled, &at);
        let by_definition: f64 = (0..40)
            .map(|i| {
                loss.row_weights[i]
                    * (scores.row(i).mapv(f64::exp).sum().ln() - scores[[i, label[i]]])
            })
            .sum::<f64>()
            / 40.0
            + 0.5 * (at.mapv(|w| w * w) * &loss.penalties).sum();
        assert!((point(&at).value - by_definition).abs() < 1e-12 * by_definition);
        for place in 0..12 {
            let mut unit = Array2::zeros((3, 4));
            unit[[place / 4, place % 4]] = 1e-5;
            let [above, below] = [&at + &unit, &at - &unit].map(|at| point(&at));
            let slope = (above.value - below.value) / 2e-5;
            assert!((gradient[[place / 4, place % 4]] - slope).abs() < 1e-7 * (1.0 + slope.abs()));
            let change = (loss.gradient(&above).1 - loss.gradient(&below).1) / 2.0;
            let product = loss.curvature(&loss.scaled, &p, &unit) + &unit * &loss.penalties;
            assert!(
                (product - change)
                    .iter()
                    .all(|error| error.abs() < 1e-10 * 1e3)
            );
        }
    }
}
