//! Which pose of an unknown object to touch next: one at random, the farthest from those that were touched, or the one that is expected to tell most.
//!
//! A pose can be commanded, what lies there is known only when it is touched. After touches in poses x₁ … x_t, to whose frames a classifier answered
//! with labels a₁ … a_t, an object o is believed in with
//!
//! P(o) ∝ Π P(a_i | o, x_i), every object alike before the first touch.
//!
//! The answers that o gets in a pose x are learned from training touches, each answered by a classifier that has not learned it:
//!
//! P(a | o, x) = (Σ_i w_i [a_i = a] + s P(a | o)) / (Σ_i w_i + s), w_i = exp(−d²(x, x_i) / 2), over the training touches i of o,
//! P(a | o) = (n_oa + 1/n) / (n_o + 1), of n objects and n_o touches of o, of which n_oa are answered a.
//!
//! d² sums squares of differences along each axis of a pose, in bandwidths of that axis. These and s are those with the greatest likelihood of the answers,
//! each left out of what it is told from. The least expected entropy of P(o) after a touch in x is the greatest [information](PoseAnswers::information)
//!
//! I(O; A | x) = H(A | x) − Σ_o P(o) H(A | o, x), P(a | x) = Σ_o P(o) P(a | o, x) (Lindley, 1956).

use ndarray::{Array1, Array2, ArrayView1, Axis};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// How the touches after the first are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NextTouch {
    /// At random.
    #[default]
    Random,
    /// The pose that is farthest from the nearest one touched.
    Farthest,
    /// The pose with the least expected entropy of the belief.
    MostInformative,
}

/// Where touches are made.
#[derive(Clone, Debug, PartialEq)]
pub struct Poses {
    /// n_touches × n_axes, each axis in units of its range.
    pub coordinates: Array2<f64>,
    /// Of each axis what a full turn is in these units, if it is an angle of which turns come back.
    pub turns: Vec<Option<f64>>,
}

impl Poses {
    /// Those of some touches, by number, in this order.
    pub fn select(&self, touches: &[usize]) -> Self {
        Self {
            coordinates: self.coordinates.select(Axis(0), touches),
            turns: self.turns.clone(),
        }
    }

    /// The difference of two touches along an axis, the shorter way round.
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

    /// The sum of squared differences of two touches, each axis in units of its bandwidth.
    fn squared_distance(&self, bandwidths: &[f64], a: usize, b: usize) -> f64 {
        let along = bandwidths.iter().enumerate();
        let along = along.map(|(axis, bandwidth)| self.difference(axis, a, b) / bandwidth);
        along.map(|apart| apart * apart).sum()
    }

    /// Which of the touches that are left is farthest from the nearest one made, by its place; of equals the first.
    ///
    /// # Panics
    /// If none is made, or none left.
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

/// Training touches and what they were answered by classifiers that had not learned them.
#[derive(Clone, Debug)]
pub struct AnswerModel<'a> {
    poses: &'a Poses,
    /// Of each object its touches with their answers.
    answered: Vec<Vec<(usize, usize)>>,
    /// A bandwidth of each axis, in units of its range.
    bandwidths: Vec<f64>,
    /// s: how many touches in the very pose the answers in all poses count for.
    strength: f64,
}

/// Bandwidths that are tried. Narrower, and a pose has no neighbours; beyond 1 an axis counts for little, and at infinity for nothing.
const BANDWIDTHS: [f64; 5] = [0.05, 0.1, 0.2, 0.4, f64::INFINITY];
/// Strengths that are tried: few touches in a pose say little, many all.
const STRENGTHS: [f64; 3] = [1.0, 5.0, 25.0];
/// How often each axis is tried again when others have changed.
const PASSES: usize = 2;

impl<'a> AnswerModel<'a> {
    /// Of touches (number of its pose, object, answer), for objects and answers below `n_objects`.
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

    /// Gives one of its numbers the likeliest of some values.
    fn choose<const N: usize>(&mut self, values: [f64; N], number: impl Fn(&mut Self) -> &mut f64) {
        let likelihoods = values.map(|value| {
            *number(self) = value;
            self.log_likelihood()
        });
        *number(self) = values[first_greatest(likelihoods)];
    }

    /// ln of the probability of all answers, each told from the others.
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

    /// What each object is answered in the pose of a touch.
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

/// The probabilities of answers in a pose.
#[derive(Clone, Debug)]
pub struct PoseAnswers {
    /// P(a | o): n_objects × n_answers, positive, each row with the sum 1.
    given: Array2<f64>,
    /// H(A | o), nats.
    entropies: Array1<f64>,
}

impl PoseAnswers {
    /// Of P(a | o): n_objects × n_answers, positive, each row with the sum 1.
    pub fn new(given: Array2<f64>) -> Self {
        Self {
            entropies: given.map_axis(Axis(1), entropy),
            given,
        }
    }

    /// The belief in each object after an answer.
    pub fn believe(&self, belief: &mut Array1<f64>, answer: usize) {
        *belief *= &self.given.column(answer);
        *belief /= belief.sum();
    }

    /// I(O; A): by how much the entropy of the belief is expected to fall, nats.
    pub fn information(&self, belief: &Array1<f64>) -> f64 {
        entropy(belief.dot(&self.given).view()) - belief.dot(&self.entropies)
    }
}

/// Which of the poses that are left tells most after the answers to those made, by its place; of equals the first. Poses and answers go by the number of a
/// touch; answers of `left` are not looked at.
pub fn most_informative(
    (poses, answers): (&[PoseAnswers], &[usize]),
    made: &[usize],
    left: &[usize],
) -> usize {
    let n_objects = poses[left[0]].given.nrows();
    let mut belief = Array1::from_elem(n_objects, 1.0 / n_objects as f64);
    for &touch in made {
        poses[touch].believe(&mut belief, answers[touch]);
    }
    first_greatest(left.iter().map(|&touch| poses[touch].information(&belief)))
}

/// k ≤ n of the touches `0..n`, the first given, each other one chosen among those that are left: of those made and those left, in rising order, `next`
/// says the place of one among the latter.
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

/// The place of the greatest of some numbers, of equals the first.
fn first_greatest(values: impl IntoIterator<Item = f64>) -> usize {
    let values = values.into_iter().enumerate();
    let greatest = values.reduce(|best, one| if one.1 > best.1 { one } else { best });
    greatest.expect("at least one number").0
}
