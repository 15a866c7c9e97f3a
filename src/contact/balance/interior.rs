//! The best motion where deflections go linearly with it, with ties and stops as they are: a convex problem in six unknowns a body, and in
//! how far each taxel is in.
//!
//! ```text
//! min over d, u of  ½ dᵀBd − w·d + Σ ½ k u²   with  u ≥ δ + g·d for each pair of the taxel,  u ≤ s
//! ```
//!
//! By Mehrotra's interior-point method \[ME\]: all forces are positive on the way, and what they are in the end says who carries. Nothing is
//! smoothed, and no spring is too stiff, nor what is rigid (k = s = 0): every step is a least-squares problem in d ([`GradedRows`]).
//!
//! \[ME\] Mehrotra, *On the implementation of a primal–dual interior point method*, 1992.

use super::graded_rows::GradedRows;
use super::pairs::Slopes;
use super::symmetric::{Factor, Symmetric, norm};
use std::ops::Range;

/// Steps at most; fifteen to thirty are usual.
const MAX_STEPS: usize = 80;
/// Error at which nothing is gained by going on, and the largest of a solution.
const DONE: f64 = 1e-15;
const GOOD: f64 = 1e-9;
/// How near a step may come to zero forces and gaps, as a share of the way there.
const NEARLY: f64 = 0.995;

/// A taxel of the problem; lengths and forces in units that make weight and stroke 1.
#[derive(Clone, Debug)]
pub(super) struct Spring {
    /// k.
    pub stiffness: f64,
    /// s.
    pub stroke: f64,
    /// Its places in the lists of pairs.
    pub pairs: Range<usize>,
}

/// The problem; everything in such units.
#[derive(Clone, Debug, Default)]
pub(super) struct Problem {
    /// B, positive definite.
    pub curvature: Symmetric,
    /// w.
    pub weight: Vec<f64>,
    /// Taxels, in the order of their pairs.
    pub springs: Vec<Spring>,
    /// δ of each pair.
    pub deflections: Vec<f64>,
    /// g of each pair.
    pub slopes: Slopes,
}

/// The best motion, and what carries there.
#[derive(Clone, Debug, Default)]
pub(super) struct Solution {
    /// d.
    pub motion: Vec<f64>,
    /// Of each pair.
    pub forces: Vec<f64>,
    /// Of the stop of each taxel.
    pub stops: Vec<f64>,
    /// How far each taxel is in.
    pub inwards: Vec<f64>,
}

/// A point inside, where all forces and gaps are above zero; or a step from one.
struct Variables {
    motion: Vec<f64>,
    /// u of each taxel.
    inwards: Vec<f64>,
    /// λ and its gap, of each pair.
    forces: Vec<f64>,
    gaps: Vec<f64>,
    /// The same of stops.
    stops: Vec<f64>,
    rooms: Vec<f64>,
}

impl Problem {
    /// Solves it; `None` if that takes too many steps.
    pub fn solve(&self) -> Option<Solution> {
        let root = self.curvature.factor(0.0)?;
        let mut at = self.start();
        let mut rows = GradedRows::default();
        let mut least = (f64::INFINITY, None);
        for _ in 0..MAX_STEPS {
            let error = self.error(&at);
            if !error.is_finite() {
                break;
            }
            if error < least.0 {
                least = (error, Some(self.solution(&at)));
            }
            if error <= DONE {
                break;
            }
            let mean = at.mean_product();
            self.lay(&at, (&mut rows, &root), |_| 0.0, |_| 0.0);
            let ahead = self.step(&at, &rows, |_| 0.0, |_| 0.0);
            let share = at.room_for(&ahead, 1.0);
            let after = at.mean_product_after(&ahead, share);
            let aim = mean * (after / mean).powi(3);
            let of_pair = |j: usize| aim - ahead.forces[j] * ahead.gaps[j];
            let of_stop = |i: usize| aim - ahead.stops[i] * ahead.rooms[i];
            self.lay(&at, (&mut rows, &root), of_pair, of_stop);
            let step = self.step(&at, &rows, of_pair, of_stop);
            let share = at.room_for(&step, NEARLY);
            at.go(&step, share);
        }
        least.1.filter(|_| least.0 <= GOOD)
    }

    fn start(&self) -> Variables {
        let n = self.springs.len().max(1) as f64;
        let deepest = |spring: &Spring| {
            let all = self.deflections[spring.pairs.clone()].iter();
            all.copied().fold(f64::NEG_INFINITY, f64::max)
        };
        let n_pairs = self.deflections.len();
        let mut at = Variables {
            motion: vec![0.0; self.weight.len()],
            inwards: Vec::new(),
            forces: vec![1.0 / n; n_pairs],
            gaps: vec![0.0; n_pairs],
            stops: Vec::new(),
            rooms: Vec::new(),
        };
        for spring in &self.springs {
            let inwards = deepest(spring).max(0.0);
            at.inwards.push(inwards);
            for j in spring.pairs.clone() {
                at.gaps[j] = (inwards - self.deflections[j]).max(1e-2);
            }
            at.stops.push(1.0 / n);
            at.rooms.push((spring.stroke - inwards).max(1e-2));
        }
        at
    }

    /// How far from the solution: what is left of the balance, of gaps, and of products.
    fn error(&self, at: &Variables) -> f64 {
        let mut worst = norm(&self.unbalanced(at));
        for (i, spring) in self.springs.iter().enumerate() {
            let pull = self.pull(at, i);
            worst = worst.max(pull.abs());
            worst = worst.max((spring.stroke - at.inwards[i] - at.rooms[i]).abs());
            worst = worst.max(at.stops[i] * at.rooms[i]);
            for j in spring.pairs.clone() {
                worst = worst.max(self.gap_error(at, i, j).abs());
                worst = worst.max(at.forces[j] * at.gaps[j]);
            }
        }
        worst
    }

    /// B d − w + Σ λ g.
    fn unbalanced(&self, at: &Variables) -> Vec<f64> {
        let mut left = self.curvature.times(&at.motion);
        for (left, weight) in left.iter_mut().zip(&self.weight) {
            *left -= weight;
        }
        for (pair, force) in at.forces.iter().enumerate() {
            self.add_slope(pair, *force, &mut left);
        }
        left
    }

    /// Adds `factor · g` of a pair.
    fn add_slope(&self, pair: usize, factor: f64, to: &mut [f64]) {
        for (body, slope) in self.slopes.of(pair) {
            let to = to[6 * *body as usize..].iter_mut();
            to.zip(slope).for_each(|(to, slope)| *to += factor * slope);
        }
    }

    /// k u − Σ λ + τ.
    fn pull(&self, at: &Variables, i: usize) -> f64 {
        let spring = &self.springs[i];
        let pushed: f64 = at.forces[spring.pairs.clone()].iter().sum();
        spring.stiffness * at.inwards[i] - pushed + at.stops[i]
    }

    /// u − δ − g·d, less the gap.
    fn gap_error(&self, at: &Variables, i: usize, j: usize) -> f64 {
        at.inwards[i] - self.deflections[j] - self.slopes.dot(j, &at.motion) - at.gaps[j]
    }

    /// Lays and factorises the rows of a step whose products aim at `of_pair` and `of_stop` above their own.
    fn lay(
        &self,
        at: &Variables,
        (rows, root): (&mut GradedRows, &Factor),
        of_pair: impl Fn(usize) -> f64,
        of_stop: impl Fn(usize) -> f64,
    ) {
        let n = self.weight.len();
        rows.clear(n);
        for k in 0..n {
            rows.add(1.0, (0..n).map(|i| root.row(i)[k]), 0.0);
        }
        for (i, spring) in self.springs.iter().enumerate() {
            let (mut mean, mut all, mut push) = (vec![0.0; n], 0.0, 0.0);
            let asked = |j: usize| {
                let weight = at.forces[j] / at.gaps[j];
                let product = of_pair(j) - at.forces[j] * at.gaps[j];
                (
                    weight,
                    weight * self.gap_error(at, i, j) - product / at.gaps[j],
                )
            };
            for j in spring.pairs.clone() {
                let (weight, ask) = asked(j);
                all += weight;
                push += ask;
                self.add_slope(j, weight, &mut mean);
            }
            mean.iter_mut().for_each(|x| *x /= all);
            if spring.pairs.len() > 1 {
                for j in spring.pairs.clone() {
                    let (weight, ask) = asked(j);
                    rows.add(weight, self.apart(j, &mean).into_iter(), ask);
                }
            }
            let (firm, rest) = self.firm(at, i, &of_stop);
            let total = firm + all;
            rows.add(
                all * firm / total,
                mean.into_iter(),
                (push * firm + all * rest) / total,
            );
        }
        rows.factorise();
    }

    /// g of a pair less a mean.
    fn apart(&self, pair: usize, mean: &[f64]) -> Vec<f64> {
        let mut apart: Vec<f64> = mean.iter().map(|x| -x).collect();
        self.add_slope(pair, 1.0, &mut apart);
        apart
    }

    /// k + φ of a taxel, φ the weight of its stop; and what its own equation asks for.
    fn firm(&self, at: &Variables, i: usize, of_stop: &impl Fn(usize) -> f64) -> (f64, f64) {
        let spring = &self.springs[i];
        let stop = at.stops[i] / at.rooms[i];
        let product = of_stop(i) - at.stops[i] * at.rooms[i];
        let room_error = spring.stroke - at.inwards[i] - at.rooms[i];
        let rest = stop * room_error - product / at.rooms[i] - self.pull(at, i);
        (spring.stiffness + stop, rest)
    }

    fn step(
        &self,
        at: &Variables,
        rows: &GradedRows,
        of_pair: impl Fn(usize) -> f64,
        of_stop: impl Fn(usize) -> f64,
    ) -> Variables {
        let left: Vec<f64> = self.unbalanced(at).iter().map(|x| -x).collect();
        let motion = rows.solve(&left);
        let (n, n_pairs) = (self.springs.len(), self.deflections.len());
        let mut step = Variables {
            motion: motion.clone(),
            inwards: vec![0.0; n],
            forces: vec![0.0; n_pairs],
            gaps: vec![0.0; n_pairs],
            stops: vec![0.0; n],
            rooms: vec![0.0; n],
        };
        for (i, spring) in self.springs.iter().enumerate() {
            let (firm, rest) = self.firm(at, i, &of_stop);
            let (mut all, mut pulled) = (0.0, rest);
            for j in spring.pairs.clone() {
                let weight = at.forces[j] / at.gaps[j];
                let product = of_pair(j) - at.forces[j] * at.gaps[j];
                all += weight;
                pulled += weight * (self.slopes.dot(j, &motion) - self.gap_error(at, i, j));
                pulled += product / at.gaps[j];
            }
            let inwards = pulled / (firm + all);
            step.inwards[i] = inwards;
            for j in spring.pairs.clone() {
                let product = of_pair(j) - at.forces[j] * at.gaps[j];
                let gap = inwards - self.slopes.dot(j, &motion) + self.gap_error(at, i, j);
                step.gaps[j] = gap;
                step.forces[j] = (product - at.forces[j] * gap) / at.gaps[j];
            }
            let product = of_stop(i) - at.stops[i] * at.rooms[i];
            let room = spring.stroke - at.inwards[i] - at.rooms[i] - inwards;
            step.rooms[i] = room;
            step.stops[i] = (product - at.stops[i] * room) / at.rooms[i];
        }
        step
    }

    fn solution(&self, at: &Variables) -> Solution {
        Solution {
            motion: at.motion.clone(),
            forces: at.forces.clone(),
            stops: at.stops.clone(),
            inwards: at.inwards.clone(),
        }
    }

    /// The motion of length 1 that lowers the energy at a solution, ties and stops kept, if there is one: `curvature` is B with its negative
    /// eigenvalues.
    pub fn way_down(&self, found: &Solution, curvature: &Symmetric) -> Option<Vec<f64>> {
        let mut hessian = curvature.clone();
        let (n, size) = (self.weight.len(), curvature.size());
        let stiff = 1e6 * size.max(1.0);
        for (i, spring) in self.springs.iter().enumerate() {
            let is_carrying = |j: &usize| found.forces[*j] > 1e-9;
            let carrying: Vec<usize> = spring.pairs.clone().filter(is_carrying).collect();
            let firm = if found.stops[i] > 1e-9 {
                stiff
            } else {
                spring.stiffness.min(stiff)
            };
            let mut mean = vec![0.0; n];
            for &j in &carrying {
                self.add_slope(j, 1.0 / carrying.len() as f64, &mut mean);
            }
            hessian.add_outer(firm, &mean);
            for &j in carrying.iter().filter(|_| carrying.len() > 1) {
                hessian.add_outer(stiff, &self.apart(j, &mean));
            }
        }
        hessian.lowest_below(1e-6 * size).map(|(_, vector)| vector)
    }
}

impl Variables {
    fn mean_product(&self) -> f64 {
        let pairs = self.forces.iter().zip(&self.gaps);
        let stops = self.stops.iter().zip(&self.rooms);
        let sum: f64 = pairs.chain(stops).map(|(a, b)| a * b).sum();
        sum / (self.forces.len() + self.stops.len()).max(1) as f64
    }

    fn mean_product_after(&self, step: &Variables, share: f64) -> f64 {
        let both = |a: &[f64], da: &[f64], b: &[f64], db: &[f64]| -> f64 {
            (0..a.len())
                .map(|k| (a[k] + share * da[k]) * (b[k] + share * db[k]))
                .sum()
        };
        let sum = both(&self.forces, &step.forces, &self.gaps, &step.gaps)
            + both(&self.stops, &step.stops, &self.rooms, &step.rooms);
        sum / (self.forces.len() + self.stops.len()).max(1) as f64
    }

    /// The share of a step, at most 1, that stays inside; of the way to the first edge so much.
    fn room_for(&self, step: &Variables, nearly: f64) -> f64 {
        let mut share: f64 = 1.0;
        for (values, changes) in [
            (&self.forces, &step.forces),
            (&self.gaps, &step.gaps),
            (&self.stops, &step.stops),
            (&self.rooms, &step.rooms),
        ] {
            for (value, change) in values.iter().zip(changes) {
                if *change < 0.0 {
                    share = share.min(-nearly * value / change);
                }
            }
        }
        share
    }

    fn go(&mut self, step: &Variables, share: f64) {
        for (motion, change) in self.motion.iter_mut().zip(&step.motion) {
            *motion += share * change;
        }
        for (values, changes) in [
            (&mut self.inwards, &step.inwards),
            (&mut self.forces, &step.forces),
            (&mut self.gaps, &step.gaps),
            (&mut self.stops, &step.stops),
            (&mut self.rooms, &step.rooms),
        ] {
            for (value, change) in values.iter_mut().zip(changes) {
                *value += share * change;
            }
        }
    }
}
