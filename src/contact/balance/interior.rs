//! The best motion where deflections go linearly with it, with ties and stops as they are: a convex problem in six unknowns, and in how far
//! each taxel is in.
//!
//! ```text
//! min over d, u of  ½ dᵀBd − w·d + Σ ½ k u²   with  u ≥ δ + g·d for each pair of the taxel,  u ≤ s
//! ```
//!
//! By Mehrotra's interior-point method \[ME\]: all forces are positive on the way, and what they are in the end says who carries. Nothing is
//! smoothed, and no spring is too stiff: every step is a least-squares problem in d ([`GradedRows`]).
//!
//! \[ME\] Mehrotra, *On the implementation of a primal–dual interior point method*, 1992.

use super::graded_rows::GradedRows;
use super::six::{Six, SixBySix, add_outer, dot, eigen, norm};
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
    /// B: eigenvalues, none of them negative, and eigenvectors.
    pub curvature: (Six, SixBySix),
    /// w.
    pub weight: Six,
    /// Taxels, in the order of their pairs.
    pub springs: Vec<Spring>,
    /// δ of each pair.
    pub deflections: Vec<f64>,
    /// g of each pair.
    pub slopes: Vec<Six>,
}

/// The best motion, and what carries there.
#[derive(Clone, Debug, Default)]
pub(super) struct Solution {
    /// d.
    pub motion: Six,
    /// Of each pair.
    pub forces: Vec<f64>,
    /// Of the stop of each taxel.
    pub stops: Vec<f64>,
    /// How far each taxel is in.
    pub inwards: Vec<f64>,
}

/// A point inside, where all forces and gaps are above zero; or a step from one.
struct Variables {
    motion: Six,
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
            self.lay(&at, &mut rows, |_| 0.0, |_| 0.0);
            let ahead = self.step(&at, &rows, |_| 0.0, |_| 0.0);
            let share = at.room_for(&ahead, 1.0);
            let after = at.mean_product_after(&ahead, share);
            let aim = mean * (after / mean).powi(3);
            let of_pair = |j: usize| aim - ahead.forces[j] * ahead.gaps[j];
            let of_stop = |i: usize| aim - ahead.stops[i] * ahead.rooms[i];
            self.lay(&at, &mut rows, of_pair, of_stop);
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
            motion: [0.0; 6],
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
    fn unbalanced(&self, at: &Variables) -> Six {
        let (values, vectors) = &self.curvature;
        let along: Six = std::array::from_fn(|k| values[k] * dot(&vectors[k], &at.motion));
        let mut left: Six = std::array::from_fn(|i| {
            (0..6).map(|k| along[k] * vectors[k][i]).sum::<f64>() - self.weight[i]
        });
        for (slope, force) in self.slopes.iter().zip(&at.forces) {
            for (left, slope) in left.iter_mut().zip(slope) {
                *left += force * slope;
            }
        }
        left
    }

    /// k u − Σ λ + τ.
    fn pull(&self, at: &Variables, i: usize) -> f64 {
        let spring = &self.springs[i];
        let pushed: f64 = at.forces[spring.pairs.clone()].iter().sum();
        spring.stiffness * at.inwards[i] - pushed + at.stops[i]
    }

    /// u − δ − g·d, less the gap.
    fn gap_error(&self, at: &Variables, i: usize, j: usize) -> f64 {
        at.inwards[i] - self.deflections[j] - dot(&self.slopes[j], &at.motion) - at.gaps[j]
    }

    /// Lays and factorises the rows of a step whose products aim at `of_pair` and `of_stop` above their own.
    fn lay(
        &self,
        at: &Variables,
        rows: &mut GradedRows,
        of_pair: impl Fn(usize) -> f64,
        of_stop: impl Fn(usize) -> f64,
    ) {
        rows.clear();
        let (values, vectors) = &self.curvature;
        for (value, vector) in values.iter().zip(vectors) {
            rows.add(*value, vector, 0.0);
        }
        for (i, spring) in self.springs.iter().enumerate() {
            let (mut mean, mut all, mut push) = ([0.0; 6], 0.0, 0.0);
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
                for (sum, slope) in mean.iter_mut().zip(&self.slopes[j]) {
                    *sum += weight * slope;
                }
            }
            mean = mean.map(|x| x / all);
            if spring.pairs.len() > 1 {
                for j in spring.pairs.clone() {
                    let (weight, ask) = asked(j);
                    let apart: Six = std::array::from_fn(|k| self.slopes[j][k] - mean[k]);
                    rows.add(weight, &apart, ask);
                }
            }
            let (firm, rest) = self.firm(at, i, &of_stop);
            let total = firm + all;
            rows.add(
                all * firm / total,
                &mean,
                (push * firm + all * rest) / total,
            );
        }
        rows.factorise();
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
        let motion = rows.solve(&self.unbalanced(at).map(|x| -x));
        let (n, n_pairs) = (self.springs.len(), self.deflections.len());
        let mut step = Variables {
            motion,
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
                pulled += weight * (dot(&self.slopes[j], &motion) - self.gap_error(at, i, j));
                pulled += product / at.gaps[j];
            }
            let inwards = pulled / (firm + all);
            step.inwards[i] = inwards;
            for j in spring.pairs.clone() {
                let product = of_pair(j) - at.forces[j] * at.gaps[j];
                let gap = inwards - dot(&self.slopes[j], &motion) + self.gap_error(at, i, j);
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
            motion: at.motion,
            forces: at.forces.clone(),
            stops: at.stops.clone(),
            inwards: at.inwards.clone(),
        }
    }

    /// The motion of length 1 that lowers the energy at a solution, ties and stops kept, if there is one: `curvature` is B with its negative
    /// eigenvalues.
    pub fn way_down(&self, found: &Solution, curvature: &SixBySix) -> Option<Six> {
        let mut hessian = *curvature;
        let size = curvature
            .iter()
            .flatten()
            .fold(0.0, |most: f64, x| most.max(x.abs()));
        let stiff = 1e6 * size.max(1.0);
        for (i, spring) in self.springs.iter().enumerate() {
            let carrying: Vec<usize> = spring
                .pairs
                .clone()
                .filter(|&j| found.forces[j] > 1e-9)
                .collect();
            let firm = if found.stops[i] > 1e-9 {
                stiff
            } else {
                spring.stiffness.min(stiff)
            };
            let weight = 1.0 / carrying.len().max(1) as f64;
            let mean: Six =
                std::array::from_fn(|k| carrying.iter().map(|&j| weight * self.slopes[j][k]).sum());
            if !carrying.is_empty() {
                add_outer(&mut hessian, firm, &mean, &mean);
            }
            for &j in carrying.iter().filter(|_| carrying.len() > 1) {
                let apart: Six = std::array::from_fn(|k| self.slopes[j][k] - mean[k]);
                add_outer(&mut hessian, stiff, &apart, &apart);
            }
        }
        let (values, vectors) = eigen(&hessian);
        let lowest = (0..6).fold(
            0,
            |least, k| if values[k] < values[least] { k } else { least },
        );
        (values[lowest] < -1e-6 * size).then_some(vectors[lowest])
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
