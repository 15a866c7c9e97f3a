//! Second question: can the class be read from what should not name it?
//!
//! Each source is a list of features of the touches. One test, with units exchanged, decides whether the class can be read from them.

use crate::audit::context::{Context, MAX_BLOCKS};
use crate::audit::finding::{Finding, Verdict, percent};
use crate::audit::splits::is_same;
use bubbletouch_sim::audit::dependence::without_class_means;
use bubbletouch_sim::audit::pooled::pooled;
use bubbletouch_svm::audit::Readability;
use ndarray::{Array1, Array2, Axis};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Smallest gain of accuracy over exchanged labels that is reported. With less, weak dependences of large data sets are reported.
const LEAST_GAIN: f64 = 0.05;

/// Features of touches, the places of these touches in the sample, and whether units are held out.
struct Features {
    rows: Array2<f64>,
    places: Vec<usize>,
    has_units: bool,
    /// Subject and verb of the sentence, such as "The mean reading names".
    names: String,
}

/// Source from which labels may be readable.
pub struct Source {
    /// Name in tables, and for `--not-claimed`; also the name of the check.
    pub name: &'static str,
    /// Whether the source is part of the claim unless the user says otherwise.
    pub is_claimed: bool,
    features: fn(&Context) -> Option<Features>,
}

/// All sources.
pub const SOURCES: [Source; 9] = [
    source("order", false, order),
    source("session", false, session),
    source("padding", false, padding),
    source("mean", true, mean),
    source("noise", true, noise),
    source("place", true, place),
    source("single_taxel", true, single_taxel),
    source("before_contact", false, before_contact),
    source("untouched", false, untouched),
];

const fn source(
    name: &'static str,
    is_claimed: bool,
    features: fn(&Context) -> Option<Features>,
) -> Source {
    Source {
        name,
        is_claimed,
        features,
    }
}

/// Result of the test of a source.
pub struct SourceResult {
    /// Accuracy and its test.
    pub found: Readability,
    /// Finding of the check with the name of the source.
    pub finding: Finding,
}

/// Tests all sources that the data contain.
pub fn tested(context: &Context) -> Vec<SourceResult> {
    if !context.has_classes {
        return Vec::new();
    }
    let found = SOURCES.par_iter().filter_map(|source| {
        let features = (source.features)(context)?;
        let Features {
            rows,
            places,
            has_units,
            ..
        } = &features;
        let is_claimed = match &context.options.not_claimed {
            Some(names) => !names.iter().any(|name| name == source.name),
            None => source.is_claimed,
        };
        // The p-value of a note needs no more permutations than the correction.
        let n = context.options.n_permutations;
        let range = if is_claimed { n..=n } else { context.options.permutations() };
        let by = (source.name, &range);
        let found = context.readability(rows.view(), places, *has_units, by)?;
        let gain = found.accuracy - found.permuted.mean;
        let verdict = match is_claimed {
            _ if gain < LEAST_GAIN => Verdict::Passed,
            true => Verdict::Note,
            false => Verdict::Fault,
        };
        let advice = match is_claimed {
            true => format!("If this is not part of the claim, add {} to --not-claimed: it is then a fault.", source.name),
            false => "Make it alike for all classes when you record, remove it from the readings, or hold out whole units in which it is constant.".to_owned(),
        };
        let sentence = format!(
            "{} the class of {} of the touches; exchanged labels give {} (95 %: {}).",
            features.names,
            percent(found.accuracy),
            percent(found.permuted.mean),
            percent(found.permuted.bound)
        );
        let finding = Finding::new(source.name, verdict, sentence)
            .value(found.accuracy, found.permuted.mean)
            .tested(&found.permuted)
            .advice(advice)
            .shown_in("sources");
        Some(SourceResult { found, finding })
    });
    found.collect()
}

/// Returns the findings of all sources, and what could not be checked.
pub fn findings(context: &Context, results: &[SourceResult]) -> Vec<Finding> {
    let mut findings: Vec<Finding> = results
        .iter()
        .map(|result| result.finding.clone())
        .collect();
    let given = [
        ("before_contact", context.options.before_contact.is_some()),
        ("untouched", !context.options.untouched.is_empty()),
    ];
    for (name, is_given) in given {
        if is_given && context.has_classes && !findings.iter().any(|finding| finding.check == name)
        {
            findings.push(Finding::counted(
                name,
                false,
                "These readings never change, so that they name no class.",
            ));
        }
    }
    if context.has_classes && is_sorted(context) {
        let sentence = "The touches of each session or group are sorted by class, as files often are. Their order is not known to be the order of recording, and it was not tested.";
        let finding = Finding::new("order", Verdict::NotChecked, sentence);
        findings.push(finding.advice("Give the time of each touch (--times)."));
    }
    findings
}

/// Returns whether the order of the touches is that of a file: within each session, each group or the whole file, the touches of each class of several touches
/// follow each other, or the classes ascend.
fn is_sorted(context: &Context) -> bool {
    let (data, labels) = (&context.data, &context.labels);
    let is_sorted_within = |units: &Vec<usize>| {
        let cells: Vec<_> = units.iter().zip(labels).collect();
        let n_runs = 1 + cells.windows(2).filter(|pair| pair[0] != pair[1]).count();
        let n_cells = cells.iter().collect::<BTreeSet<_>>().len();
        let n_units = units.iter().collect::<BTreeSet<_>>().len();
        let mut of_units = cells.clone();
        of_units.sort_by_key(|cell| cell.0);
        let are_ascending = of_units.is_sorted();
        let are_runs = n_runs == n_cells && 2 * n_cells <= cells.len();
        n_cells > n_units && (are_runs || are_ascending)
    };
    let whole = Some(vec![0; labels.len()]);
    let mut of = [&data.sessions, &data.groups, &whole].into_iter().flatten();
    !data.is_in_order_of_time && of.any(is_sorted_within)
}

/// Returns features of all sampled touches; `None` if they are equal.
fn of_sample(context: &Context, rows: Array2<f64>, names: &str) -> Option<Features> {
    let mut columns = rows.columns().into_iter();
    let is_varying = columns.any(|column| column.iter().any(|&x| x != column[0]));
    is_varying.then(|| Features {
        rows,
        places: (0..context.sample.len()).collect(),
        has_units: true,
        names: names.to_owned(),
    })
}

/// Returns one number of each sampled touch as features; `None` if they are equal.
fn of_each(context: &Context, names: &str, number: impl Fn(usize) -> f64) -> Option<Features> {
    let numbers = context.sample.iter().map(|&touch| number(touch));
    let rows = Array1::from_iter(numbers).insert_axis(Axis(1));
    of_sample(context, rows, names)
}

fn order(context: &Context) -> Option<Features> {
    let names = match context.data.is_in_order_of_time {
        true => "The place in the order of time names",
        false => "The place in the file names",
    };
    of_each(context, names, |touch| touch as f64).filter(|_| !is_sorted(context))
}

/// One column of 0 and 1 for each session. Groups are the units; without groups, touches are. If each session is a group, the split by groups is the test.
fn session(context: &Context) -> Option<Features> {
    let (sessions, groups) = (context.data.sessions.as_ref()?, &context.data.groups);
    let known = Vec::from_iter(sessions.iter().collect::<BTreeSet<_>>());
    let is_group = groups
        .as_ref()
        .is_some_and(|groups| is_same(groups, sessions));
    if is_group || !(2..=MAX_BLOCKS).contains(&known.len()) {
        return None;
    }
    let shape = (context.sample.len(), known.len());
    let rows = Array2::from_shape_fn(shape, |(place, column)| {
        f64::from(u8::from(sessions[context.sample[place]] == *known[column]))
    });
    let features = of_sample(context, rows, "The session names")?;
    Some(Features {
        has_units: groups.is_some(),
        ..features
    })
}

/// Numbers of frames after the end: frames without readings, and frames that repeat the frame before them up to the end.
fn padding(context: &Context) -> Option<Features> {
    let (n_frames, frames) = (context.data.n_frames, &context.data.frames);
    let names = "The number of padded or equal frames at the end names";
    let repeated = |touch: usize| {
        let last = (touch + 1) * n_frames - 1 - context.n_padded[touch];
        let is_equal = |frame: &usize| frames.row(*frame) == frames.row(last);
        let equal = (touch * n_frames..last).rev().take_while(is_equal);
        (equal.count() + context.n_padded[touch]) as f64
    };
    of_each(context, names, repeated)
}

fn mean(context: &Context) -> Option<Features> {
    let mean = |touch: usize| context.means.row(touch).mean().unwrap_or(0.0);
    of_each(context, "The mean reading names", mean)
}

/// Logarithm of the mean square of second differences over the frames of a touch.
fn noise(context: &Context) -> Option<Features> {
    let n_frames = context.data.n_frames;
    let names = "The size of the changes from frame to frame names";
    let noise = |touch: usize| {
        let row = |frame: usize| context.data.frames.row(touch * n_frames + frame);
        let own = 2..n_frames - context.n_padded[touch].min(n_frames - 3);
        let squares = own.clone().map(|frame| {
            let second = &row(frame) - 2.0 * &row(frame - 1) + row(frame - 2);
            second.dot(&second)
        });
        (squares.sum::<f64>() / own.len() as f64 + f64::MIN_POSITIVE).ln()
    };
    (n_frames > 3).then(|| of_each(context, names, noise))?
}

/// Centre of the deviations from the median of each taxel, on the grid.
fn place(context: &Context) -> Option<Features> {
    let (_, columns) = context.data.grid.filter(|grid| grid.0.min(grid.1) > 2)?;
    let mut rows = Array2::zeros((context.sample.len(), 2));
    for (&touch, mut row) in context.sample.iter().zip(rows.rows_mut()) {
        let readings = context.means.row(touch);
        let away = readings.iter().zip(&context.taxels);
        let weights = away.map(|(reading, taxel)| (reading - taxel.median).powi(2));
        let weights: Vec<f64> = weights.collect();
        for (taxel, weight) in weights.iter().enumerate() {
            row[0] += weight * (taxel / columns) as f64;
            row[1] += weight * (taxel % columns) as f64;
        }
        row /= weights.iter().sum::<f64>() + f64::MIN_POSITIVE;
    }
    of_sample(context, rows, "The centre of the contact names")
}

/// Reading of the taxel whose means differ most between the classes in half of the units; the test uses the other half.
fn single_taxel(context: &Context) -> Option<Features> {
    let unit = |place: usize| match &context.units {
        Some(units) => units[context.sample[place]],
        None => place,
    };
    // A bit that depends on the number of the unit without a period that designs have.
    let half = |unit: usize| (unit as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40 & 1;
    let places = 0..context.sample.len();
    let (chosen, places): (Vec<usize>, Vec<usize>) = places.partition(|&k| half(unit(k)) == 0);
    if context.taxels.len() < 2 || chosen.len() < 2 || places.len() < 2 {
        return None;
    }
    let rows = |places: &[usize]| {
        let touches: Vec<usize> = places.iter().map(|&place| context.sample[place]).collect();
        context.means.select(Axis(0), &touches)
    };
    let labels = chosen.iter().map(|&place| context.sample_labels[place]);
    let of_half = rows(&chosen);
    let within = without_class_means(of_half.view(), &labels.collect::<Vec<_>>());
    let share = within.var_axis(Axis(0), 0.0) / of_half.var_axis(Axis(0), 0.0);
    let known = (0..share.len()).filter(|&taxel| share[taxel].is_finite());
    let taxel = known.min_by(|&a, &b| share[a].total_cmp(&share[b]))?;
    let place = match context.data.grid {
        Some((_, columns)) => format!(" (row {}, column {})", taxel / columns, taxel % columns),
        None => String::new(),
    };
    Some(Features {
        rows: rows(&places).select(Axis(1), &[taxel]),
        places,
        has_units: true,
        names: format!("Taxel {taxel}{place} alone names"),
    })
}

fn before_contact(context: &Context) -> Option<Features> {
    let range = context.options.before_contact.clone()?;
    let first = |touch: &usize| touch * context.data.n_frames;
    let touches = context.sample.iter().map(first);
    let frames = touches.flat_map(|first| range.clone().map(move |frame| first + frame));
    let frames: Vec<usize> = frames.collect();
    let frames = context.data.frames.select(Axis(0), &frames);
    let rows = pooled(frames.view(), range.len(), context.data.grid, MAX_BLOCKS);
    of_sample(context, rows, "The frames before contact name")
}

fn untouched(context: &Context) -> Option<Features> {
    let rows = context.means.select(Axis(0), &context.sample);
    let rows = rows.select(Axis(1), &context.options.untouched);
    of_sample(context, rows, "The taxels that you name as untouched name")
}
