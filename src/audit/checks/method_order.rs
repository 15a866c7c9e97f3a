//! Order of the classifiers by random split, compared with the order by other splits.

use crate::audit::check::{CheckAbout, Context, Finding, NO_LABELS, Result};
use crate::audit::checks::accuracy_by_split::{method_words, split_words};
use crate::audit::finding::percent;
use crate::audit::scores::{Tested, paired_difference};

pub const ABOUT: CheckAbout = CheckAbout {
    name: "method_order",
    title: "Order of methods",
    run,
};

/// Pair of classifiers that changes its order, and the p-value of the change.
struct Reversal<'a> {
    better_at_random: &'a Tested,
    better_held_out: &'a Tested,
    p_value: f64,
}

fn run(context: &Context) -> Result<Vec<Finding>> {
    if !context.has_classes() {
        return Ok(vec![Finding::not_checked("", NO_LABELS)]);
    }
    let at_random: Vec<&Tested> = context.tested(0).collect();
    let mut findings = Vec::new();
    for (index, split) in context.splits.iter().enumerate().skip(1) {
        let held_out: Vec<&Tested> = context.tested(index).collect();
        let difference = |tested: &[&Tested], first: usize, second: usize| {
            let [first, second] = [first, second].map(|at| &tested[at].is_correct);
            paired_difference(first, second, split.units.as_deref())
        };
        let mut strongest: Option<Reversal> = None;
        let mut n_pairs = 0;
        let n_methods = at_random.len().min(held_out.len());
        for first in 0..n_methods {
            for second in (0..n_methods).filter(|&second| second != first) {
                let before = difference(&at_random, first, second);
                let after = difference(&held_out, second, first);
                let (Some(before), Some(after)) = (before, after) else {
                    continue;
                };
                n_pairs += 1;
                // A reversal requires two real differences, so the larger p-value counts (intersection-union test).
                let p_value = before.p_value.max(after.p_value);
                if strongest
                    .as_ref()
                    .is_none_or(|known| p_value < known.p_value)
                {
                    strongest = Some(Reversal {
                        better_at_random: at_random[first],
                        better_held_out: at_random[second],
                        p_value,
                    });
                }
            }
        }
        let subject = format!("{} split", split.name);
        let Some(found) = strongest else {
            let why = "There are fewer than five units to compare.";
            findings.push(Finding::not_checked("", why).about(subject));
            continue;
        };
        let accuracy = |tested: &[&Tested], method: &str| {
            let tested = tested.iter().find(|tested| tested.method == method);
            tested.map_or(f64::NAN, |tested| tested.accuracy())
        };
        let [first, second] = [found.better_at_random, found.better_held_out].map(|t| t.method);
        // Each unordered pair can be reversed in one direction only.
        let p_value = (found.p_value * f64::from(n_pairs) / 2.0).min(1.0);
        let gain = accuracy(&held_out, second) - accuracy(&held_out, first);
        let (held, random) = (split_words(split.name), "touches at random");
        let numbers = |tested: &[&Tested], held: &str| {
            format!(
                "{} and {} with {held} held out",
                percent(accuracy(tested, first)),
                percent(accuracy(tested, second))
            )
        };
        let sentence = match p_value <= 0.05 && gain > 0.0 {
            true => format!(
                "The order of {} and {} reverses: {}, {}.",
                method_words(first),
                method_words(second),
                numbers(&at_random, random),
                numbers(&held_out, held)
            ),
            false => format!(
                "No pair of classifiers reverses its order clearly; the nearest to it is {} and {}: {}, {}.",
                method_words(first),
                method_words(second),
                numbers(&at_random, random),
                numbers(&held_out, held)
            ),
        };
        findings.push(
            Finding::tested("", gain, sentence, (p_value, gain > 0.0))
                .about(subject)
                .against(0.0)
                .shown_in("accuracy_by_split")
                .advice(format!(
                    "Compare methods with {held} held out. A comparison by a random split prefers methods that remember single recordings."
                )),
        );
    }
    Ok(findings)
}
