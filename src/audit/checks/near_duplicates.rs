//! Touches that are nearer to another touch than chance explains, such as copies and neighbouring frames of one recording.
//!
//! Touches are compared as recorded, without mean and scale, by features that do not depend on place and mirroring, and, if touches have several frames, by
//! their middle frame with all frames of other touches. Copies with another gain or offset, moved, mirrored or turned copies, and overlapping windows of one
//! recording are near-duplicates, too.

use crate::audit::check::{CheckAbout, Context, Finding, Result};
use crate::audit::checks::mean_reading::shapes;
use crate::audit::duplicate_pairs::{Comparison, DuplicatePairs};
use crate::audit::finding::percent;
use crate::audit::scores::{N_NEAREST, nearest};
use bubbletouch_sim::audit::duplicates::test_duplicates;
use bubbletouch_sim::audit::pooled::{pooled, symmetrised};
use bubbletouch_svm::audit::nearest_rows;
use ndarray::{Array2, ArrayView2, Axis, s};
use rayon::prelude::*;
use statrs::distribution::{DiscreteCDF, Poisson};
use std::collections::{BTreeMap, BTreeSet};

/// Probability that, by chance, at least one touch counts as a near-duplicate.
const ANY: f64 = 0.05;
/// Minimum relevant fraction of touches with a near-duplicate.
const RELEVANT: f64 = 0.001;
/// Maximum number of frames with which the middle frames of touches are compared.
const MAX_FRAMES: usize = 20_000;
/// Maximum number of block means of a frame.
const MAX_BLOCKS: usize = 256;
/// Number of touches that are compared together.
const BLOCK: usize = 250;

pub const ABOUT: CheckAbout = CheckAbout {
    name: "near_duplicates",
    title: "Near-duplicates",
    run,
};

/// Display words of the comparison of touches as recorded.
const AS_RECORDED: &str = "as recorded";

/// Returns the near-duplicates, which are found at the first call; `None` if there are too few different touches.
pub fn pairs(context: &Context) -> Option<&DuplicatePairs> {
    context
        .near_duplicates
        .get_or_init(|| find(context))
        .as_ref()
}

/// Finds near-duplicates. Returns `None` if there are too few different touches.
fn find(context: &Context) -> Option<DuplicatePairs> {
    let blocks = &context.features.blocks;
    // Rows with equal values of all blocks contain no contact.
    let has_contact: Vec<bool> = (blocks.std_axis(Axis(1), 0.0).iter())
        .map(|&std| std > 0.0)
        .collect();
    let own = context
        .scores
        .is_none()
        .then(|| nearest(blocks.view(), N_NEAREST, &[]));
    let (neighbours, distances) = match (&context.scores, &own) {
        (Some(scores), _) => (&scores.neighbours, &scores.distances),
        (None, Some(nearest)) => (&nearest.neighbours, &nearest.distances),
        (None, None) => return None,
    };
    let all: Vec<usize> = (0..context.labels.len()).collect();
    let compared = |words, rows: &[usize], neighbours: &[Vec<usize>], distances: &[Vec<f64>]| {
        let of = |list: &[usize]| -> Vec<usize> { rows.iter().map(|&row| list[row]).collect() };
        let is_tested: Vec<bool> = rows.iter().map(|&row| has_contact[row]).collect();
        let p_values = test_duplicates(distances, &is_tested, &of(&context.labels))?;
        let n = rows.len() as f64;
        let found = p_values.iter().enumerate().filter(|(_, p)| **p * n <= ANY);
        let found = found.map(|(place, &p)| (rows[place], neighbours[place][0], p));
        let found: Vec<(usize, usize, f64)> = found.collect();
        // Few pairs of derived features can be near by chance of the derivation, unless they are exact copies.
        let is_decisive = |place: &usize| {
            words == AS_RECORDED || (distances[*place].first() == Some(&0.0) && is_tested[*place])
        };
        let single = (0..rows.len()).filter(is_decisive);
        let single = single.map(|place| p_values[place] * n);
        Some(Comparison {
            words,
            n_tested: rows.len(),
            p_value: single.fold(p_value_of_pairs(&found, rows, neighbours), f64::min),
            found,
        })
    };
    let mut comparisons = vec![compared(AS_RECORDED, &all, neighbours, distances)?];
    let by_features = |words, rows: &Array2<f64>| {
        let near = nearest_of_sample(rows.view(), &context.sample);
        compared(words, &near.touches, &near.neighbours, &near.distances)
    };
    comparisons.extend(by_features(
        "without mean and scale",
        &shapes(blocks.clone()),
    ));
    if let Some(invariant) = &context.features.invariant {
        let rows = symmetrised(invariant.view(), context.features.image);
        comparisons.extend(by_features("moved, mirrored or turned", &rows));
    }
    if let Some(near) = nearest_windows(context) {
        comparisons.extend(compared(
            "shifted in time",
            &near.touches,
            &near.neighbours,
            &near.distances,
        ));
    }
    let n_comparisons = comparisons.len() as f64;
    let least = comparisons.iter().map(|c| c.p_value).fold(1.0, f64::min);
    let share = |c: &Comparison| c.found.len() as f64 / c.n_tested as f64;
    let share = comparisons.iter().map(share).fold(0.0, f64::max);
    let mut nearest = BTreeMap::<usize, (f64, usize)>::new();
    for &(row, other, p) in comparisons.iter().flat_map(|c| &c.found) {
        let known = nearest.entry(row).or_insert((p, other));
        if p < known.0 {
            *known = (p, other);
        }
    }
    let mut found: Vec<(f64, usize, usize)> = nearest
        .into_iter()
        .map(|(row, (p, other))| (p, row, other))
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    Some(DuplicatePairs {
        pairs: found
            .into_iter()
            .map(|(_, row, other)| (row, other))
            .collect(),
        p_value: (least * n_comparisons).min(1.0),
        share,
        comparisons,
    })
}

/// Returns the probability of at least as many pairs by chance. A pair counts if both touches are near-duplicates of each other, or if the other touch was not
/// tested.
///
/// The number of touches whose p-value is at most [`ANY`] divided by their number has at most the mean [`ANY`]. A pair of two tested touches needs two of them.
/// With the fraction f of touches whose nearest touch was tested, the mean number of pairs is therefore at most [`ANY`] (1 − f/2).
fn p_value_of_pairs(found: &[(usize, usize, f64)], tested: &[usize], near: &[Vec<usize>]) -> f64 {
    let nearest: BTreeMap<usize, usize> =
        found.iter().map(|&(row, other, _)| (row, other)).collect();
    let tested: BTreeSet<usize> = tested.iter().copied().collect();
    let is_pair = |&(row, other): &(&usize, &usize)| {
        !tested.contains(other) || (nearest.get(other) == Some(row) && row < other)
    };
    let n_pairs = nearest.iter().filter(is_pair).count() as u64;
    let nearest_tested = near.iter().filter(|near| tested.contains(&near[0]));
    let fraction = nearest_tested.count() as f64 / tested.len() as f64;
    match (n_pairs, Poisson::new(ANY * (1.0 - 0.5 * fraction))) {
        (1.., Ok(poisson)) => poisson.sf(n_pairs - 1),
        _ => 1.0,
    }
}

/// Nearest touches of some touches.
#[derive(Default)]
struct Near {
    /// Touches of which the nearest ones are known.
    touches: Vec<usize>,
    /// Indices of the nearest touches of each touch, the nearest first.
    neighbours: Vec<Vec<usize>>,
    /// Distances of the nearest touches of each touch, ascending.
    distances: Vec<Vec<f64>>,
}

/// Finds the nearest rows of the rows in `sample` among all rows.
fn nearest_of_sample(rows: ArrayView2<f64>, sample: &[usize]) -> Near {
    // Rows of the sample come first, so that they form blocks.
    let mut is_sampled = vec![false; rows.nrows()];
    sample.iter().for_each(|&row| is_sampled[row] = true);
    let others = (0..rows.nrows()).filter(|&row| !is_sampled[row]);
    let order: Vec<usize> = sample.iter().copied().chain(others).collect();
    let rows = rows.select(Axis(0), &order);
    let starts: Vec<usize> = (0..sample.len()).step_by(BLOCK).collect();
    let found = starts.into_par_iter().map(|start| {
        let block = start..(start + BLOCK).min(sample.len());
        nearest_rows(rows.view(), N_NEAREST, &[], block)
    });
    let mut near = Near {
        touches: sample.to_vec(),
        ..Near::default()
    };
    for block in found.collect::<Vec<_>>() {
        let neighbours = block.neighbours.into_iter();
        near.neighbours.extend(neighbours.map(|own| {
            own.into_iter()
                .map(|place| order[place])
                .collect::<Vec<_>>()
        }));
        near.distances.extend(block.distances);
    }
    near
}

/// Finds the nearest touches of the middle frames of sampled touches, compared with all frames of other touches. Returns `None` if touches have fewer than
/// three frames.
fn nearest_windows(context: &Context) -> Option<Near> {
    let data = &context.data;
    let n_frames = data.n_frames;
    let touches: Vec<usize> = (context.sample.iter().copied())
        .take((MAX_FRAMES / n_frames).max(1))
        .collect();
    if n_frames < 3 || touches.len() < 2 * N_NEAREST {
        return None;
    }
    let frames = touches
        .iter()
        .flat_map(|&touch| touch * n_frames..(touch + 1) * n_frames);
    let frames = data.frames.select(Axis(0), &frames.collect::<Vec<_>>());
    let frames = pooled(frames.view(), 1, data.grid, MAX_BLOCKS);
    let squares: Vec<f64> = frames.rows().into_iter().map(|row| row.dot(&row)).collect();
    let starts: Vec<usize> = (0..touches.len()).step_by(BLOCK).collect();
    let found = starts.into_par_iter().map(|start| {
        let block = start..(start + BLOCK).min(touches.len());
        let middle: Vec<usize> = block
            .clone()
            .map(|touch| touch * n_frames + n_frames / 2)
            .collect();
        let products = frames.select(Axis(0), &middle).dot(&frames.t());
        let mut near = Near::default();
        for (place, touch) in block.enumerate() {
            let row = products.slice(s![place, ..]);
            let least = |other: usize| {
                let own = other * n_frames..(other + 1) * n_frames;
                let squared = own.map(|frame| squares[frame] - 2.0 * row[frame]);
                squared.fold(f64::INFINITY, f64::min) + squares[middle[place]]
            };
            let others = (0..touches.len()).filter(|&other| other != touch);
            let mut others: Vec<(f64, usize)> = others.map(|other| (least(other), other)).collect();
            others.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            others.truncate(N_NEAREST);
            near.neighbours
                .push(others.iter().map(|&(_, other)| touches[other]).collect());
            near.distances.push(
                others
                    .iter()
                    .map(|&(square, _)| square.max(0.0).sqrt())
                    .collect(),
            );
        }
        near
    });
    let mut near = Near::default();
    for block in found.collect::<Vec<_>>() {
        near.neighbours.extend(block.neighbours);
        near.distances.extend(block.distances);
    }
    near.touches = touches;
    Some(near)
}

fn run(context: &Context) -> Result<Vec<Finding>> {
    let Some(found) = pairs(context) else {
        let why = "There are too few different touches.";
        return Ok(vec![Finding::not_checked("", why)]);
    };
    let pairs = &found.pairs;
    let share = found.share;
    let mut sentence = "No touch has a near-duplicate: another touch that is nearer than the other distances explain.".to_owned();
    if !pairs.is_empty() {
        let counts = found.comparisons.iter().filter(|c| !c.found.is_empty());
        let counts: Vec<String> = counts
            .map(|c| format!("{}: {} of {} touches", c.words, c.found.len(), c.n_tested))
            .collect();
        sentence = format!(
            "{} of the touches have a near-duplicate: another touch that is nearer than the other distances explain ({}).",
            percent(share),
            counts.join("; ")
        );
    }
    if let Some(groups) = context.data.groups.as_ref().filter(|_| !pairs.is_empty()) {
        let is_across = |pair: &&(usize, usize)| groups[pair.0] != groups[pair.1];
        let n_across = pairs.iter().filter(is_across).count();
        sentence += &format!(" {n_across} of them have it in another group.");
    }
    let n_other = pairs
        .iter()
        .filter(|pair| context.labels[pair.0] != context.labels[pair.1])
        .count();
    if n_other > 0 && context.has_classes() {
        sentence += &format!(" {n_other} have it in another class.");
    }
    let advice = "Remove the copies, or give all touches of one recording the same group and split by groups. rows.csv lists the pairs.";
    let finding = Finding::tested("", share, sentence, (found.p_value, share >= RELEVANT))
        .advice(advice)
        .against(0.0)
        .shown_in("near_duplicates");
    Ok(vec![finding])
}
