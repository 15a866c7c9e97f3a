//! Touches that are nearer to another touch than chance explains, such as copies and neighbouring frames of one recording.

use crate::audit::check::{CheckAbout, Context, Finding, Result};
use crate::audit::finding::percent;
use bubbletouch_sim::audit::duplicates::test_duplicates;
use ndarray::Axis;

/// Probability that, by chance, at least one touch counts as a near-duplicate.
const ANY: f64 = 0.05;

pub const ABOUT: CheckAbout = CheckAbout {
    name: "near_duplicates",
    title: "Near-duplicates",
    run,
};

/// Returns pairs of a touch and its near-duplicate, the nearest pairs first, and the smallest p-value of a touch times the number of touches.
pub fn pairs(context: &Context) -> Option<(Vec<(usize, usize)>, f64)> {
    let nearest = nearest_of(context);
    let (neighbours, distances) = match (&context.scores, &nearest) {
        (Some(scores), _) => (&scores.neighbours, &scores.distances),
        (None, Some(nearest)) => (&nearest.neighbours, &nearest.distances),
        (None, None) => return None,
    };
    // Rows with equal values of all blocks contain no contact.
    let has_contact: Vec<bool> = (context.features.blocks.std_axis(Axis(1), 0.0).iter())
        .map(|&std| std > 0.0)
        .collect();
    let p_values = test_duplicates(distances, &has_contact, &context.labels)?;
    let n = p_values.len() as f64;
    let least = p_values.iter().copied().fold(1.0, f64::min);
    let found = p_values.iter().enumerate();
    let mut found: Vec<(usize, f64)> = found
        .filter(|(_, p)| **p * n <= ANY)
        .map(|(row, p)| (row, *p))
        .collect();
    found.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
    let pairs = found.iter().map(|&(row, _)| (row, neighbours[row][0]));
    Some((pairs.collect(), (least * n).min(1.0)))
}

/// Returns the nearest touches of all touches if there are no labels; with labels, the classifiers have already found them.
fn nearest_of(context: &Context) -> Option<bubbletouch_svm::audit::NearestRows> {
    let is_needed = context.scores.is_none();
    is_needed.then(|| crate::audit::scores::nearest(context.features.blocks.view(), 8, &[]))
}

fn run(context: &Context) -> Result<Vec<Finding>> {
    let Some((pairs, p_value)) = pairs(context) else {
        let why = "There are too few different touches.";
        return Ok(vec![Finding::not_checked("", why)]);
    };
    let n = context.labels.len();
    let share = pairs.len() as f64 / n as f64;
    let mut sentence = format!(
        "{} of {n} touches ({}) have a near-duplicate: another touch that is nearer than the other distances explain.",
        pairs.len(),
        percent(share)
    );
    if let Some(groups) = &context.data.groups {
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
    let finding = Finding::tested("", share, sentence, (p_value, true))
        .advice(advice)
        .against(0.0)
        .shown_in("near_duplicates");
    Ok(vec![finding])
}
