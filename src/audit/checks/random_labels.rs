//! Accuracy that a random labelling of whole groups reaches by a random split.
//!
//! The touches of one class in one group are given a common random label. A classifier then predicts the label of a touch from its nearest neighbour in another
//! fold. If touches of a group are alike, the prediction is correct more often than by chance. Without groups, sessions are used. Without groups and sessions,
//! tenths of each class in the order of the file are used.

use crate::audit::check::{CheckAbout, Context, Finding, NO_LABELS, Result};
use crate::audit::finding::percent;
use crate::audit::splits::touches_of_classes;
use rand::seq::SliceRandom;
use std::collections::BTreeMap;

/// Number of blocks of each class that replace groups if the data have no groups.
const N_BLOCKS: usize = 10;
/// Minimum relevant excess over chance.
const RELEVANT: f64 = 0.05;

pub const ABOUT: CheckAbout = CheckAbout {
    name: "random_labels",
    title: "Accuracy of a random labelling",
    run,
};

/// Returns the group of each touch, and the display name of the groups.
fn units(context: &Context) -> (Vec<usize>, &'static str) {
    let data = &context.data;
    match (&data.groups, &data.sessions) {
        (Some(groups), _) => (groups.clone(), "groups"),
        (None, Some(sessions)) => (sessions.clone(), "sessions"),
        (None, None) => {
            let mut blocks = vec![0; context.labels.len()];
            for touches in touches_of_classes(&context.labels).into_values() {
                for (place, &touch) in touches.iter().enumerate() {
                    blocks[touch] = place * N_BLOCKS / touches.len();
                }
            }
            (blocks, "blocks of consecutive touches")
        }
    }
}

fn run(context: &Context) -> Result<Vec<Finding>> {
    let Some(scores) = &context.scores else {
        return Ok(vec![Finding::not_checked("", NO_LABELS)]);
    };
    let (units, words) = units(context);
    let mut numbers = BTreeMap::new();
    let cells = context.labels.iter().zip(&units).map(|(&label, &unit)| {
        let next = numbers.len();
        *numbers.entry((label, unit)).or_insert(next)
    });
    let cells: Vec<usize> = cells.collect();
    let n_cells = numbers.len();
    if n_cells == context.n_classes || 2 * n_cells > context.labels.len() {
        let why = format!(
            "Each class is in one of the {words}, or most of the {words} are single touches."
        );
        return Ok(vec![Finding::not_checked("", why)]);
    }
    let pairs = scores.nearest_outside.iter().enumerate();
    let pairs: Vec<(usize, usize)> = pairs
        .filter_map(|(row, other)| Some((row, (*other)?)))
        .collect();
    let n = pairs.len().max(1) as f64;
    let share = |of: &[usize]| pairs.iter().filter(|(a, b)| of[*a] == of[*b]).count() as f64 / n;
    let mut rng = context.seed(ABOUT.name).rng();
    // Each cell (touches of one class in one group) is given a random label. The number of cells with each label is unchanged.
    let mut labels: Vec<usize> = numbers.keys().map(|&(label, _)| label).collect();
    let mut reached = 0.0;
    let n_labellings = context.options.n_permutations.clamp(1, 100);
    for _ in 0..n_labellings {
        labels.shuffle(&mut rng);
        let labels: Vec<usize> = cells.iter().map(|&cell| labels[cell]).collect();
        reached += share(&labels) / n_labellings as f64;
    }
    // Touches of a class exchange their groups, so that the group of a neighbour is independent of the touch.
    let observed = share(&cells);
    let classes: Vec<Vec<usize>> = touches_of_classes(&context.labels).into_values().collect();
    let (mut at_least, mut chance, mut n_done) = (0_usize, 0.0, 0);
    let mut permuted = cells.clone();
    while context.permutes_again(n_done, at_least) {
        n_done += 1;
        for touches in &classes {
            let mut shuffled: Vec<usize> = touches.iter().map(|&touch| cells[touch]).collect();
            shuffled.shuffle(&mut rng);
            for (&touch, cell) in touches.iter().zip(shuffled) {
                permuted[touch] = cell;
            }
        }
        let same = share(&permuted);
        at_least += usize::from(same >= observed);
        let of_cells: Vec<usize> = permuted.iter().map(|&cell| labels[cell]).collect();
        chance += share(&of_cells);
    }
    let chance = chance / n_done.max(1) as f64;
    let p_value = (1 + at_least) as f64 / (1 + n_done) as f64;
    let sentence = format!(
        "If the {words} are labelled at random, a random split still gives {}; {} if the {words} had nothing in common.",
        percent(reached),
        percent(chance)
    );
    let finding = Finding::tested("", reached, sentence, (p_value, reached - chance >= RELEVANT))
        .against(chance)
        .advice(format!(
            "The random split rewards the recognition of {words}, whatever the labels mean. Hold out whole {words}."
        ))
        .shown_in("accuracy_by_split");
    Ok(vec![finding])
}
