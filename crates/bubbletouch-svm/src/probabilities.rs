//! Probabilities of the classes of an SVM, by Platt scaling.
//!
//! A sigmoid `p = 1 / (1 + exp(a f + b))` maps the decision value f of a binary problem to the probability of its positive class. The sigmoid has the largest
//! likelihood with Platt's targets. These are not exactly 0 and 1, because few rows do not justify certain probabilities. For one-vs-one, the probabilities of
//! all pairs are combined to one probability per class (pairwise coupling). For one-vs-rest, the probabilities of all problems are divided by their sum.
//!
//! Decision values of training rows are too large, and would give too certain probabilities. Sigmoids are therefore fitted to rows that did not train.
//!
//! Sources: Platt, *Probabilistic outputs for support vector machines*, 1999. Lin, Lin, Weng, *A note on Platt's probabilistic outputs for support vector
//! machines*, Machine Learning 2007. Wu, Lin, Weng, *Probability estimates for multi-class classification by pairwise coupling*, JMLR 2004.

use linfa::dataset::{Label, Pr};
use linfa::traits::PredictInplace;
use ndarray::{Array1, Array2, ArrayBase, ArrayView1, ArrayView2, Axis, Data, Ix2};
use serde::{Deserialize, Serialize};

use crate::dataset::{Dataset, check_labels, rows};
use crate::multiclass::Multiclass;
use crate::precision::Precision;
use crate::predict::svm_model::SvmModel;
use crate::split::Split;
use crate::{Error, Result, SvmParams};

/// Maximum number of Newton steps for a sigmoid, and of passes of pairwise coupling. About ten are needed.
const MAX_STEPS: usize = 200;
/// Gradient of the mean loss at which a sigmoid is converged, and change of a probability at which coupling is.
const TOLERANCE: f64 = 1e-12;
/// Distance of the probabilities of pairs from 0 and 1, as in LIBSVM. Pairwise coupling divides by them.
const LEAST: f64 = 1e-7;

/// SVM with a sigmoid for each binary problem.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound(deserialize = "L: Label + Deserialize<'de>"))]
pub struct ProbabilisticSvm<L = usize> {
    svm: SvmModel<L>,
    sigmoids: Vec<Sigmoid>,
}

/// Sigmoid `1 / (1 + exp(a f + b))` of a decision value f.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sigmoid {
    /// Factor of the decision value; negative if larger values favour the positive class.
    pub a: f64,
    /// Constant part.
    pub b: f64,
}

impl Sigmoid {
    /// Fits a sigmoid to decision values of rows that are positive or not.
    ///
    /// # Errors
    /// If there are no positive or no negative rows.
    pub fn fit(values: &[f64], is_positive: &[bool]) -> Result<Self> {
        let n_positive = is_positive.iter().filter(|&&is| is).count();
        let n_negative = is_positive.len() - n_positive;
        if n_positive == 0 || n_negative == 0 {
            let given = format!("{n_positive} rows of the positive class and {n_negative} others");
            return Err(Error::input(
                "calibration",
                given,
                "rows of both are needed",
            ));
        }
        let (high, low) = (
            (n_positive as f64 + 1.0) / (n_positive as f64 + 2.0),
            1.0 / (n_negative as f64 + 2.0),
        );
        let target = |&is: &bool| if is { high } else { low };
        let rows = || values.iter().zip(is_positive.iter().map(target));
        let n = values.len() as f64;
        // Mean of −t ln p − (1 − t) ln (1 − p), with ln p = −ln(1 + exp(z)).
        let loss = |one: Self| {
            let each = rows().map(|(&f, t)| {
                let z = one.a * f + one.b;
                t * z + (-z.abs()).exp().ln_1p() + (-z).max(0.0)
            });
            each.sum::<f64>() / n
        };
        let prior = (n_negative as f64 + 1.0) / (n_positive as f64 + 1.0);
        let mut found = Self {
            a: 0.0,
            b: prior.ln(),
        };
        let mut least = loss(found);
        for _ in 0..MAX_STEPS {
            let ([mut g_a, mut g_b], [mut h_aa, mut h_ab, mut h_bb]) = ([0.0; 2], [0.0; 3]);
            for (&f, t) in rows() {
                let p = found.probability(f);
                let (slope, curvature) = (t - p, p * (1.0 - p));
                g_a += f * slope / n;
                g_b += slope / n;
                h_aa += f * f * curvature / n;
                h_ab += f * curvature / n;
                h_bb += curvature / n;
            }
            if g_a.abs().max(g_b.abs()) < TOLERANCE {
                break;
            }
            // A small ridge keeps the matrix positive definite where all probabilities are certain.
            let (h_aa, h_bb) = (h_aa + TOLERANCE, h_bb + TOLERANCE);
            let determinant = h_aa * h_bb - h_ab * h_ab;
            let (d_a, d_b) = (
                -(h_bb * g_a - h_ab * g_b) / determinant,
                -(h_aa * g_b - h_ab * g_a) / determinant,
            );
            let shorter = (0..60).map(|halvings| 0.5_f64.powi(halvings));
            let mut better = shorter.map(|step| {
                let one = Self {
                    a: found.a + step * d_a,
                    b: found.b + step * d_b,
                };
                (loss(one), one)
            });
            match better.find(|(loss, _)| *loss < least) {
                Some(step) => (least, found) = step,
                None => break,
            }
        }
        Ok(found)
    }

    /// Returns the probability of the positive class for a decision value.
    pub fn probability(&self, value: f64) -> f64 {
        1.0 / (1.0 + (self.a * value + self.b).exp())
    }
}

impl SvmParams {
    /// Trains an SVM on all rows, and its sigmoids on the decision values of rows that are held out in the given folds, as LIBSVM does.
    /// [`stratified_k_fold`](crate::split::stratified_k_fold) draws folds.
    ///
    /// # Errors
    /// If [`train`](Self::train) fails, a fold lacks a class or contains a row beyond the data, or there are no folds.
    pub fn train_with_probabilities(
        &self,
        data: &Dataset,
        folds: &[Split],
    ) -> Result<ProbabilisticSvm> {
        let svm = self.train(data)?;
        let (mut values, mut labels) = (Vec::new(), Vec::new());
        for fold in folds {
            let model = self.train(&rows(data, &fold.train)?)?;
            if model.classes() != svm.classes() {
                let given = format!(
                    "{} classes in the training rows of a fold",
                    model.classes().len()
                );
                let allowed = format!("all {} classes are needed", svm.classes().len());
                return Err(Error::input("folds", given, allowed));
            }
            let held_out = rows(data, &fold.test)?;
            values.push(model.decision_values(held_out.records.view())?);
            labels.extend(held_out.targets);
        }
        let values: Vec<ArrayView2<f64>> = values.iter().map(Array2::view).collect();
        let values = ndarray::concatenate(Axis(0), &values)
            .map_err(|_| Error::input("folds", "none", "at least one is needed"))?;
        ProbabilisticSvm::new(svm, values.view(), ArrayView1::from(&labels))
    }
}

impl<L: Label> SvmModel<L> {
    /// Adds probabilities, with sigmoids that are fitted to rows which did not train the SVM.
    ///
    /// # Errors
    /// If the features or labels are invalid, a label is none of the classes, or a class has no rows.
    pub fn with_probabilities(
        self,
        features: ArrayView2<f64>,
        labels: ArrayView1<L>,
    ) -> Result<ProbabilisticSvm<L>> {
        let values = self.decision_values(features)?;
        ProbabilisticSvm::new(self, values.view(), labels)
    }
}

impl<L: Label> ProbabilisticSvm<L> {
    fn new(svm: SvmModel<L>, values: ArrayView2<f64>, labels: ArrayView1<L>) -> Result<Self> {
        check_labels(values.nrows(), labels)?;
        let number = |label: &L| {
            let found = svm.classes().binary_search(label);
            found.map_err(|_| {
                let allowed = "labels of the training rows are allowed";
                Error::input("labels", format!("{label:?}"), allowed)
            })
        };
        let numbers = labels.iter().map(number).collect::<Result<Vec<_>>>()?;
        let problems = svm.multiclass().problems(svm.classes().len());
        let sigmoid =
            |((positive, negative), values): ((usize, Option<usize>), ArrayView1<f64>)| {
                let takes_part = |own: usize| negative.is_none_or(|negative| own == negative);
                let rows = numbers.iter().zip(values);
                let rows = rows.filter(|(own, _)| **own == positive || takes_part(**own));
                let (values, is_positive): (Vec<f64>, Vec<bool>) =
                    rows.map(|(&own, &value)| (value, own == positive)).unzip();
                Sigmoid::fit(&values, &is_positive)
            };
        let sigmoids = problems.into_iter().zip(values.columns());
        Ok(Self {
            sigmoids: sigmoids.map(sigmoid).collect::<Result<_>>()?,
            svm,
        })
    }

    /// Returns the SVM. Its labels are those of the votes; the class of the largest probability may be another one.
    pub fn svm(&self) -> &SvmModel<L> {
        &self.svm
    }

    /// Returns the sigmoid of each binary problem, in the order of [`SvmModel::problems`].
    pub fn sigmoids(&self) -> &[Sigmoid] {
        &self.sigmoids
    }

    /// Returns the classes, ascending: the order of the columns of [`probabilities`](Self::probabilities).
    pub fn classes(&self) -> &[L] {
        self.svm.classes()
    }

    /// Returns the probability of each class for each row of features, shape n_rows × n_classes. Column k belongs to `classes()[k]`; a row sums to 1.
    ///
    /// # Errors
    /// If the number of columns differs from training, or a feature is NaN or infinite.
    pub fn probabilities(&self, features: ArrayView2<f64>) -> Result<Array2<f64>> {
        let values = self.svm.decision_values(features)?;
        let n_classes = self.classes().len();
        let mut probabilities = Array2::zeros((values.nrows(), n_classes));
        for (values, mut row) in values.outer_iter().zip(probabilities.outer_iter_mut()) {
            let of_problems = values.iter().zip(&self.sigmoids);
            let of_problems: Vec<f64> = of_problems.map(|(&f, one)| one.probability(f)).collect();
            let found = match self.svm.multiclass() {
                Multiclass::OneVsRest => {
                    let all: f64 = of_problems.iter().sum();
                    of_problems.iter().map(|p| p / all).collect()
                }
                _ => coupled(&of_problems, n_classes),
            };
            row.assign(&Array1::from(found));
        }
        Ok(probabilities)
    }
}

/// Returns the probability of each class, given the probability of the first class of each pair (0, 1), (0, 2), …, (1, 2), …. The result minimises
/// `Σ_i Σ_j≠i (r_ji p_i − r_ij p_j)²` (the second method of Wu, Lin and Weng).
fn coupled(of_pairs: &[f64], n_classes: usize) -> Vec<f64> {
    let mut r = Array2::zeros((n_classes, n_classes));
    let pairs = Multiclass::OneVsOne.problems(n_classes).into_iter();
    for ((first, second), &p) in pairs.zip(of_pairs) {
        let second = second.expect("a pair of classes");
        r[(first, second)] = p.clamp(LEAST, 1.0 - LEAST);
        r[(second, first)] = 1.0 - r[(first, second)];
    }
    let q = Array2::from_shape_fn((n_classes, n_classes), |(i, j)| match i == j {
        true => r.column(i).dot(&r.column(i)),
        false => -r[(i, j)] * r[(j, i)],
    });
    let mut p = Array1::from_elem(n_classes, 1.0 / n_classes as f64);
    for _ in 0..MAX_STEPS {
        let before = p.clone();
        for class in 0..n_classes {
            let of_all = q.dot(&p);
            let change = (p.dot(&of_all) - of_all[class]) / q[(class, class)];
            p[class] += change;
            p /= 1.0 + change;
        }
        let changes = p.iter().zip(&before).map(|(now, then)| (now - then).abs());
        if changes.fold(0.0, f64::max) < TOLERANCE {
            break;
        }
    }
    p.to_vec()
}

/// Probability of `true` for labels that are `true` or `false`.
impl<F: Precision, D: Data<Elem = F>> PredictInplace<ArrayBase<D, Ix2>, Array1<Pr>>
    for ProbabilisticSvm<bool>
{
    /// Writes the probability of `true` for each row.
    ///
    /// # Panics
    /// If the features are invalid or `targets` has a wrong length. The method `probabilities` returns an error instead.
    fn predict_inplace(&self, features: &ArrayBase<D, Ix2>, targets: &mut Array1<Pr>) {
        match self.probabilities(F::double_features(features).view()) {
            Ok(found) => targets.assign(&found.column(1).mapv(|p| Pr::new(p as f32))),
            Err(error) => panic!("{error}"),
        }
    }

    fn default_target(&self, features: &ArrayBase<D, Ix2>) -> Array1<Pr> {
        Array1::default(features.nrows())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn consistent_pairs_give_their_probabilities() {
        let p: [f64; 4] = [0.1, 0.2, 0.3, 0.4];
        let pairs = Multiclass::OneVsOne.problems(4).into_iter();
        let of_pairs: Vec<f64> = pairs.map(|(i, j)| p[i] / (p[i] + p[j.unwrap()])).collect();
        for (found, wanted) in coupled(&of_pairs, 4).iter().zip(p) {
            assert!((found - wanted).abs() < 1e-10, "{found} {wanted}");
        }
        assert_eq!(coupled(&[0.75], 2).len(), 2);
        assert!((coupled(&[0.75], 2)[0] - 0.75).abs() < 1e-10);
    }

    #[test]
    fn a_sigmoid_is_that_of_scikit_learn() {
        // sklearn.calibration._SigmoidCalibration of scikit-learn 1.9.1 on these values: a_ and b_.
        let values: Vec<f64> = (0..40)
            .map(|k| ((k * 7 + 3) % 40) as f64 / 10.0 - 2.0)
            .collect();
        let is_positive: Vec<bool> = values
            .iter()
            .enumerate()
            .map(|(k, f)| f + ((k * 13) % 11) as f64 / 4.0 - 1.4 > 0.2)
            .collect();
        let found = Sigmoid::fit(&values, &is_positive).unwrap();
        assert!(
            (found.a + 2.21504998).abs() < 1e-4 && (found.b - 0.11424870).abs() < 1e-4,
            "{found:?}"
        );
        assert!(Sigmoid::fit(&values, &[true; 40]).is_err());
    }

    #[test]
    fn separable_values_give_finite_sigmoids() {
        let values = [-2.0, -1.0, 1.0, 2.0];
        let found = Sigmoid::fit(&values, &[false, false, true, true]).unwrap();
        assert!(found.a.is_finite() && found.a < 0.0, "{found:?}");
        let equal = Sigmoid::fit(&[0.0; 4], &[false, true, true, true]).unwrap();
        // Three positive rows of target 4/5, one negative row of 1/3.
        let wanted = (3.0 * 0.8 + 1.0 / 3.0) / 4.0;
        assert!((equal.probability(0.0) - wanted).abs() < 1e-9, "{equal:?}");
    }
}
