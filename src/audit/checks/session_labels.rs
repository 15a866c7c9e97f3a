//! Classes that depend on the session, file or group of a touch.
//!
//! The test is Pearson's χ² statistic of the table of classes and sessions. Its p-value follows from permuted labels, so that small counts are allowed.

use crate::audit::check::{CheckAbout, Context, Finding, NO_LABELS, Result, Source};
use crate::audit::finding::percent;
use ndarray::Array2;
use rand::seq::SliceRandom;
use std::collections::{BTreeMap, BTreeSet};

pub const ABOUT: CheckAbout = CheckAbout {
    name: "session_labels",
    title: "Sessions and classes",
    run,
};

pub const SOURCE: Source = Source {
    name: "session",
    rows: |context| one_column_per_unit(context, context.data.sessions.as_ref()?),
    holds_out_groups: false,
    is_tested: false,
};

pub const GROUPS: Source = Source {
    name: "group",
    rows: |context| {
        let groups = context.data.groups.as_ref()?;
        let groups = are_crossed(context, groups).then_some(groups)?;
        one_column_per_unit(context, groups)
    },
    holds_out_groups: false,
    is_tested: false,
};

/// Returns one column per session or group with 1 for its touches.
fn one_column_per_unit(context: &Context, units: &[usize]) -> Option<Array2<f64>> {
    let all: BTreeSet<usize> = units.iter().copied().collect();
    let all: Vec<usize> = all.into_iter().collect();
    if all.len() < 2 || all.len() > context.sample.len() / 2 {
        return None;
    }
    let mut rows = Array2::zeros((context.sample.len(), all.len()));
    for (mut row, &touch) in rows.rows_mut().into_iter().zip(&context.sample) {
        let place = all.partition_point(|&unit| unit < units[touch]);
        row[place] = 1.0;
    }
    Some(rows)
}

/// Returns the permutation p-value of the independence of classes and units.
fn p_value(context: &Context, units: &[usize], name: &str) -> f64 {
    let all: BTreeSet<usize> = units.iter().copied().collect();
    let all: Vec<usize> = all.into_iter().collect();
    let units = units
        .iter()
        .map(|unit| all.partition_point(|other| other < unit));
    let units: Vec<usize> = units.collect();
    let count = |of: &[usize]| {
        let mut counts = vec![0.0; of.iter().max().map_or(0, |largest| largest + 1)];
        of.iter().for_each(|&number| counts[number] += 1.0);
        counts
    };
    let (of_units, of_classes) = (count(&units), count(&context.labels));
    let n_classes = of_classes.len();
    let mut counts = vec![0.0; n_classes * of_units.len()];
    // With fixed sums of rows and columns, χ² grows with the sum of n² / (row sum × column sum). One touch more adds 2 n + 1 to n².
    let mut statistic = |labels: &[usize]| -> f64 {
        counts.fill(0.0);
        let mut sum = 0.0;
        for (&unit, &label) in units.iter().zip(labels) {
            let count = &mut counts[unit * n_classes + label];
            sum += (2.0 * *count + 1.0) / (of_units[unit] * of_classes[label]);
            *count += 1.0;
        }
        sum
    };
    let observed = statistic(&context.labels);
    let mut labels = context.labels.clone();
    let mut rng = context.seed(name).rng();
    let (mut at_least, mut n_done) = (0, 0);
    while context.permutes_again(n_done, at_least) {
        n_done += 1;
        labels.shuffle(&mut rng);
        at_least += usize::from(statistic(&labels) >= observed * (1.0 - 1e-9));
    }
    (1 + at_least) as f64 / (1 + n_done) as f64
}

/// Returns whether most groups contain several classes, as the touches of one person do. Groups of one class each, such as grasps of an object, are usual.
fn are_crossed(context: &Context, groups: &[usize]) -> bool {
    let mut classes = BTreeMap::<usize, BTreeSet<usize>>::new();
    for (&group, &label) in groups.iter().zip(&context.labels) {
        classes.entry(group).or_default().insert(label);
    }
    2 * classes.values().filter(|classes| classes.len() > 1).count() >= classes.len()
}

fn run(context: &Context) -> Result<Vec<Finding>> {
    if !context.has_classes() {
        return Ok(vec![Finding::not_checked("", NO_LABELS)]);
    }
    let sessions = context.data.sessions.as_deref();
    let groups = context.data.groups.as_deref();
    let groups = groups.filter(|groups| are_crossed(context, groups));
    let mut findings = vec![match sessions {
        Some(sessions) => of_units(context, (SOURCE.name, sessions)),
        None => Finding::not_checked("", "No sessions are given."),
    }];
    if let Some(groups) = groups {
        findings.push(of_units(context, (GROUPS.name, groups)).about("groups"));
    }
    Ok(findings)
}

fn of_units(context: &Context, (name, units): (&'static str, &[usize])) -> Finding {
    let Some(found) = context.readable.get(name) else {
        let why = format!("There is one {name}, or nearly one for each touch.");
        return Finding::not_checked("", why);
    };
    let sentence = format!(
        "The {name} of a touch names its class for {} of the touches; permuted labels give {}.",
        percent(found.accuracy),
        percent(found.chance)
    );
    let advice = format!(
        "Record all classes in each {name}. If each {name} has its own classes, no split separates the class from the {name}."
    );
    Finding::tested(
        "",
        found.accuracy,
        sentence,
        (p_value(context, units, name), true),
    )
    .against(found.chance)
    .advice(advice)
    .shown_in("confounds")
}
