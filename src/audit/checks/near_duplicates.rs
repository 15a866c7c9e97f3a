//! Touches that are nearer to another touch than chance explains, such as copies and neighbouring frames of one recording.
//!
//! Touches are compared as recorded, without mean and scale, with the mirrored and turned frames of other touches, by features that do not depend on place and
//! mirroring, and, if touches have several frames, by their middle frame with all frames of other touches. Copies with another gain or offset, moved, mirrored or
//! turned copies, and overlapping windows of one recording are near-duplicates, too.

use crate::audit::check::{CheckAbout, Context, Finding, Result};
use crate::audit::checks::mean_reading::shapes;
use crate::audit::checks::quantisation::are_counts;
use crate::audit::duplicate_pairs::{Comparison, DuplicatePairs};
use crate::audit::finding::percent;
use crate::audit::scores::{N_NEAREST, nearest};
use crate::quantile::quantile;
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
/// Minimum number of events of a touch that is tested, in recordings of counts. Copies of fewer events are not found.
const MIN_EVENTS: f64 = 50.0;
/// Number of touches that are compared together.
const BLOCK: usize = 250;

pub const ABOUT: CheckAbout = CheckAbout {
    name: "near_duplicates",
    title: "Near-duplicates",
    run,
};

/// Display words of the comparison of touches as recorded.
const AS_RECORDED: &str = "as recorded";

/// Maximum median distance between the further neighbours of a near-duplicate, relative to its median distance from them, at which they form a cluster away from
/// it. Neighbours in a smooth density are at least as far from each other as from the row.
const CLUSTER: f64 = 0.5;

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
    let mut has_contact: Vec<bool> = (blocks.std_axis(Axis(1), 0.0).iter())
        .map(|&std| std > 0.0)
        .collect();
    // Touches of few events are equal by chance.
    if are_counts(context) {
        let n_frames = context.data.n_frames;
        for (touch, has_contact) in has_contact.iter_mut().enumerate() {
            let frames = s![touch * n_frames..(touch + 1) * n_frames, ..];
            *has_contact &= context.data.frames.slice(frames).sum() >= MIN_EVENTS;
        }
    }
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
    let compared =
        |words, values: &Array2<f64>, rows: &[usize], near: (&[Vec<usize>], &[Vec<f64>])| {
            let (neighbours, distances) = near;
            let of = |list: &[usize]| -> Vec<usize> { rows.iter().map(|&row| list[row]).collect() };
            let is_tested: Vec<bool> = rows.iter().map(|&row| has_contact[row]).collect();
            let mut p_values = test_duplicates(distances, &is_tested, &of(&context.labels))?;
            let n = rows.len() as f64;
            for (place, p_value) in p_values.iter_mut().enumerate() {
                if *p_value * n <= ANY
                    && is_beside_cluster(&neighbours[place], &distances[place], values)
                {
                    *p_value = 1.0;
                }
            }
            let found = p_values.iter().enumerate().filter(|(_, p)| **p * n <= ANY);
            let found = found.map(|(place, &p)| (rows[place], neighbours[place][0], p));
            let found: Vec<(usize, usize, f64)> = found.collect();
            // Few pairs of derived features can be near by chance of the derivation, unless they are exact copies.
            let is_decisive = |place: &usize| {
                words == AS_RECORDED
                    || (distances[*place].first() == Some(&0.0) && is_tested[*place])
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
    let mut comparisons = vec![compared(
        AS_RECORDED,
        blocks,
        &all,
        (neighbours, distances),
    )?];
    let of_near = |words, values: &Array2<f64>, near: &Near| {
        compared(
            words,
            values,
            &near.touches,
            (&near.neighbours, &near.distances),
        )
    };
    let by_features = |words, rows: &Array2<f64>| {
        of_near(
            words,
            rows,
            &nearest_of_sample(rows.view(), &context.sample),
        )
    };
    comparisons.extend(by_features(
        "without mean and scale",
        &shapes(blocks.clone()),
    ));
    if let Some(invariant) = &context.features.invariant {
        let rows = symmetrised(invariant.view(), context.features.image);
        comparisons.extend(by_features("moved, mirrored or turned", &rows));
    }
    if let Some(near) = nearest_turned(context) {
        comparisons.extend(of_near("mirrored or turned", blocks, &near));
    }
    if let Some(near) = nearest_windows(context) {
        comparisons.extend(of_near("shifted in time", blocks, &near));
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

/// Returns whether the further half of the nearest rows form a cluster away from a row. Then the distances of the row do not show the density around it: a few
/// rows beside a cluster, such as touches at the border of a skin beside frames without contact, have a gap to the cluster although they are no copies.
fn is_beside_cluster(neighbours: &[usize], distances: &[f64], rows: &Array2<f64>) -> bool {
    let further = &neighbours[neighbours.len() / 2..];
    let mut away = distances[neighbours.len() / 2..].to_vec();
    let mut between = Vec::new();
    for (place, &first) in further.iter().enumerate() {
        between.extend(further[place + 1..].iter().map(|&second| {
            let difference = &rows.row(first) - &rows.row(second);
            difference.dot(&difference).sqrt()
        }));
    }
    !between.is_empty() && quantile(&mut between, 0.5) < CLUSTER * quantile(&mut away, 0.5)
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
/// three frames, or readings are counts of events.
fn nearest_windows(context: &Context) -> Option<Near> {
    let data = &context.data;
    let n_frames = data.n_frames;
    let touches: Vec<usize> = (context.sample.iter().copied())
        .take((MAX_FRAMES / n_frames).max(1))
        .collect();
    // Single frames of few events are equal by chance.
    if n_frames < 3 || touches.len() < 2 * N_NEAREST || are_counts(context) {
        return None;
    }
    let frames = touches
        .iter()
        .flat_map(|&touch| touch * n_frames..(touch + 1) * n_frames);
    let frames = data.frames.select(Axis(0), &frames.collect::<Vec<_>>());
    let frames = pooled(frames.view(), 1, data.grid, MAX_BLOCKS);
    let middle: Vec<usize> = (0..touches.len())
        .map(|touch| touch * n_frames + n_frames / 2)
        .collect();
    let middle = frames.select(Axis(0), &middle);
    Some(nearest_variants(touches, &middle, &frames))
}

/// Finds the nearest touches of the mean frames of sampled touches, compared with the mirrored and turned mean frames of other touches. Returns `None` without
/// a grid.
fn nearest_turned(context: &Context) -> Option<Near> {
    let (rows, columns) = context.data.grid.filter(|grid| grid.0.min(grid.1) > 1)?;
    let frames = &context.sample_rows;
    let at = |y: usize, x: usize| y * columns + x;
    let mut turns: Vec<Vec<usize>> = vec![Vec::new(); if rows == columns { 7 } else { 3 }];
    for (y, x) in (0..rows).flat_map(|y| (0..columns).map(move |x| (y, x))) {
        let (below, left) = (rows - 1 - y, columns - 1 - x);
        let mirrored = [at(y, left), at(below, x), at(below, left)];
        // Only a square skin reads all taxels of a frame that was turned by 90°.
        let square = [(x, y), (x, below), (left, y), (left, below)];
        let turned = square.into_iter().map(|(y, x)| at(y, x));
        for (turn, taxel) in turns.iter_mut().zip(mirrored.into_iter().chain(turned)) {
            turn.push(taxel);
        }
    }
    let pool = |frames: &Array2<f64>| {
        let frames = frames.as_standard_layout();
        pooled(frames.view(), 1, context.data.grid, MAX_BLOCKS)
    };
    let own = pool(frames);
    let mut variants = Array2::zeros((frames.nrows() * turns.len(), own.ncols()));
    for (turn, taxels) in turns.iter().enumerate() {
        let mut of_turn = variants.slice_mut(s![turn..;turns.len(), ..]);
        of_turn.assign(&pool(&frames.select(Axis(1), taxels)));
    }
    Some(nearest_variants(context.sample.clone(), &own, &variants))
}

/// Finds the nearest other touches of each touch. `own` contains a row for each of `touches`, and `variants` contains an equal number of rows for each touch;
/// the distance to another touch is the least distance to one of its variants.
fn nearest_variants(touches: Vec<usize>, own: &Array2<f64>, variants: &Array2<f64>) -> Near {
    let n_variants = variants.nrows() / touches.len();
    let squared = |rows: &Array2<f64>| -> Vec<f64> {
        rows.rows().into_iter().map(|row| row.dot(&row)).collect()
    };
    let (own_squares, squares) = (squared(own), squared(variants));
    let starts: Vec<usize> = (0..touches.len()).step_by(BLOCK).collect();
    let found = starts.into_par_iter().map(|start| {
        let block = start..(start + BLOCK).min(touches.len());
        let products = own.slice(s![block.clone(), ..]).dot(&variants.t());
        let mut near = Near::default();
        for (place, touch) in block.enumerate() {
            let row = products.slice(s![place, ..]);
            let least = |other: usize| {
                let of_other = other * n_variants..(other + 1) * n_variants;
                let squared = of_other.map(|variant| squares[variant] - 2.0 * row[variant]);
                squared.fold(f64::INFINITY, f64::min) + own_squares[touch]
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
    near
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
    let is_mirrored = |c: &Comparison| c.words.contains("mirrored") && !c.found.is_empty();
    if found.comparisons.iter().any(is_mirrored) {
        sentence += " Touches of a symmetric object at regularly spaced poses are mirrored or moved copies, too: they are a fault of the split only for methods that do not depend on place or mirroring, or that train on mirrored copies.";
    }
    let advice = "Remove the copies, or give all touches of one recording the same group and split by groups. If poses are regularly spaced, hold out whole rows of poses. rows.csv lists the pairs.";
    let finding = Finding::tested("", share, sentence, (found.p_value, share >= RELEVANT))
        .advice(advice)
        .against(0.0)
        .shown_in("near_duplicates");
    Ok(vec![finding])
}
