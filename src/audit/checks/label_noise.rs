//! Wrong labels: held-out touches for which a classifier confidently predicts another label.
//!
//! Suppose that two classes overlap like normal distributions, and that a classifier recognises the fraction a = Φ(μ) of their touches. The margin of a touch
//! to the true class is then N(μ, 1). A touch lies deeper in the other class than the t-quantile of its members with the probability β = Φ(−2μ − Φ⁻¹(t)).
//! The fraction 1 − t of the touches lies as deep in their own class. Therefore the fraction q = β / (1 − t + β) of all touches deep in a class has another
//! label, although all labels are right. A larger number of touches with another label indicates wrong labels; the test is binomial. Real classes can also
//! overlap otherwise, so the nearest touches must confirm the class: a touch counts only if four of its five nearest touches have the label of the class.
//! Classes of which less than 70 % are recognised do not count, neither as labels nor as predictions.
//!
//! Wrong labels may concentrate in one pair of classes. The test is therefore also made for each label and each other class in which its touches lie, with the
//! accuracy of these two classes. The p-value is twice the smaller of the p-value of all touches and the smallest p-value of a pair times the number of pairs.

use crate::audit::check::{CheckAbout, Context, Finding, NO_LABELS, Result};
use crate::audit::deep_touches::{DeepTouches, Doubtful, DoubtfulPair};
use crate::audit::finding::percent;
use crate::statistics::interval::Interval;
use crate::statistics::p_status::CONFIDENCE;
use ndarray::Array2;
use statrs::distribution::{Binomial, ContinuousCDF, DiscreteCDF, Normal};
use std::collections::BTreeMap;

/// Minimum relevant fraction of wrong labels.
const TOLERATED: f64 = 0.005;
/// Number of nearest touches, and how many of them confirm a class. One of them may have a wrong label itself.
const N_NEAR: usize = 5;
const N_CONFIRMING: usize = 4;
/// Quantile t of the margins of a class from which touches lie deep in it. If larger, fewer wrong labels count; if smaller, more touches of overlapping classes.
const DEEP: f64 = 0.25;
/// Minimum fraction of the touches of a class that a classifier recognises, from which labels are tested.
const MIN_ACCURACY: f64 = 0.7;

pub const ABOUT: CheckAbout = CheckAbout {
    name: "label_noise",
    title: "Wrong labels",
    run,
};

/// Returns the touches that lie deep in a class, which are searched at the first call; `None` if no classifier is accurate enough.
pub fn deep_touches(context: &Context) -> Option<&DeepTouches> {
    context.deep_touches.get_or_init(|| find(context)).as_ref()
}

/// Finds touches that lie deep in a class by the margins of the best classifier with scores. Returns `None` if no classifier is accurate enough.
fn find(context: &Context) -> Option<DeepTouches> {
    let scored = context.tested(0).filter(|tested| tested.scores.is_some());
    let best = scored.max_by(|a, b| a.accuracy().total_cmp(&b.accuracy()))?;
    let scores = best.scores.as_ref()?;
    let n_classes = scores.ncols();
    let mut counts = vec![[0.0; 2]; n_classes];
    for (is_correct, &label) in best.is_correct.iter().zip(&context.labels) {
        if let Some(is_correct) = is_correct {
            counts[label][0] += 1.0;
            counts[label][1] += f64::from(u8::from(*is_correct));
        }
    }
    let is_known = |class: usize| counts[class][1] >= MIN_ACCURACY * counts[class][0].max(1.0);
    let known: Vec<[f64; 2]> = (0..n_classes)
        .filter(|&class| is_known(class))
        .map(|class| counts[class])
        .collect();
    if known.len() < 2 {
        return None;
    }
    let [n, n_correct] = known
        .iter()
        .fold([0.0; 2], |sum, of| [sum[0] + of[0], sum[1] + of[1]]);
    let accuracy = n_correct / n;
    let neighbours = neighbours(context)?;
    let is_confirmed = |touch: usize, class: usize| {
        let near = neighbours[touch].iter().take(N_NEAR);
        near.filter(|&&other| context.labels[other] == class)
            .count()
            >= N_CONFIRMING
    };
    let mut touches = Vec::new();
    for (touch, scores) in scores.rows().into_iter().enumerate() {
        if best.is_correct[touch].is_none() || !is_known(context.labels[touch]) {
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
        pairs: Vec::new(),
        n_pairs: known.len() * (known.len() - 1),
    };
    // Number of touches of each label with each prediction.
    let mut predicted = Array2::<usize>::zeros((n_classes, n_classes));
    for &(touch, class, _) in &touches {
        predicted[(context.labels[touch], class)] += 1;
    }
    let mut doubtful = Vec::new();
    for class in (0..n_classes).filter(|&class| is_known(class)) {
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
        let least = crate::quantile::quantile(&mut margins, DEEP);
        let deep =
            within.filter(|(touch, _, margin)| *margin >= least && is_confirmed(*touch, class));
        let mut n_deep = 0;
        let mut n_doubtful = BTreeMap::<usize, usize>::new();
        for &(touch, _, margin) in deep {
            n_deep += 1;
            if !is_right(touch) {
                *n_doubtful.entry(context.labels[touch]).or_default() += 1;
                doubtful.push((
                    margin / median.abs().max(f64::MIN_POSITIVE),
                    Doubtful { touch, class },
                ));
            }
        }
        found.n_deep += n_deep;
        n_deep -= n_doubtful.values().sum::<usize>();
        let pairs = n_doubtful.into_iter().map(|(label, n_doubtful)| {
            let n = |of: [(usize, usize); 2]| of.map(|pair| predicted[pair] as f64).iter().sum();
            let n_exchanged: f64 = n([(label, class), (class, label)]);
            let n_correct: f64 = n([(label, label), (class, class)]);
            let n_within: f64 = n([(label, class), (class, class)]);
            let n_deep = n_deep + n_doubtful;
            // If the doubtful labels are wrong, an equal fraction of all touches that are predicted as the class has wrong labels.
            let n_wrong = n_within * n_doubtful as f64 / n_deep as f64;
            let n_exchanged = (n_exchanged - n_wrong).max(0.0);
            DoubtfulPair {
                label,
                class,
                n_doubtful,
                n_deep,
                accuracy: n_correct / (n_correct + n_exchanged),
            }
        });
        found.pairs.extend(pairs);
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

/// Tests whether overlapping classes explain the number of doubtful touches among the touches deep in a class. `accuracy` is the fraction of the touches with
/// right labels that the classifier recognises, and `n` is the number of all touches. Returns the expected fraction and the p-value.
fn test((n_doubtful, n_deep): (usize, usize), accuracy: f64, n: f64) -> (f64, f64) {
    let normal = Normal::standard();
    let mean = normal.inverse_cdf(accuracy.min(1.0 - 0.5 / n));
    let beyond = normal.cdf(-2.0 * mean - normal.inverse_cdf(DEEP));
    let expected = (beyond / (1.0 - DEEP + beyond)).max(TOLERATED);
    let p_value = match (n_doubtful, Binomial::new(expected, n_deep as u64)) {
        (1.., Ok(binomial)) => binomial.sf(n_doubtful as u64 - 1),
        _ => 1.0,
    };
    (expected, p_value)
}

fn run(context: &Context) -> Result<Vec<Finding>> {
    if !context.has_classes() {
        return Ok(vec![Finding::not_checked("", NO_LABELS)]);
    }
    let Some(found) = deep_touches(context).filter(|found| found.n_deep > 0) else {
        let why = format!(
            "No cheap classifier recognises {} of the touches of two classes, so that a wrong label cannot be told from a difficult touch.",
            percent(MIN_ACCURACY)
        );
        return Ok(vec![Finding::not_checked("", why)]);
    };
    let n = context.labels.len() as f64;
    let n_doubtful = found.doubtful.len();
    let share = n_doubtful as f64 / found.n_deep as f64;
    let of_all = (n_doubtful, found.n_deep);
    // Wrong labels reduce the accuracy, too.
    let (expected, p_of_all) = test(of_all, found.accuracy / (1.0 - share).max(0.5), n);
    let pairs = found.pairs.iter().map(|pair| {
        let (_, p) = test((pair.n_doubtful, pair.n_deep), pair.accuracy, n);
        (p * found.n_pairs as f64, pair)
    });
    let pair = pairs.min_by(|a, b| a.0.total_cmp(&b.0));
    let p_of_pair = pair.as_ref().map_or(1.0, |(p, _)| *p);
    let p_value = (2.0 * p_of_all.min(p_of_pair)).min(1.0);
    let interval = Interval::wilson(n_doubtful, found.n_deep, CONFIDENCE)?;
    let mut sentence = format!(
        "Of {} touches that lie deep in a class and whose nearest touches confirm it, {n_doubtful} ({}) have another label; overlapping classes explain {}.",
        found.n_deep,
        percent(share),
        percent(expected)
    );
    if let Some((_, pair)) = pair.filter(|(p, _)| *p < p_of_all) {
        let name = |class: usize| &context.data.classes[class];
        sentence += &format!(
            " Most conspicuous are {} of {} touches deep in {}, which have the label {}.",
            pair.n_doubtful,
            pair.n_deep,
            name(pair.class),
            name(pair.label)
        );
    }
    let finding = Finding::tested("", share, sentence, (p_value, true))
        .within([interval.low, interval.high])
        .against(expected)
        .advice("Look at the listed touches (rows.csv) and correct their labels.")
        .shown_in("doubtful_labels");
    Ok(vec![finding])
}
