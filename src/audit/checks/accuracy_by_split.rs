//! Accuracy by random split, compared with splits by time, groups and sessions.

use crate::audit::check::{CheckAbout, Context, Finding, NO_LABELS, Result};
use crate::audit::finding::percent;
use crate::audit::scores::{METHODS, paired_difference};

/// Minimum relevant difference between two accuracies.
const RELEVANT: f64 = 0.02;

pub const ABOUT: CheckAbout = CheckAbout {
    name: "accuracy_by_split",
    title: "Accuracy by split",
    run,
};

/// Returns the display name of a classifier.
pub fn method_words(method: &str) -> &'static str {
    let known = METHODS.iter().find(|(name, _)| *name == method);
    known.map_or("classifier", |(_, words)| words)
}

/// Returns the display name of the touches that a split holds out.
pub fn split_words(split: &str) -> &'static str {
    match split {
        "time" => "blocks of time",
        "group" => "whole groups",
        "session" => "whole sessions",
        "given" => "the given test set",
        _ => "touches at random",
    }
}

fn run(context: &Context) -> Result<Vec<Finding>> {
    let Some(best) = context.best_at_random() else {
        return Ok(vec![Finding::not_checked("", NO_LABELS)]);
    };
    let words = method_words(best.method);
    let at_random = best.accuracy();
    let interval = best.interval(&context.splits[0])?;
    let first = Finding::note(
        "",
        at_random,
        format!(
            "The best of the cheap classifiers ({words}) recognises {} of touches that are held out at random; naming the most frequent class gives {}.",
            percent(at_random),
            percent(context.chance())
        ),
    )
    .about("random split")
    .within([interval.low, interval.high])
    .against(context.chance())
    .shown_in("accuracy_by_split");
    let mut findings = vec![first];
    let n_methods = context.tested(0).count() as f64;
    for (index, split) in context.splits.iter().enumerate().skip(1) {
        let Some(tested) = context.tested(index).find(|t| t.method == best.method) else {
            continue;
        };
        let units = split.units.as_deref();
        let Some(difference) = paired_difference(&best.is_correct, &tested.is_correct, units)
        else {
            let why = format!(
                "There are fewer than five units in the {} split.",
                split.name
            );
            findings.push(Finding::not_checked("", why).about(format!("{} split", split.name)));
            continue;
        };
        let accuracy = tested.accuracy();
        let interval = tested.interval(split)?;
        let sentence = format!(
            "With {} held out, {words} recognises {}; at random {}.",
            split_words(split.name),
            percent(accuracy),
            percent(at_random)
        );
        // The method was chosen by its accuracy at random, which chance may have raised. The test counts as one for each method.
        let p_value = (difference.p_value * n_methods).min(1.0);
        let evidence = (p_value, difference.mean >= RELEVANT);
        findings.push(
            Finding::tested("", accuracy, sentence, evidence)
                .about(format!("{} split", split.name))
                .within([interval.low, interval.high])
                .against(at_random)
                .shown_in("accuracy_by_split")
                .advice(format!(
                    "Report the accuracy with {} held out. The random split measures the recognition of near neighbours.",
                    split_words(split.name)
                )),
        );
    }
    let has_split = context.splits.iter().any(|split| split.name == "group");
    if context.data.groups.is_some() && !has_split {
        let why = "Fewer than two classes have touches in several groups, so that no group can be held out: the class cannot be told from the group.";
        findings.push(Finding::not_checked("", why).about("group split"));
    }
    if context.data.groups.is_none() {
        let why = "No groups are given: whether touches of one grasp, day or mounting are on both sides of the random split is unknown.";
        findings.push(Finding::not_checked("", why).about("group split"));
    }
    Ok(findings)
}
