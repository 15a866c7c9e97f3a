//! The ℓ1 solver: min ½‖y − Aα‖² + λ‖α‖₁ by accelerated proximal gradient steps, many frames at a time.
//!
//! The method is FISTA (Beck and Teboulle 2009). Let L be the largest eigenvalue of AᵀA. A step is a gradient step of length 1/L from a point extrapolated
//! along the last change, then soft thresholding by λ/L. The momentum restarts if it points uphill (O'Donoghue and Candès 2015). The dual value at θ = s·(y −
//! Aα), s = min(1, λ/‖Aᵀ(y − Aα)‖∞), is a lower bound of the objective. A frame is solved if the gap between objective and dual value is small,
//! relative to the objective (Kim et al. 2007).
//!
//! A small λ needs many steps. A frame therefore starts with a large penalty, which is reduced to λ in stages (continuation: Hale, Yin and Zhang 2008).

use crate::error::{Error, Result};
use crate::sensing::{SensedDictionary, Solved};
use ndarray::linalg::general_mat_mul;
use ndarray::{Array1, Array2, ArrayView1, ArrayView2, ArrayViewMut1, Axis, Zip};

/// Number of solver steps between two checks of the duality gap; a check costs about a quarter of a step.
const CHECK_EVERY: usize = 5;
/// Number of power iterations that estimate the largest eigenvalue of AᵀA. With this number the error of the estimate is far smaller than the safety margin
/// (Kuczyński and Woźniakowski 1992).
const POWER_STEPS: usize = 60;
const MARGIN: f64 = 1.02;
/// Ratio of the penalties of two stages. From 0.1 to 0.5, the numbers of steps differ by less than 10 %.
const REDUCTION: f64 = 0.25;
/// Relative duality gap that ends a stage. With 0.2, the steps that remain at λ are too many; with 0.02, the stages take more steps than they save.
const STAGE_GAP: f64 = 0.05;

/// Parameters of the ℓ1 problem, with a stopping rule. The coefficients α of a frame minimise ½‖Aα − y‖² + λ‖α‖₁, where y are the measurements and A the
/// measured atoms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lasso {
    /// Penalty λ of the ℓ1 norm, positive, in the unit of the measurements times the norm of an atom.
    pub lambda: f64,
    /// Largest duality gap of a solved frame, as a fraction of its objective ½‖Aα − y‖² + λ‖α‖₁; positive. The gap bounds the distance of the objective
    /// from its minimum.
    pub tolerance: f64,
    /// Maximum number of solver steps per frame; at least 1.
    pub most_steps: usize,
}

impl Lasso {
    /// Returns λ = σ a √(2 ln k), where a is the root mean square norm of the k measured atoms and σ is `noise_std`. Measurements that consist only of noise
    /// of standard deviation σ then almost surely give no nonzero coefficient. This is the universal threshold of Donoho and Johnstone (1994), as used by
    /// Chen, Donoho and Saunders (1998).
    pub fn universal_lambda(sensed: &SensedDictionary, noise_std: f64) -> f64 {
        let atoms = sensed.atoms();
        let k = atoms.nrows() as f64;
        let square = atoms.iter().map(|a| a * a).sum::<f64>() / k;
        noise_std * (square * 2.0 * k.ln()).sqrt()
    }

    /// Computes the dictionary coefficients of each frame from rows of measurements (n_frames × m).
    ///
    /// A frame is marked as capped if its duality gap is above the tolerance after `most_steps`.
    ///
    /// # Errors
    /// If λ or the tolerance is not a positive number, or if `most_steps` is 0.
    ///
    /// # Panics
    /// If a row does not have m values.
    pub fn solve(
        &self,
        sensed: &SensedDictionary,
        measurements: ArrayView2<f64>,
    ) -> Result<Solved> {
        self.solve_with(&Curvature::new(sensed), sensed, measurements)
    }

    /// Computes the dictionary coefficients of each frame from its row of measurements, with a [`Curvature`] that was computed before.
    pub(crate) fn solve_with(
        &self,
        curvature: &Curvature,
        sensed: &SensedDictionary,
        measurements: ArrayView2<f64>,
    ) -> Result<Solved> {
        self.check()?;
        let centred = sensed.centred(measurements);
        let mut solved = Solved::zeros(measurements.nrows(), sensed.atoms().nrows());
        let mut open = Open::new(sensed, &centred, curvature.0, self.lambda);
        for step in 1..=self.most_steps {
            open.step();
            let is_last = step == self.most_steps;
            if is_last || step % CHECK_EVERY == 0 {
                open.retire(self, is_last, &mut solved);
                if open.frames.is_empty() {
                    break;
                }
            }
        }
        Ok(solved)
    }

    fn check(&self) -> Result<()> {
        for (name, value) in [("lambda", self.lambda), ("tolerance", self.tolerance)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(Error::input(name, value, "a positive number"));
            }
        }
        if self.most_steps == 0 {
            return Err(Error::input("most steps", 0, "at least 1"));
        }
        Ok(())
    }
}

/// Upper bound of the largest eigenvalue of AᵀA, where A is the matrix of measured atoms.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Curvature(f64);

impl Curvature {
    pub(crate) fn new(sensed: &SensedDictionary) -> Self {
        let atoms = sensed.atoms();
        // A fixed start, so that results are repeatable; in practice it is not orthogonal to any eigenvector.
        let mut x = Array1::from_shape_fn(atoms.nrows(), |j| 1.0 + 0.5 * (j as f64 * 1.7).sin());
        let mut value = 0.0;
        for _ in 0..POWER_STEPS {
            x /= x.dot(&x).sqrt().max(f64::MIN_POSITIVE);
            x = atoms.dot(&x.dot(&atoms));
            value = x.dot(&x).sqrt();
        }
        // No eigenvalue exceeds the sum of all, ‖A‖²_F.
        let sum = atoms.iter().map(|a| a * a).sum::<f64>();
        Self((MARGIN * value).min(sum).max(f64::MIN_POSITIVE))
    }
}

/// Frame that has not converged.
struct OpenFrame {
    index: usize,
    /// Squared norm ‖y‖² of the frame's measurements y.
    square: f64,
    /// Penalty of the current stage; at least λ.
    penalty: f64,
    /// Momentum parameter of the FISTA iteration.
    momentum: f64,
}

/// Solver state of the frames that have not converged yet, one frame per row of each matrix.
struct Open<'a> {
    sensed: &'a SensedDictionary<'a>,
    /// Upper bound of the largest eigenvalue of AᵀA, where A is the matrix of measured atoms.
    curvature: f64,
    frames: Vec<OpenFrame>,
    /// Products Aᵀy of the measured atoms A with the measurements y, one row per frame.
    b: Array2<f64>,
    alpha: Array2<f64>,
    /// Extrapolated coefficients of the FISTA iteration, one row per frame.
    ahead: Array2<f64>,
}

impl<'a> Open<'a> {
    fn new(sensed: &'a SensedDictionary<'a>, y: &Array2<f64>, curvature: f64, lambda: f64) -> Self {
        let b = y.dot(&sensed.atoms().t());
        let steepest = |b: ArrayView1<f64>| b.iter().fold(lambda, |most, b| most.max(b.abs()));
        let rows = y.outer_iter().zip(b.outer_iter()).enumerate();
        let frames = rows.map(|(index, (y, b))| OpenFrame {
            index,
            square: y.dot(&y),
            penalty: (REDUCTION * steepest(b)).max(lambda),
            momentum: 1.0,
        });
        Self {
            sensed,
            curvature,
            frames: frames.collect(),
            alpha: Array2::zeros(b.dim()),
            ahead: Array2::zeros(b.dim()),
            b,
        }
    }

    /// Returns the gradient AᵀAα − Aᵀy at the coefficients `alpha`, computed with the smaller of the matrices AᵀA and A.
    fn gradient(&self, alpha: &Array2<f64>) -> Array2<f64> {
        let atoms = self.sensed.atoms();
        let mut gradient = self.b.clone();
        if atoms.nrows() <= 2 * atoms.ncols() {
            general_mat_mul(1.0, alpha, self.sensed.gram(), -1.0, &mut gradient);
        } else {
            general_mat_mul(1.0, &alpha.dot(&atoms), &atoms.t(), -1.0, &mut gradient);
        }
        gradient
    }

    fn step(&mut self) {
        let gradient = self.gradient(&self.ahead);
        let length = 1.0 / self.curvature;
        for ((row, gradient), frame) in gradient.outer_iter().enumerate().zip(&mut self.frames) {
            let (alpha, ahead) = (self.alpha.row_mut(row), self.ahead.row_mut(row));
            frame.step(alpha, ahead, gradient, length);
        }
    }

    /// Moves the converged frames to `solved` (all frames if `is_last`), and keeps the others.
    fn retire(&mut self, rule: &Lasso, is_last: bool, solved: &mut Solved) {
        let gradient = self.gradient(&self.alpha);
        let n_before = self.frames.len();
        let (mut row, mut kept) = (0..n_before, Vec::new());
        self.frames.retain_mut(|frame| {
            let row = row.next().expect("one row for each frame");
            let (alpha, b) = (self.alpha.row(row), self.b.row(row));
            let penalty = frame.penalty;
            let (primal, gap) = duality_gap(alpha, b, gradient.row(row), frame.square, penalty);
            if penalty > rule.lambda && gap <= STAGE_GAP * primal {
                frame.penalty = (REDUCTION * penalty).max(rule.lambda);
                frame.momentum = 1.0;
            }
            let is_solved = penalty == rule.lambda && gap <= rule.tolerance * primal;
            if is_solved || is_last {
                solved.coefficients.row_mut(frame.index).assign(&alpha);
                solved.capped[frame.index] = !is_solved;
                return false;
            }
            kept.push(row);
            true
        });
        if kept.len() < n_before {
            for matrix in [&mut self.b, &mut self.alpha, &mut self.ahead] {
                *matrix = matrix.select(Axis(0), &kept);
            }
        }
    }
}

impl OpenFrame {
    /// Performs one proximal gradient step from the extrapolated coefficients `ahead`, and computes the next extrapolated coefficients. `length` is the length of
    /// the step.
    fn step(
        &mut self,
        mut alpha: ArrayViewMut1<f64>,
        mut ahead: ArrayViewMut1<f64>,
        gradient: ArrayView1<f64>,
        length: f64,
    ) {
        let threshold = self.penalty * length;
        let mut uphill = 0.0;
        // `ahead` becomes the new α and `alpha` the change; both are then swapped.
        Zip::from(&mut alpha)
            .and(&mut ahead)
            .and(&gradient)
            .for_each(|old, z, &g| {
                let moved = *z - length * g;
                let new = moved - moved.clamp(-threshold, threshold);
                let change = new - *old;
                uphill += (*z - new) * change;
                (*old, *z) = (change, new);
            });
        let grown = 0.5 * (1.0 + (1.0 + 4.0 * self.momentum * self.momentum).sqrt());
        let (weight, next) = match uphill > 0.0 {
            true => (0.0, 1.0),
            false => ((self.momentum - 1.0) / grown, grown),
        };
        self.momentum = next;
        Zip::from(&mut alpha).and(&mut ahead).for_each(|change, z| {
            let new = *z;
            *z = new + weight * *change;
            *change = new;
        });
    }
}

/// Returns the objective and the duality gap (objective minus dual value) at the coefficients α; b = Aᵀy, gradient = AᵀAα − b, square = ‖y‖².
fn duality_gap(
    alpha: ArrayView1<f64>,
    b: ArrayView1<f64>,
    gradient: ArrayView1<f64>,
    square: f64,
    lambda: f64,
) -> (f64, f64) {
    let along = alpha.dot(&b);
    let residual = square - along + alpha.dot(&gradient);
    let steepest = gradient.iter().fold(0.0f64, |most, g| most.max(g.abs()));
    let s = if steepest > lambda {
        lambda / steepest
    } else {
        1.0
    };
    let l1 = alpha.iter().map(|a| a.abs()).sum::<f64>();
    let primal = 0.5 * residual + lambda * l1;
    // ½‖y‖² − ½‖y − θ‖² with y·(y − Aα) = ‖y‖² − αᵀb.
    let dual = s * (square - along) - 0.5 * s * s * residual;
    (primal, primal - dual)
}
