//! First question: what does the split of the claim measure?
//!
//! Accuracy of fast classifiers at random and with whole units held out, at equal training size; the number of independent touches; what training and test share;
//! and copies.

use crate::audit::context::Context;
use crate::audit::finding::{ALPHA, Finding, Verdict, percent};
use crate::audit::splits::{AuditSplit, touches_of_classes};
use crate::error::Result;
use bubbletouch_sim::audit::copies::{CopySet, copy_sets};
use bubbletouch_sim::audit::dependence::{effective_by_groups, effective_by_order};
use bubbletouch_sim::audit::taxels::{sizes, smallest_step};
use bubbletouch_sim::disjoint_sets::DisjointSets;
use bubbletouch_svm::audit::{Permuted, held_out_loss, readability};
use ndarray::Axis;
use rayon::prelude::*;
use statrs::distribution::{DiscreteCDF, Poisson};
use std::collections::BTreeSet;

/// Smallest fraction of the accuracy above chance whose loss is a fault: most of what a random split measures is then the recognition of units. A smaller loss,
/// such as by the styles of subjects, is a note: a split by units allows for it.
const LEAST_LOSS: f64 = 0.5;
/// Number of nearest touches of another class of a doubtful label.
const N_DOUBTING: usize = 5;
/// Number of nearest touches to which a touch of a cluster is connected.
const N_CONNECTED: usize = 3;

/// Touch with a doubtful label.
pub struct Doubtful {
    /// Index of the touch.
    pub touch: usize,
    /// Class of the nearest touches.
    pub class: usize,
}

/// Answers to the first question.
pub struct Claim {
    /// Findings.
    pub findings: Vec<Finding>,
    /// Sentences on the accuracy, and on what was not given.
    pub sentences: Vec<String>,
    /// Sets of copies.
    pub copies: Vec<CopySet>,
    /// Touches whose nearest touches belong to another class.
    pub doubtful: Vec<Doubtful>,
}

/// Answers the first question.
///
/// # Errors
/// If no touch of a split was tested.
pub fn answer(context: &Context) -> Result<Claim> {
    let mut findings = split_findings(context)?;
    let shared = shared(context, &findings);
    findings.extend(shared);
    let (copies, found) = copies(context);
    findings.push(found);
    let doubtful = (!is_blind(context)).then(|| doubtful(context));
    if context.has_classes {
        findings.extend(clusters(context));
        findings.push(labels(context, doubtful.as_deref()));
    }
    if context.data.groups.is_none() {
        findings.push(sample_size(context));
    }
    let missing = not_given(context);
    let mut sentences = vec![accuracy_sentence(context)];
    if !missing.is_empty() {
        let sentence = format!(
            "Not given: {}; what depends on them was not checked.",
            missing.join(", ")
        );
        sentences.push(sentence.clone());
        findings.push(Finding::new("not_given", Verdict::NotChecked, sentence));
    }
    Ok(Claim {
        findings,
        sentences,
        copies,
        doubtful: doubtful.unwrap_or_default(),
    })
}

/// Returns the phrase for the units that a split holds out.
fn units_of(split: &AuditSplit) -> &'static str {
    match split.name {
        "group" => "whole groups held out",
        "session" => "whole sessions held out",
        "time" => "blocks of consecutive touches held out",
        _ => "the given test set",
    }
}

/// Returns the sentence that compares the arms of a split; `None` without classes.
fn arms_sentence(context: &Context, number: usize) -> Option<String> {
    Some(format!(
        "At random, {} of the touches; with {}, {}; chance is {}, and both train on equally many touches.",
        context.best(number, false)?.words(),
        units_of(&context.splits[number]),
        context.best(number, true)?.words(),
        percent(context.chance())
    ))
}

/// Returns the first sentence of the page.
fn accuracy_sentence(context: &Context) -> String {
    let Some(mut sentence) = arms_sentence(context, 0) else {
        return "Without labels of two classes, only the readings were checked.".to_owned();
    };
    let split = &context.splits[0];
    if split.has_few_units() {
        sentence += &format!(" There are only {} {}s.", split.n_units, split.name);
    }
    if is_blind(context) {
        sentence += " No fast classifier recognises more than chance: this audit is blind to leaks of the split.";
    }
    sentence
}

/// Returns whether no fast classifier recognises more than chance.
fn is_blind(context: &Context) -> bool {
    context.best(0, false).is_none_or(|random| {
        let interval = random.interval(&context.splits[0]);
        interval.is_ok_and(|own| own.low <= context.chance())
    })
}

/// Returns the names of the inputs that were not given.
fn not_given(context: &Context) -> Vec<&'static str> {
    let data = &context.data;
    let given = [
        ("labels", context.has_classes),
        ("groups", data.groups.is_some()),
        ("sessions", data.sessions.is_some()),
        ("times", data.is_in_order_of_time),
        (
            "frames before contact",
            data.n_frames < 2 || context.options.before_contact.is_some(),
        ),
        ("untouched taxels", !context.options.untouched.is_empty()),
    ];
    let missing = given.into_iter().filter(|(_, is_given)| !is_given);
    missing.map(|(name, _)| name).collect()
}

/// Compares both arms of each split.
fn split_findings(context: &Context) -> Result<Vec<Finding>> {
    let mut findings = Vec::new();
    if context.has_one_group_each() {
        let name = match context.data.groups {
            Some(_) => "group",
            None => "session",
        };
        let sentence = format!(
            "The touches of each class belong to one {name}. What names the {name} names the class, and no split can tell them apart."
        );
        let finding = Finding::new("split", Verdict::Fault, sentence).about(name);
        findings.push(finding.advice(format!("Record several {name}s of each class.")));
    }
    let named = context.options.split.as_deref();
    let numbers = (0..context.splits.len()).into_par_iter();
    let tests: Vec<_> = numbers.map(|number| loss(context, number)).collect();
    for (number, test) in tests.into_iter().enumerate() {
        let split = &context.splits[number];
        let arms = context.best(number, false).zip(context.best(number, true));
        let Some((random, held)) = arms else {
            continue;
        };
        let (high, low, chance) = (random.accuracy(), held.accuracy(), context.chance());
        let interval = held.interval(split)?;
        let is_relevant = high - low >= LEAST_LOSS * (high - chance) && high > chance;
        let is_tested = !split.has_few_units();
        let verdict = match is_relevant && is_tested && named != Some(split.name) {
            true => Verdict::Fault,
            false => Verdict::Note,
        };
        let mut sentence = arms_sentence(context, number).unwrap_or_default();
        let mut arm = context.arm(number, true);
        let same = arm.find(|tested| tested.method == random.method);
        if let Some(same) = same.filter(|same| same.method != held.method) {
            sentence += &format!(" In this split, {}.", same.words());
        }
        if let ("group", Some(groups)) = (split.name, &context.data.groups) {
            let (n, residuals) = (groups.len(), context.residuals());
            let effective = effective_by_groups(residuals.view(), &context.labels, groups);
            sentence += &format!(
                " By their groups, {n} touches are worth {effective:.0} independent ones."
            );
        }
        let advice = match split.name {
            name if !is_tested => format!("Record more {name}s: so few cannot show how the accuracy varies between them."),
            "time" => "Report the accuracy with blocks of time held out. Give touches of one grasp, object or person as groups (--groups).".to_owned(),
            _ => format!("Report the accuracy with {}.", units_of(split)),
        };
        let mut finding = Finding::new("split", verdict, sentence).about(split.name);
        (finding.value_low, finding.value_high) = (Some(interval.low), Some(interval.high));
        let finding = finding
            .value(low, high)
            .advice(advice)
            .shown_in("accuracy_by_split");
        findings.push(match test.filter(|_| is_tested) {
            Some(test) => finding.tested(&test),
            None => finding,
        });
    }
    Ok(findings)
}

/// Tests whether held-out units cost accuracy, by the representation of the classifier that is best at random.
fn loss(context: &Context, number: usize) -> Option<Permuted> {
    let split = &context.splits[number];
    let representation = context.best(number, false)?.representation;
    let touches = context.sample.iter().copied();
    let known = touches.filter_map(|touch| Some((touch, split.folds[touch]?)));
    let (touches, folds): (Vec<usize>, Vec<usize>) = known.unzip();
    let rows = context.representations[representation].select(Axis(0), &touches);
    let labels: Vec<usize> = touches.iter().map(|&touch| context.labels[touch]).collect();
    let range = context.options.permutations();
    let seed = context.seed(split.name);
    held_out_loss(rows.view(), &labels, (&folds, split.n_folds), &range, &seed)
}

/// Counts groups and sessions that the given test set shares with training. If held-out groups cost accuracy, and most touches of
/// the test set are in shared groups, this is a fault with the test of the split by groups.
fn shared(context: &Context, findings: &[Finding]) -> Vec<Finding> {
    let Some(is_test) = &context.data.is_test else {
        return Vec::new();
    };
    let lists = [
        ("group", &context.data.groups),
        ("session", &context.data.sessions),
    ];
    let found = lists.into_iter().filter_map(|(name, units)| {
        let units = units.as_ref()?;
        let of = |side: bool| {
            let pairs = units.iter().zip(is_test);
            pairs.filter(move |pair| *pair.1 == side).map(|pair| *pair.0)
        };
        let [train, test] = [false, true].map(|side| of(side).collect::<BTreeSet<usize>>());
        let n_shared = train.intersection(&test).count();
        let n_in_shared = of(true).filter(|unit| train.contains(unit)).count();
        let n_touches = of(true).count();
        let share = n_in_shared as f64 / n_touches.max(1) as f64;
        let sentence = format!(
            "{n_shared} of the {} {name}s of the given test set have touches in training: {} of its touches.",
            test.len(),
            percent(share)
        );
        let mut finding = Finding::counted("shared", n_shared > 0, sentence)
            .about(format!("{name}s"))
            .value(share, 0.0)
            .advice(format!("Assign whole {name}s to training or test."));
        let of_split = findings.iter().find(|of| of.check == "split" && of.subject == name);
        if let Some(split) = of_split.filter(|split| split.verdict == Verdict::Fault && 2 * n_in_shared > n_touches) {
            finding.verdict = Verdict::Fault;
            (finding.p_value, finding.is_end) = (split.p_value, split.is_end);
            finding.sentence += &format!(" {}", split.sentence);
            (finding.value, finding.baseline) = (split.value, split.baseline);
        }
        Some(finding)
    });
    found.collect()
}

/// Finds copies and counts those that a split separates.
fn copies(context: &Context) -> (Vec<CopySet>, Finding) {
    let near = &context.near;
    let sizes = sizes(context.representations[0].view());
    let step = smallest_step(context.frames.view());
    let mut sets = copy_sets(&near.neighbours, &near.distances, &sizes, step);
    // A class of two or three touches is no set of copies.
    let classes = touches_of_classes(&context.labels);
    let is_class = |set: &CopySet| set.rows == classes[&context.labels[set.rows[0]]];
    sets.retain(|set| !(context.has_classes && is_class(set)));
    let least = sets.iter().map(|set| set.p_value).fold(1.0, f64::min);
    sets.retain(|set| set.p_value <= ALPHA);
    // By chance, ALPHA sets are as isolated as these; their number has about a Poisson distribution.
    let number = Poisson::new(ALPHA)
        .ok()
        .zip((sets.len() as u64).checked_sub(1));
    let by_number = number.map_or(1.0, |(poisson, n)| poisson.sf(n));
    let mut taken = BTreeSet::new();
    sets.retain(|set| {
        let is_new = set.rows.iter().all(|row| !taken.contains(row));
        taken.extend(set.rows.iter().copied().filter(|_| is_new));
        is_new
    });
    let n = context.labels.len();
    let share = taken.len() as f64 / n as f64;
    let test = Permuted {
        p_value: (2.0 * f64::min(least, by_number)).min(1.0),
        mean: f64::NAN,
        bound: f64::NAN,
        is_end: false,
    };
    if sets.is_empty() {
        let sentence =
            "No two or three touches are far nearer to each other than to the next ones.";
        let finding = Finding::counted("copies", false, sentence).value(0.0, 0.0);
        return (sets, finding.tested(&test));
    }
    let side = |touch: usize| match (&context.data.is_test, context.splits.first()) {
        (Some(is_test), _) => Some(usize::from(is_test[touch])),
        (None, split) => split.and_then(|split| split.random[touch]),
    };
    // Whether all touches of a set have one value of a list.
    let is_one = |set: &&CopySet, of: &dyn Fn(usize) -> Option<usize>| {
        set.rows.iter().all(|&row| of(row) == of(set.rows[0]))
    };
    let crossing = sets.iter().filter(|set| !is_one(set, &side));
    let n_crossing: usize = crossing.map(|set| set.rows.len()).sum();
    let of_split = match context.data.is_test {
        Some(_) => "the given split",
        None => "a random split",
    };
    let mut sentence = format!(
        "{} of {n} touches ({}) are two or three copies of each other, far nearer than the next touches. {n_crossing} of them cross from training to test by {of_split}.",
        taken.len(),
        percent(share)
    );
    if share > 0.5 {
        sentence += " Most touches are copied, as after augmentation.";
    }
    let is_within = |groups: &Vec<usize>| {
        sets.iter()
            .all(|set| is_one(&set, &|row| Some(groups[row])))
    };
    let verdict = match context.data.groups.as_ref().is_some_and(is_within) {
        true => Verdict::Note,
        false => Verdict::Fault,
    };
    let finding = Finding::new("copies", verdict, sentence)
        .value(share, 0.0)
        .tested(&test)
        .advice("Remove the copies that rows.csv lists, or give copies a common group and hold out whole groups.")
        .shown_in("copies");
    (sets, finding)
}

/// Without groups and sessions: touches that form separate clusters, such as sequences, and the accuracy with whole clusters held out.
fn clusters(context: &Context) -> Option<Finding> {
    if context.units.is_some() {
        return None;
    }
    let mut joined = DisjointSets::new(context.labels.len());
    for (touch, near) in context.near.neighbours.iter().enumerate() {
        for &other in near.iter().take(N_CONNECTED) {
            joined.join(touch, other);
        }
    }
    let cluster = joined.roots();
    let n_clusters = cluster.iter().collect::<BTreeSet<_>>().len();
    let best = context.best(0, false)?;
    let units: Vec<usize> = context.sample.iter().map(|&touch| cluster[touch]).collect();
    let rows = context.representations[best.representation].select(Axis(0), &context.sample);
    let (labels, seed) = (&context.sample_labels, context.seed("clusters"));
    let held = readability(rows.view(), labels, Some(&units), &(1..=1), &seed)?;
    let (accuracy, random, chance) = (held.accuracy, best.accuracy(), context.chance());
    let is_found = n_clusters > touches_of_classes(&context.labels).len()
        && random - accuracy >= LEAST_LOSS * (random - chance);
    let sentence = format!(
        "The touches form {n_clusters} separate clusters. With whole clusters held out, {} are recognised; at random, {}.",
        percent(accuracy),
        percent(random)
    );
    let advice = "If a cluster is a sequence, a pose or an object, give it as a group (--groups): a random split then recognises the cluster, not the class.";
    let finding = Finding::counted("clusters", is_found, sentence);
    Some(finding.value(accuracy, random).advice(advice))
}

/// Finds touches whose nearest touches all belong to one other class, to which most classifiers assign them too.
fn doubtful(context: &Context) -> Vec<Doubtful> {
    let touches = 0..context.labels.len();
    let found = touches.filter_map(|touch| {
        let near = context.near.neighbours[touch].get(..N_DOUBTING)?;
        let class = context.labels[near[0]];
        let is_other = class != context.labels[touch]
            && near.iter().all(|&other| context.labels[other] == class);
        let arm = context.arm(0, false);
        let agreeing = arm.filter(|tested| tested.predicted[touch] == Some(class));
        (is_other && agreeing.count() > 1).then_some(Doubtful { touch, class })
    });
    found.collect()
}

/// Reports touches whose labels are doubtful; `None` if no classifier can tell.
fn labels(context: &Context, doubtful: Option<&[Doubtful]>) -> Finding {
    let Some(doubtful) = doubtful else {
        let sentence = "No fast classifier recognises more than chance, so none can tell which labels are wrong.";
        return Finding::new("labels", Verdict::NotChecked, sentence);
    };
    let (n, n_doubtful) = (context.labels.len(), doubtful.len());
    let share = n_doubtful as f64 / n as f64;
    let sentence = format!(
        "The {N_DOUBTING} nearest touches of {n_doubtful} of {n} touches all belong to one other class, as two classifiers say too. Wrong labels look like this, and so do parts that objects share."
    );
    Finding::counted("labels", n_doubtful > 0, sentence)
        .value(share, 0.0)
        .advice("Look at the touches that rows.csv lists before you change a label.")
        .shown_in("doubtful_labels")
}

/// Without groups: the number of independent touches that the touches are worth in their order.
fn sample_size(context: &Context) -> Finding {
    let n = context.labels.len() as f64;
    let effective = effective_by_order(context.residuals().view());
    let sentence =
        format!("By their order, {n} touches are worth {effective:.0} independent ones.");
    Finding::counted("sample_size", 2.0 * effective < n, sentence)
        .value(effective, n)
        .advice("Give the groups of touches that are alike (--groups), and compute intervals over groups.")
}
