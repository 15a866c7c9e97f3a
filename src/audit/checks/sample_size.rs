//! Effective sample size: independent touches that contain as much information as all touches.

use crate::audit::check::{CheckAbout, Context, Finding, Result};
use crate::table::short_number;
use bubbletouch_sim::audit::dependence::{group_dependence, serial_dependence};
use bubbletouch_sim::audit::taxels::without_class_means;
use ndarray::Axis;
use rand::seq::SliceRandom;
use std::collections::BTreeMap;

/// Effective sample size, as a fraction of the touches, below which the check can report a fault.
const RELEVANT: f64 = 0.9;
/// Maximum number of touches in the test of groups.
const MAX_TOUCHES: usize = 1000;

pub const ABOUT: CheckAbout = CheckAbout {
    name: "sample_size",
    title: "Effective sample size",
    run,
};

fn run(context: &Context) -> Result<Vec<Finding>> {
    let n = context.labels.len();
    let mut findings = Vec::new();
    let units = [
        ("groups", &context.data.groups),
        ("sessions", &context.data.sessions),
    ];
    for (name, units) in units {
        if let Some(units) = units {
            findings.push(of_units(context, name, units));
        }
    }
    let rows = context.sample_features();
    let residuals = without_class_means(rows.view(), &context.sample_labels);
    let n_permutations = context.options.n_permutations;
    let found = serial_dependence(
        residuals.view(),
        &context.sample_labels,
        n_permutations,
        &context.seed(ABOUT.name),
    );
    findings.push(match found {
        None => Finding::not_checked("", "There are too few touches."),
        Some(found) => {
            let correlation = found.correlation.clamp(0.0, 0.99);
            // Sample of an autoregressive process of first order.
            let effective = n as f64 * (1.0 - correlation) / (1.0 + correlation);
            let sentence = format!(
                "Touches that follow each other within a class correlate by {}: {n} touches are worth about {} independent ones.",
                short_number(found.correlation),
                short_number(effective.round())
            );
            let evidence = (found.p_value, effective < RELEVANT * n as f64);
            Finding::tested("", effective, sentence, evidence)
                .advice("Give touches of one recording the same group, and compute intervals over groups.")
        }
    }
    .about("order")
    .against(n as f64)
    .shown_in("levels"));
    Ok(findings)
}

/// Estimates the effective sample size from the correlation within groups.
fn of_units(context: &Context, name: &'static str, units: &[usize]) -> Finding {
    let n = units.len();
    let mut members = BTreeMap::<usize, Vec<usize>>::new();
    for (touch, &unit) in units.iter().enumerate() {
        members.entry(unit).or_default().push(touch);
    }
    let squares: usize = members.values().map(|touches| touches.len().pow(2)).sum();
    let size = squares as f64 / n as f64;
    let mut members: Vec<Vec<usize>> = members.into_values().collect();
    members.shuffle(&mut context.seed(name).rng());
    let mut touches: Vec<usize> = Vec::new();
    for unit in members {
        if touches.len() + unit.len() <= MAX_TOUCHES || touches.is_empty() {
            touches.extend(unit);
        }
    }
    touches.truncate(2 * MAX_TOUCHES);
    touches.sort_unstable();
    let rows = context.features.blocks.select(Axis(0), &touches);
    let of = |all: &[usize]| -> Vec<usize> { touches.iter().map(|&touch| all[touch]).collect() };
    let (labels, own) = (of(&context.labels), of(units));
    let residuals = without_class_means(rows.view(), &labels);
    let n_permutations = context.options.n_permutations;
    let seed = context.seed(name);
    match group_dependence(residuals.view(), &labels, &own, n_permutations, &seed) {
        None => Finding::not_checked("", format!("Each class is in one of the {name}, or no two touches share one.")),
        Some(found) => {
            // Design effect of clusters of the mean size.
            let design = 1.0 + (size - 1.0) * found.correlation.max(0.0);
            let effective = n as f64 / design;
            let sentence = format!(
                "Touches of one class correlate by {} within {name}: {n} touches are worth about {} independent ones.",
                short_number(found.correlation),
                short_number(effective.round())
            );
            let evidence = (found.p_value, effective < RELEVANT * n as f64);
            Finding::tested("", effective, sentence, evidence).advice(format!(
                "Compute intervals over {name}, and record more {name} rather than more touches of each."
            ))
        }
    }
    .about(name)
    .against(n as f64)
    .shown_in("accuracy_by_split")
}
