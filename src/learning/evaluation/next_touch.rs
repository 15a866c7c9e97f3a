//! Choice of the next pose for touching an unknown object: random, farthest from previous touches, or most informative.
//!
//! The robot can choose the pose, but the label of the touch is known only afterwards. A classifier assigns labels a₁ … a_t to touches in poses x₁ … x_t. The
//! posterior probability (belief) of object o is
//!
//! P(o) ∝ Π P(a_i | o, x_i), with a uniform prior.
//!
//! The label probabilities of object o in pose x are estimated from training touches. A classifier that was not trained on a touch labels it:
//!
//! P(a | o, x) = (Σ_i w_i [a_i = a] + s P(a | o)) / (Σ_i w_i + s), w_i = exp(−d²(x, x_i) / 2), over the training touches i of o,
//! P(a | o) = (n_oa + 1/n) / (n_o + 1), for n objects and n_o touches of o, of which n_oa have the label a.
//!
//! The distance d² sums squared differences along the axes of a pose, each divided by the bandwidth of its axis. The bandwidths and s maximise the
//! leave-one-out likelihood of the labels. The most informative pose has the lowest expected entropy of P(o) after the touch, that is, the greatest mutual
//! information
//!
//! I(O; A | x) = H(A | x) − Σ_o P(o) H(A | o, x), P(a | x) = Σ_o P(o) P(a | o, x) (Lindley, 1956).

use crate::inputs::params::words;
use ndarray::{Array1, Array2, ArrayView1, Axis};
use rayon::prelude::*;

words! {
    /// Rule that chooses the pose of each touch after the first touch.
    pub enum NextTouch = Random {
        /// Pose that is drawn at random from all poses.
        Random = "random",
        /// Pose with the largest distance to the nearest previous touch.
        Farthest = "farthest",
        /// Pose after which the expected entropy (uncertainty) of the probabilities of the objects is lowest.
        MostInformative = "most_informative",
    }
}

/// Poses of touches in normalised coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Poses {
    /// Coordinates of the poses, n_touches × n_axes, each axis in units of its range.
    pub coordinates: Array2<f64>,
    /// Size of a full turn on each axis, in units of the axis range, if the axis is a periodic angle; otherwise `None`.
    pub turns: Vec<Option<f64>>,
}

impl Poses {
    /// Returns the poses of the touches with the given numbers, in the given order.
    pub fn select(&self, touches: &[usize]) -> Self {
        Self {
            coordinates: self.coordinates.select(Axis(0), touches),
            turns: self.turns.clone(),
        }
    }

    /// Returns the absolute difference of the poses `a` and `b` along an axis; for a periodic axis, the shorter way around.
    fn difference(&self, axis: usize, a: usize, b: usize) -> f64 {
        let apart = (self.coordinates[[a, axis]] - self.coordinates[[b, axis]]).abs();
        match self.turns[axis] {
            None => apart,
            Some(turn) => {
                let apart = apart.rem_euclid(turn);
                apart.min(turn - apart)
            }
        }
    }

    /// Returns the squared distance of two poses, summed over all axes, with each axis in units of its bandwidth.
    fn squared_distance(&self, bandwidths: &[f64], a: usize, b: usize) -> f64 {
        let along = bandwidths.iter().enumerate();
        let along = along.map(|(axis, bandwidth)| self.difference(axis, a, b) / bandwidth);
        along.map(|apart| apart * apart).sum()
    }

    /// Returns the position in `left` of the touch whose pose is farthest from its nearest pose in `made`; the first of equals.
    ///
    /// # Panics
    /// If `made` or `left` is empty.
    pub fn farthest(&self, made: &[usize], left: &[usize]) -> usize {
        let units = vec![1.0; self.turns.len()];
        let nearest = |&touch: &usize| {
            let distances = made.iter();
            let distances = distances.map(|&other| self.squared_distance(&units, touch, other));
            distances.min_by(f64::total_cmp).expect("a touch is made")
        };
        first_greatest(left.iter().map(nearest))
    }
}

/// Probability model of the labels that a classifier predicts for each object and pose. The training touches were labelled by classifiers that were not trained
/// on them.
#[derive(Clone, Debug)]
pub struct AnswerModel<'a> {
    poses: &'a Poses,
    /// Touches of each object, with the labels that were predicted for them.
    answered: Vec<Vec<(usize, usize)>>,
    /// Bandwidth of each pose axis, in units of the axis range.
    bandwidths: Vec<f64>,
    /// Weight of the prior, as a number of touches. The label frequencies over all poses count as much as this number of touches near the pose.
    strength: f64,
}

/// Candidate bandwidths of a pose axis, in units of the axis range. With smaller bandwidths, a pose has no neighbours. A bandwidth above 1 gives an axis little
/// influence, an infinite bandwidth none.
const BANDWIDTHS: [f64; 5] = [0.05, 0.1, 0.2, 0.4, f64::INFINITY];
/// Candidate strengths of the prior, as numbers of touches. If small, few touches near a pose determine the probabilities; if large, many touches are needed.
const STRENGTHS: [f64; 3] = [1.0, 5.0, 25.0];
/// Number of passes over the parameters of the model; each pass optimises every parameter once.
const PASSES: usize = 2;

impl<'a> AnswerModel<'a> {
    /// Fits the model to labelled touches, given as (pose number, object, label). Objects and labels are below `n_objects`.
    pub fn new(poses: &'a Poses, touches: &[(usize, usize, usize)], n_objects: usize) -> Self {
        let mut answered = vec![Vec::new(); n_objects];
        for &(touch, object, answer) in touches {
            answered[object].push((touch, answer));
        }
        let mut model = Self {
            poses,
            answered,
            bandwidths: vec![f64::INFINITY; poses.turns.len()],
            strength: STRENGTHS[1],
        };
        for _ in 0..PASSES {
            for axis in 0..poses.turns.len() {
                model.choose(BANDWIDTHS, |model| &mut model.bandwidths[axis]);
            }
            model.choose(STRENGTHS, |model| &mut model.strength);
        }
        model
    }

    /// Sets the parameter that `number` returns to the candidate value with the highest likelihood.
    fn choose<const N: usize>(&mut self, values: [f64; N], number: impl Fn(&mut Self) -> &mut f64) {
        let likelihoods = values.map(|value| {
            *number(self) = value;
            self.log_likelihood()
        });
        *number(self) = values[first_greatest(likelihoods)];
    }

    /// Returns the log-likelihood of all labels, where each label is predicted from all other touches (leave-one-out).
    fn log_likelihood(&self) -> f64 {
        let share = 1.0 / self.answered.len() as f64;
        let of_object = |answered: &Vec<(usize, usize)>| -> f64 {
            let told = answered.iter().map(|&(touch, answer)| {
                let (mut n_alike, mut alike, mut all) = (0.0, 0.0, self.strength);
                for &(other, given) in answered.iter().filter(|(other, _)| *other != touch) {
                    let weight = self.weight(touch, other);
                    all += weight;
                    if given == answer {
                        (n_alike, alike) = (n_alike + 1.0, alike + weight);
                    }
                }
                let overall = (n_alike + share) / answered.len() as f64;
                ((self.strength * overall + alike) / all).ln()
            });
            told.sum()
        };
        let of_objects: Vec<f64> = self.answered.par_iter().map(of_object).collect();
        of_objects.iter().sum()
    }

    fn weight(&self, a: usize, b: usize) -> f64 {
        (-0.5 * self.poses.squared_distance(&self.bandwidths, a, b)).exp()
    }

    /// Returns the probabilities of all labels for each object in the pose of the given touch.
    pub fn at(&self, touch: usize) -> PoseAnswers {
        let n = self.answered.len();
        let mut given = Array2::from_elem((n, n), 1.0 / n as f64);
        for (mut row, answered) in given.outer_iter_mut().zip(&self.answered) {
            answered.iter().for_each(|&(_, answer)| row[answer] += 1.0);
            row *= self.strength / (answered.len() as f64 + 1.0);
            let mut all = self.strength;
            for &(other, answer) in answered {
                let weight = self.weight(touch, other);
                row[answer] += weight;
                all += weight;
            }
            row /= all;
        }
        PoseAnswers::new(given)
    }
}

/// Probability of each label for each object, for touches in one pose.
#[derive(Clone, Debug)]
pub struct PoseAnswers {
    /// Conditional probability of each label given each object, n_objects × n_answers, positive; each row sums to 1.
    given: Array2<f64>,
    /// Entropy of the label probabilities of each object, nats.
    entropies: Array1<f64>,
}

impl PoseAnswers {
    /// Creates the probabilities from a matrix with one row per object and one column per label; entries are positive, and each row sums to 1.
    pub fn new(given: Array2<f64>) -> Self {
        Self {
            entropies: given.map_axis(Axis(1), entropy),
            given,
        }
    }

    /// Updates the belief (the probability of each object) by Bayes' rule after the label `answer` is observed.
    pub fn update_belief(&self, belief: &mut Array1<f64>, answer: usize) {
        *belief *= &self.given.column(answer);
        *belief /= belief.sum();
    }

    /// Returns the mutual information of object and label in this pose, nats: the expected reduction of the entropy of `belief`.
    pub fn information(&self, belief: &Array1<f64>) -> f64 {
        entropy(belief.dot(&self.given).view()) - belief.dot(&self.entropies)
    }
}

/// Returns the position in `left` of the most informative touch; the first if several are equally informative. The lists `poses` and `answers` are indexed by
/// touch. The belief is computed from the labels of the touches in `made`; the labels of the touches in `left` are not used.
pub fn most_informative(
    (poses, answers): (&[PoseAnswers], &[usize]),
    made: &[usize],
    left: &[usize],
) -> usize {
    let n_objects = poses[left[0]].given.nrows();
    let mut belief = Array1::from_elem(n_objects, 1.0 / n_objects as f64);
    for &touch in made {
        poses[touch].update_belief(&mut belief, answers[touch]);
    }
    first_greatest(left.iter().map(|&touch| poses[touch].information(&belief)))
}

/// Returns a sequence of k touches out of n (k ≤ n) that starts with the touch `first`. Each further touch is chosen by `next`, which receives the previous
/// touches in order and the remaining touches in ascending order. The result of `next` is a position in the list of remaining touches.
pub fn sequence(
    (first, k): (usize, usize),
    n: usize,
    next: impl Fn(&[usize], &[usize]) -> usize,
) -> Vec<usize> {
    let mut made = vec![first];
    let mut left: Vec<usize> = (0..n).filter(|&touch| touch != first).collect();
    while made.len() < k {
        let place = next(&made, &left);
        made.push(left.remove(place));
    }
    made
}

fn entropy(shares: ArrayView1<f64>) -> f64 {
    -shares.iter().map(|share| share * share.ln()).sum::<f64>()
}

/// Returns the index of the greatest value; the first index if several values are equal.
fn first_greatest(values: impl IntoIterator<Item = f64>) -> usize {
    let values = values.into_iter().enumerate();
    let greatest = values.reduce(|best, one| if one.1 > best.1 { one } else { best });
    greatest.expect("at least one number").0
}
