//! Wrong labels: held-out touches for which a classifier confidently predicts another label.
//!
//! Suppose that two classes overlap like normal distributions, and that a classifier recognises the fraction a = Φ(μ) of their touches. The margin of a touch
//! to the true class is then N(μ, 1). A touch lies deeper in the other class than the median member of that class with the probability Φ(−2μ). Half of the
//! touches lie as deep in their own class. Therefore the fraction q = Φ(−2μ) / (1/2 + Φ(−2μ)) of all touches deep in a class has another label, although all
//! labels are right. A larger number of touches with another label indicates wrong labels; the test is binomial. Real classes can also overlap otherwise, so
//! the nearest touches must confirm the class. A touch counts only if its five nearest touches all have the label of the class.

use crate::audit::check::{CheckAbout, Context, Finding, NO_LABELS, Result};
use crate::audit::finding::percent;
use crate::statistics::interval::Interval;
use crate::statistics::p_status::CONFIDENCE;
use statrs::distribution::{Binomial, ContinuousCDF, DiscreteCDF, Normal};

/// Minimum relevant fraction of wrong labels.
const TOLERATED: f64 = 0.005;
/// Number of nearest touches that confirm a class.
const N_CONFIRMING: usize = 5;
/// Minimum accuracy of a classifier from which labels are tested.
const MIN_ACCURACY: f64 = 0.7;

pub const ABOUT: CheckAbout = CheckAbout {
    name: "label_noise",
    title: "Wrong labels",
    run,
};

/// Touch with a doubtful label.
pub struct Doubtful {
    /// Index of the touch.
    pub touch: usize,
    /// Class that the classifier predicts.
    pub class: usize,
}

/// Touches that lie as deep in a class as its median member.
pub struct DeepTouches {
    /// Touches with another label than the class in which they lie, the deepest first.
    pub doubtful: Vec<Doubtful>,
    /// Number of touches that lie as deep in a class as its median member, with any label.
    pub n_deep: usize,
    /// Accuracy of the classifier.
    pub accuracy: f64,
}

/// Finds touches that lie deep in a class by the margins of the best classifier with scores. Returns `None` if no classifier is accurate enough.
pub fn deep_touches(context: &Context) -> Option<DeepTouches> {
    let scored = context.tested(0).filter(|tested| tested.scores.is_some());
    let best = scored.max_by(|a, b| a.accuracy().total_cmp(&b.accuracy()))?;
    let scores = best.scores.as_ref()?;
    let accuracy = best.accuracy();
    if accuracy < MIN_ACCURACY {
        return None;
    }
    let n_classes = scores.ncols();
    let neighbours = neighbours(context)?;
    let is_confirmed = |touch: usize, class: usize| {
        let near = &neighbours[touch][..N_CONFIRMING.min(neighbours[touch].len())];
        near.iter().all(|&other| context.labels[other] == class)
    };
    let mut touches = Vec::new();
    for (touch, scores) in scores.rows().into_iter().enumerate() {
        if best.is_correct[touch].is_none() {
            continue;
        }
        let mut order: Vec<usize> = (0..n_classes).collect();
        order.sort_by(|&a, &b| scores[b].total_cmp(&scores[a]));
        let margin = scores[order[0]] - scores[order[1]];
        touches.push((touch, order[0], margin));
    }
    let mut found = DeepTouches {
        doubtful: Vec::new(),
        n_deep: 0,
        accuracy,
    };
    let mut doubtful = Vec::new();
    for class in 0..n_classes {
        let is_right = |touch: usize| context.labels[touch] == class;
        let within = touches
            .iter()
            .filter(|(_, predicted, _)| *predicted == class);
        let right = within.clone().filter(|(touch, ..)| is_right(*touch));
        let mut margins: Vec<f64> = right.map(|(_, _, margin)| *margin).collect();
        if margins.is_empty() {
            continue;
        }
        let median = crate::quantile::quantile(&mut margins, 0.5);
        let deep =
            within.filter(|(touch, _, margin)| *margin >= median && is_confirmed(*touch, class));
        for &(touch, _, margin) in deep {
            found.n_deep += 1;
            if !is_right(touch) {
                doubtful.push((
                    margin / median.abs().max(f64::MIN_POSITIVE),
                    Doubtful { touch, class },
                ));
            }
        }
    }
    doubtful.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.touch.cmp(&b.1.touch)));
    found.doubtful = doubtful.into_iter().map(|(_, touch)| touch).collect();
    Some(found)
}

/// Returns the nearest touches of each touch, by the features for which the nearest-neighbour classifier has the highest accuracy.
fn neighbours(context: &Context) -> Option<&Vec<Vec<usize>>> {
    let scores = context.scores.as_ref()?;
    let accuracy = |name: &str| {
        let tested = context.tested(0).find(|tested| tested.method == name);
        tested.map_or(0.0, |tested| tested.accuracy())
    };
    let is_invariant = accuracy("nearest_row_invariant") > accuracy("nearest_row");
    match &scores.invariant_neighbours {
        Some(invariant) if is_invariant => Some(invariant),
        _ => Some(&scores.neighbours),
    }
}

fn run(context: &Context) -> Result<Vec<Finding>> {
    if !context.has_classes() {
        return Ok(vec![Finding::not_checked("", NO_LABELS)]);
    }
    let Some(found) = deep_touches(context).filter(|found| found.n_deep > 0) else {
        let why = format!(
            "No cheap classifier recognises {} of the touches, so that a wrong label cannot be told from a difficult touch.",
            percent(MIN_ACCURACY)
        );
        return Ok(vec![Finding::not_checked("", why)]);
    };
    let n = context.labels.len() as f64;
    let normal = Normal::standard();
    let n_doubtful = found.doubtful.len();
    let share = n_doubtful as f64 / found.n_deep as f64;
    // Wrong labels reduce the accuracy, too.
    let accuracy = (found.accuracy / (1.0 - share)).min(1.0 - 0.5 / n);
    let mean = normal.inverse_cdf(accuracy);
    let beyond = normal.cdf(-2.0 * mean);
    let expected = (beyond / (0.5 + beyond)).max(TOLERATED);
    let p_value = match (n_doubtful, Binomial::new(expected, found.n_deep as u64)) {
        (1.., Ok(binomial)) => binomial.sf(n_doubtful as u64 - 1),
        _ => 1.0,
    };
    let interval = Interval::wilson(n_doubtful, found.n_deep, CONFIDENCE)?;
    let sentence = format!(
        "Of {} touches that lie deep in a class and whose nearest touches confirm it, {n_doubtful} ({}) have another label; overlapping classes explain {}.",
        found.n_deep,
        percent(share),
        percent(expected)
    );
    let finding = Finding::tested("", share, sentence, (p_value, true))
        .within([interval.low, interval.high])
        .against(expected)
        .advice("Look at the listed touches (rows.csv) and correct their labels.")
        .shown_in("doubtful_labels");
    Ok(vec![finding])
}
