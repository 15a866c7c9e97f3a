//! Forward selection of taxels by validation accuracy.
//!
//! The validated classifier is the nearest neighbour in the selected taxels, each divided by its standard deviation over the training frames. A frame is
//! validated against all frames of other groups (leave one group out); it is correct if its nearest frame has its class. If several frames are equally near, as
//! for readings of few levels, it counts as the fraction of them that have its class. Let dᵢⱼ be the squared distance of frames i and j in the taxels selected
//! so far. A candidate with readings a gives dᵢⱼ + (aᵢ − aⱼ)², so that each candidate costs one pass over all pairs.
//!
//! Each step adds the candidate with the most correct frames. If these numbers are equal, the candidate is added that has the largest sum of margins (o −
//! s) / (o + s). Here s is the squared distance of a frame to the nearest frame of its class, and o that to the nearest frame of other classes. If these sums are
//! equal too, the candidate with the largest sum of √o is added. With one frame of each class, only this sum differs.

use crate::error::{Error, Result};
use crate::random::Seed;
use crate::sensing::TrainingFrames;
use ndarray::{Array2, ArrayView2, Axis};
use rand::seq::index::sample;
use rayon::prelude::*;
use std::ops::Range;

/// Maximum number of validated frames. With more frames, the accuracy is more precise; time and memory grow with the square of the number.
const MAX_FRAMES: usize = 1024;

/// Maximum number of candidates of a step. If more taxels are left, the candidates of each step are drawn at random (stochastic greedy; Mirzasoleiman et al.
/// 2015, *Lazier than lazy greedy*, AAAI). A step then misses the best 1 % of the taxels with a probability of 0.99²⁵⁶ = 8 %. With more candidates, the
/// selection takes longer; with fewer, it is closer to a random selection.
const MAX_CANDIDATES: usize = 256;

/// Number of distances that are compared together, one per lane of vector registers.
const LANES: usize = 16;

/// Returns m ≤ n taxels in the order of their selection. Taxels whose readings are equal in all frames carry no information and are selected last.
///
/// # Errors
/// If the classes of the frames are unknown.
pub(crate) fn greedy_taxels(
    training: &TrainingFrames,
    m: usize,
    seed: &Seed,
) -> Result<Vec<usize>> {
    if training.labels.is_empty() {
        let allowed = "frames with labels, or another method of selection";
        return Err(Error::input("selection", "greedy without labels", allowed));
    }
    let mut validated = Validated::new(training);
    let (mut left, constant) = validated.varying_taxels();
    let mut rng = seed.rng();
    let mut selected = Vec::with_capacity(m);
    while selected.len() < m && !left.is_empty() {
        let mut candidates: Vec<usize> = match left.len() <= MAX_CANDIDATES {
            true => (0..left.len()).collect(),
            false => sample(&mut rng, left.len(), MAX_CANDIDATES).into_vec(),
        };
        candidates.sort_unstable();
        let scores = candidates.into_par_iter();
        let scores = scores.map(|place| (place, validated.score(left[place])));
        let scores: Vec<(usize, Score)> = scores.collect();
        // Among equal candidates, the first is selected.
        let best = scores
            .into_iter()
            .reduce(|a, b| if b.1 > a.1 { b } else { a });
        let (place, _) = best.expect("a taxel is left");
        let taxel = left.remove(place);
        validated.add(taxel);
        selected.push(taxel);
    }
    selected.extend(constant);
    selected.truncate(m);
    Ok(selected)
}

/// Score of a set of taxels: number of correct frames, then the sum of margins, then the sum of distances to other classes.
type Score = (f64, f64, f64);

/// Validated frames with the distances of all pairs in the selected taxels.
struct Validated {
    /// Standardised readings of each taxel, shape (n_taxels, n_frames); frames are ordered by class.
    readings: Array2<f32>,
    /// Range of the frames that have the class of a frame, for each frame.
    own: Vec<Range<usize>>,
    /// Squared distances dᵢⱼ, shape (n_frames, n_frames); infinite for frames of one group.
    distances: Array2<f32>,
}

impl Validated {
    fn new(training: &TrainingFrames) -> Self {
        let n = training.frames.nrows().min(MAX_FRAMES);
        let labels = &training.labels[..n];
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by_key(|&frame| labels[frame]);
        let group = |frame: usize| training.groups.get(frame).map_or(frame, |group| *group);
        let distances =
            Array2::from_shape_fn((n, n), |(i, j)| match group(order[i]) == group(order[j]) {
                true => f32::INFINITY,
                false => 0.0,
            });
        let mut own = Vec::with_capacity(n);
        for class in order.chunk_by(|a, b| labels[*a] == labels[*b]) {
            let start = own.len();
            own.extend(class.iter().map(|_| start..start + class.len()));
        }
        Self {
            readings: standardised(training.frames, &order),
            own,
            distances,
        }
    }

    /// Returns the taxels whose readings differ between frames, and the other taxels, both in ascending order.
    fn varying_taxels(&self) -> (Vec<usize>, Vec<usize>) {
        let readings = |taxel: usize| self.readings.row(taxel);
        let varies = |taxel: &usize| readings(*taxel).iter().any(|&value| value != 0.0);
        (0..self.readings.nrows()).partition(varies)
    }

    /// Returns the score of the selected taxels together with a candidate.
    fn score(&self, candidate: usize) -> Score {
        let readings = self.readings.row(candidate);
        let readings = readings.as_slice().expect("rows are whole");
        let (mut n_correct, mut margins, mut distances) = (0.0, 0.0, 0.0);
        for ((row, own), &reading) in self.distances.outer_iter().zip(&self.own).zip(readings) {
            let row = row.to_slice().expect("rows are whole");
            let least =
                |range: Range<usize>| nearest(&row[range.clone()], &readings[range], reading);
            let same = least(own.clone());
            let other = least(0..own.start).min(least(own.end..row.len()));
            if same < other {
                n_correct += 1.0;
            } else if same == other && same.is_finite() {
                let count = |range: Range<usize>| {
                    let pairs = row[range.clone()].iter().zip(&readings[range]);
                    let near = pairs.filter(|&(&d, &r)| squared(reading, (d, r)) == same);
                    near.count() as f64
                };
                n_correct += count(own.clone()) / count(0..row.len());
            }
            let (same, other) = (f64::from(same), f64::from(other));
            if (same + other).is_finite() && same + other > 0.0 {
                margins += (other - same) / (other + same);
            }
            if other.is_finite() {
                distances += other.sqrt();
            }
        }
        (n_correct, margins, distances)
    }

    fn add(&mut self, taxel: usize) {
        let readings = self.readings.row(taxel);
        let readings = readings.as_slice().expect("rows are whole");
        for (mut row, &reading) in self.distances.outer_iter_mut().zip(readings) {
            for (distance, &other) in row.iter_mut().zip(readings) {
                *distance += (reading - other) * (reading - other);
            }
        }
    }
}

/// Returns dⱼ + (a − aⱼ)² for a = `reading`.
fn squared(reading: f32, (distance, other): (f32, f32)) -> f32 {
    distance + (reading - other) * (reading - other)
}

/// Returns the smallest of dⱼ + (a − aⱼ)²; infinity if there is none.
fn nearest(distances: &[f32], readings: &[f32], reading: f32) -> f32 {
    let mut lanes = [f32::INFINITY; LANES];
    let (mut d, mut r) = (distances.chunks_exact(LANES), readings.chunks_exact(LANES));
    for (distances, readings) in d.by_ref().zip(r.by_ref()) {
        for lane in 0..LANES {
            let distance = squared(reading, (distances[lane], readings[lane]));
            lanes[lane] = if distance < lanes[lane] {
                distance
            } else {
                lanes[lane]
            };
        }
    }
    let rest = d.remainder().iter().zip(r.remainder());
    let rest = rest.map(|(&distance, &other)| squared(reading, (distance, other)));
    lanes.into_iter().chain(rest).fold(f32::INFINITY, f32::min)
}

/// Returns the readings of each taxel in the given order of frames, shape (n_taxels, n_frames), divided by their standard deviation about the mean. The
/// readings of a taxel that are all equal become 0.
fn standardised(frames: ArrayView2<f64>, order: &[usize]) -> Array2<f32> {
    let mut readings = Array2::zeros((frames.ncols(), order.len()));
    let taxels = frames.axis_iter(Axis(1));
    for (taxel, mut out) in taxels.zip(readings.outer_iter_mut()) {
        let values = || order.iter().map(|&frame| taxel[frame]);
        let first = values().next().unwrap_or(0.0);
        if values().all(|value| value == first) {
            continue;
        }
        let n = order.len() as f64;
        let mean = values().sum::<f64>() / n;
        let variance = values().map(|value| (value - mean).powi(2)).sum::<f64>() / n;
        let std = variance.sqrt();
        for (out, value) in out.iter_mut().zip(values()) {
            *out = ((value - mean) / std) as f32;
        }
    }
    readings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensing::Selection;

    /// Returns 60 frames of 18 taxels, their classes and their groups of two frames each.
    fn training() -> (Array2<f64>, Vec<usize>, Vec<usize>) {
        let labels: Vec<usize> = (0..60).map(|frame| (frame / 2) % 4).collect();
        let groups = (0..60).map(|frame| frame / 2).collect();
        let frames = Array2::from_shape_fn((60, 18), |(frame, taxel)| {
            let of_class = ((labels[frame] * 7 + taxel * 3) as f64).sin();
            let of_group = ((frame / 2 * 31 + taxel * 17) as f64 * 1.3).sin();
            of_class * (taxel % 5) as f64 * 0.3 + of_group + 0.01 * (frame % 2) as f64
        });
        (frames, labels, groups)
    }

    /// Returns the score of a set of taxels, computed from the definition.
    fn slow_score(taxels: &[usize], training: &TrainingFrames) -> Score {
        let frames = training.frames;
        let scaled = |frame: usize, taxel: usize| {
            let column = frames.column(taxel);
            let mean = column.mean().unwrap();
            let variance = column.mapv(|v| (v - mean).powi(2)).mean().unwrap();
            (frames[[frame, taxel]] - mean) / variance.sqrt()
        };
        let (mut n_correct, mut margins, mut distances) = (0.0, 0.0, 0.0);
        for i in 0..frames.nrows() {
            let (mut nearest, mut n_near) = ([f64::INFINITY; 2], [0.0; 2]);
            for j in (0..frames.nrows()).filter(|&j| training.groups[j] != training.groups[i]) {
                let differences = taxels
                    .iter()
                    .map(|&taxel| scaled(i, taxel) - scaled(j, taxel));
                let distance: f64 = differences.map(|d| d * d).sum();
                let class = usize::from(training.labels[i] != training.labels[j]);
                // Sums of equal terms in another order differ by rounding.
                if distance < nearest[class] - 1e-9 {
                    (nearest[class], n_near[class]) = (distance, 0.0);
                }
                n_near[class] += f64::from(u8::from(distance < nearest[class] + 1e-9));
            }
            let [same, other] = nearest;
            n_correct += match (same - other).abs() < 1e-9 {
                true => n_near[0] / (n_near[0] + n_near[1]),
                false => f64::from(u8::from(same < other)),
            };
            if same + other > 0.0 {
                margins += (other - same) / (other + same);
            }
            distances += other.sqrt();
        }
        (n_correct, margins, distances)
    }

    /// Returns the first m taxels that greedy selection selects.
    fn selected(frames: &Array2<f64>, labels: &[usize], groups: &[usize], m: usize) -> Vec<usize> {
        let training = TrainingFrames {
            frames: frames.view(),
            labels,
            groups,
            selection: Selection::Greedy,
        };
        greedy_taxels(&training, m, &Seed::new(1)).unwrap()
    }

    #[test]
    fn each_step_adds_the_taxel_that_brute_force_finds() {
        let (frames, labels, groups) = training();
        // Readings of two levels have many equally near frames.
        let touched = frames.mapv(|reading| f64::from(u8::from(reading > 0.4)));
        for frames in [frames, touched] {
            let score = |taxels: &[usize]| {
                let training = TrainingFrames {
                    labels: &labels,
                    groups: &groups,
                    ..TrainingFrames::from(frames.view())
                };
                slow_score(taxels, &training)
            };
            let mut slow: Vec<usize> = Vec::new();
            while slow.len() < 6 {
                let left = (0..18).filter(|taxel| !slow.contains(taxel));
                let scores = left.map(|taxel| (score(&[&slow[..], &[taxel]].concat()), taxel));
                let best = scores.reduce(|a, b| if b.0 > a.0 { b } else { a });
                slow.push(best.unwrap().1);
            }
            assert_eq!(selected(&frames, &labels, &groups, 6), slow);
        }
    }

    #[test]
    fn one_of_equally_near_frames_counts_by_their_classes() {
        // Taxels 0 to 9 are independent of the class; taxel 10 is on for 3 of 4 frames of one class and for 1 of 4 frames of the other.
        let labels: Vec<usize> = (0..80).map(|frame| frame % 2).collect();
        let frames = Array2::from_shape_fn((80, 11), |(frame, taxel)| {
            let is_on = match taxel {
                0..10 => (frame / 2) >> (taxel % 5) & 1 == 1,
                _ => ((frame / 2 + taxel) % 4 == 0) != (labels[frame] == 1),
            };
            f64::from(u8::from(is_on))
        });
        assert_eq!(selected(&frames, &labels, &[], 1), [10]);
    }

    #[test]
    fn one_frame_of_each_class_selects_the_taxel_that_separates_most_classes() {
        let frames = ndarray::arr2(&[[0.0, 0.0], [0.0, 1.0], [0.0, 2.0], [1.0, 3.0]]);
        assert_eq!(selected(&frames, &[0, 1, 2, 3], &[], 1), [1]);
    }

    #[test]
    fn a_frame_is_not_validated_against_its_own_group() {
        // Taxel 0 has one value per group, taxel 1 one value per class with errors in a few frames.
        let labels: Vec<usize> = (0..40).map(|frame| (frame / 2) % 2).collect();
        let groups: Vec<usize> = (0..40).map(|frame| frame / 2).collect();
        let frames = Array2::from_shape_fn((40, 2), |(frame, taxel)| match (taxel, frame % 9) {
            (0, _) => ((frame / 2 * 7919) % 20) as f64,
            (_, 0) => labels[frame] as f64 + 0.6,
            _ => labels[frame] as f64 + 0.001 * frame as f64,
        });
        assert_eq!(selected(&frames, &labels, &groups, 1), [1]);
        assert_eq!(selected(&frames, &labels, &[], 1), [0]);
    }

    #[test]
    fn taxels_that_never_change_are_selected_last() {
        let (mut frames, labels, groups) = training();
        frames.slice_mut(ndarray::s![.., 2..16]).fill(0.25);
        let mut taxels = selected(&frames, &labels, &groups, 6);
        taxels[..4].sort_unstable();
        assert_eq!(taxels, [0, 1, 16, 17, 2, 3]);
    }
}
