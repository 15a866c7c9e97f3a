//! Third question: are the readings sound?

use crate::audit::context::Context;
use crate::audit::finding::{Finding, Verdict, percent};
use crate::table::short_number;
use bubbletouch_sim::audit::taxels::{equal_taxels, levels, placeholder, stuck_taxels};
use bubbletouch_sim::calibration::plateau;
use bubbletouch_svm::audit::permute;
use ndarray::{Array1, ArrayView1};
use rand::seq::SliceRandom;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::ops::Range;

/// Number of blocks of consecutive touches into which a recording without units is divided. More blocks are less independent of each other; fewer show no short
/// changes.
pub const N_BLOCKS: usize = 10;
/// Minimum number of blocks or units of a test of drift: permutations of fewer resolve no small p-values.
const MIN_UNITS: usize = 8;

/// State of a taxel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TaxelState {
    /// Nothing was found.
    Working,
    /// The readings repeat those of another taxel.
    Equal,
    /// All readings of a session or part are equal.
    Stuck,
    /// All readings are equal.
    Constant,
}

/// Returns the state of each taxel, and the findings about them.
fn taxels(context: &Context) -> (Vec<TaxelState>, Vec<Finding>) {
    let n = context.taxels.len();
    let frames = context.frames.view();
    let touches = context.frame_touches.iter();
    let parts = touches.map(|&touch| match &context.data.sessions {
        Some(sessions) => sessions[touch],
        None => touch * N_BLOCKS / context.labels.len(),
    });
    let part = match context.data.sessions {
        Some(_) => "session",
        None => "tenth of the recording",
    };
    let is_constant = |taxel: &usize| context.taxels[*taxel].is_constant();
    let constant: Vec<usize> = (0..n).filter(is_constant).collect();
    let levels = constant
        .iter()
        .map(|&taxel| short_number(context.taxels[taxel].mean));
    let levels = Vec::from_iter(levels.collect::<BTreeSet<_>>().into_iter().take(3));
    let rows = [
        (
            "equal_taxels",
            TaxelState::Equal,
            equal_taxels(frames, &context.taxels),
            "are equal or proportional to another taxel in all frames".to_owned(),
            "No taxel repeats another one.",
        ),
        (
            "stuck_taxels",
            TaxelState::Stuck,
            stuck_taxels(frames, &parts.collect::<Vec<_>>()),
            format!("have one reading in all frames of a {part}, which they rarely have otherwise"),
            "No taxel keeps a reading for a part of the recording.",
        ),
        (
            "constant_taxels",
            TaxelState::Constant,
            constant,
            format!("have one reading in all frames ({})", levels.join(", ")),
            "No taxel has one reading in all frames.",
        ),
    ];
    let mut states = vec![TaxelState::Working; n];
    let findings = rows.map(|(check, state, found, what, none)| {
        found.iter().for_each(|&taxel| states[taxel] = state);
        let sentence = match found.is_empty() {
            true => none.to_owned(),
            false => format!("{} of {n} taxels {what}: {}.", found.len(), list(&found)),
        };
        let finding = Finding::counted(check, !found.is_empty(), sentence);
        finding
            .value(found.len() as f64 / n as f64, 0.0)
            .advice("Look at these taxels; leave them out if they are not sound.")
            .shown_in("taxels")
    });
    let findings = findings.to_vec();
    (states, findings)
}

/// Returns the first numbers of a list as text.
fn list(numbers: &[usize]) -> String {
    let first: Vec<String> = numbers.iter().take(12).map(usize::to_string).collect();
    let more = if numbers.len() > 12 { ", …" } else { "" };
    first.join(", ") + more
}

/// Answers the third question: the state of each taxel, and all findings.
pub fn answer(context: &Context) -> (Vec<TaxelState>, Vec<Finding>) {
    let (states, mut findings) = taxels(context);
    findings.push(missing(context));
    findings.push(saturation(context));
    let levels = levels(context.means.view(), &context.labels);
    for (subject, values) in ["level", "contact"].into_iter().zip(&levels) {
        findings.push(drift(context, subject, values));
    }
    (states, findings)
}

fn missing(context: &Context) -> Finding {
    let n_readings =
        context.data.frames.len() - context.n_padded.iter().sum::<usize>() * context.taxels.len();
    let n_missing: usize = context.n_missing.iter().sum();
    let mut sentence = format!(
        "{n_missing} of {n_readings} readings are NaN or infinite; the median of the taxel replaced them."
    );
    if n_missing == 0 {
        sentence = "No reading is NaN or infinite.".to_owned();
    }
    let lengths = || context.n_padded.iter().map(|n| context.data.n_frames - n);
    if let (Some(least), Some(most)) = (lengths().min(), lengths().max())
        && least < most
    {
        sentence += &format!(
            " Touches have {least} to {most} frames; frames after the end of a touch are not counted."
        );
    }
    let stands = placeholder(context.frames.view(), &context.taxels);
    if let Some((value, n)) = stands {
        sentence += &format!(
            " {n} of {} examined readings are {}, far from all others: it can stand for a missing reading.",
            context.frames.len(),
            short_number(value)
        );
    }
    Finding::counted(
        "missing_readings",
        n_missing > 0 || stands.is_some(),
        sentence,
    )
    .value(n_missing as f64 / n_readings.max(1) as f64, 0.0)
    .advice("State how missing readings are replaced before a classifier sees them.")
    .shown_in("taxels")
}

/// Counts touches with a reading at the full scale, or at a level at which the readings end.
fn saturation(context: &Context) -> Finding {
    let taxels = &context.taxels;
    let varying = (0..taxels.len()).filter(|&taxel| !taxels[taxel].is_constant());
    let varying: Vec<usize> = varying.collect();
    let away = varying.iter().map(|&taxel| &taxels[taxel]);
    let away = away.map(|taxel| match context.data.full_scale {
        Some(full_scale) => full_scale - taxel.median,
        None => taxel.largest + taxel.least - 2.0 * taxel.median,
    });
    // Contact lowers the readings of some sensors.
    let sign = if away.sum::<f64>() >= 0.0 { 1.0 } else { -1.0 };
    let frames = &context.data.frames;
    let signed = |frame: usize| {
        varying
            .iter()
            .map(move |&taxel| sign * frames[(frame, taxel)])
    };
    let level = match context.data.full_scale {
        Some(full_scale) => Some(sign * full_scale),
        None => plateau(|| (0..frames.nrows()).map(signed)),
    };
    let (n, n_frames) = (context.labels.len(), context.data.n_frames);
    let level = level.unwrap_or(f64::INFINITY);
    let is_saturated = |touch: &usize| {
        let mut own = (touch * n_frames..(touch + 1) * n_frames).flat_map(signed);
        own.any(|reading| reading >= level)
    };
    let n_saturated = (0..n).filter(is_saturated).count();
    let share = n_saturated as f64 / n as f64;
    let (sentence, advice) = match n_saturated {
        0 => ("The readings do not end at a common level.".to_owned(), ""),
        _ if n_saturated == n && context.data.full_scale.is_none() => (
            format!(
                "The largest reading of every touch is {}, as if each frame was scaled by its own maximum.",
                short_number(sign * level)
            ),
            "Use one scale for all frames: with a scale of its own, a frame does not show the force.",
        ),
        _ => (
            format!(
                "The largest reading of {n_saturated} of {n} touches ({}) is {}, at which the readings end.",
                percent(share),
                short_number(sign * level)
            ),
            "Use a larger range of the sensor or press less: above this level, the force is lost.",
        ),
    };
    let finding = Finding::counted("saturation", n_saturated > 0, sentence);
    finding.value(share, 0.0).advice(advice)
}

/// Returns the independent parts of the recording in their order: runs of touches of one session, or else of one group, or else blocks of consecutive touches.
fn parts(context: &Context) -> Vec<Range<usize>> {
    let n = context.labels.len();
    let units = context
        .data
        .sessions
        .as_ref()
        .or(context.data.groups.as_ref());
    let ends: Vec<usize> = match units {
        Some(units) => (1..n)
            .filter(|&touch| units[touch] != units[touch - 1])
            .chain([n])
            .collect(),
        None => (1..=N_BLOCKS).map(|block| block * n / N_BLOCKS).collect(),
    };
    let starts = [0].into_iter().chain(ends.clone());
    starts.zip(ends).map(|(start, end)| start..end).collect()
}

/// Tests whether values follow a slow trend in the order of recording, linear or decaying to a constant. Parts of the recording are exchanged.
fn drift(context: &Context, subject: &str, values: &[f64]) -> Finding {
    let parts = parts(context);
    let n = parts.len();
    if n < MIN_UNITS {
        let sentence =
            format!("A trend cannot be told from the differences of only {n} groups or sessions.");
        return Finding::new("drift", Verdict::NotChecked, sentence).about(subject);
    }
    let means = parts
        .into_iter()
        .map(|part| Array1::from(values[part].to_vec()).mean());
    let mut means: Vec<f64> = means.flatten().collect();
    let trends: [fn(f64) -> f64; 2] = [|place| place, |place| (-8.0 * place).exp()];
    let trends = trends.map(|trend| {
        let basis = Array1::from_iter((0..n).map(|part| trend(part as f64 / n as f64)));
        let basis = &basis - basis.mean().unwrap_or(0.0);
        let norm = basis.dot(&basis).sqrt();
        basis / norm
    });
    let statistic = |means: &[f64]| {
        let sizes = trends
            .iter()
            .map(|trend| trend.dot(&ArrayView1::from(means)).abs());
        sizes.fold(0.0, f64::max)
    };
    let observed = statistic(&means);
    let quarter = n.div_ceil(4);
    let change = means[n - quarter..].iter().sum::<f64>() - means[..quarter].iter().sum::<f64>();
    let change = change / quarter as f64;
    let mut rng = context.seed("drift").named(subject).rng();
    let found = permute(&context.options.permutations(), observed, || {
        means.shuffle(&mut rng);
        statistic(&means)
    });
    let (value, verdict, what, advice) = match subject {
        "level" => (
            change / context.range(),
            Verdict::Fault,
            "The level of all taxels, as a fraction of the range of the readings, changes by",
            "Subtract a level that was recorded without contact from each touch, or hold out blocks of time.",
        ),
        _ => (
            change.exp_m1(),
            Verdict::Note,
            "The size of the contact changes by",
            "Find out whether the sensor or the press became weaker, and hold out blocks of time.",
        ),
    };
    let sign = if value < 0.0 { "−" } else { "+" };
    let sentence = format!(
        "{what} {sign}{} from the first to the last quarter of the recording.",
        percent(value.abs())
    );
    let finding = Finding::new("drift", verdict, sentence).about(subject);
    let finding = finding.value(value, 0.0).tested(&found);
    finding.advice(advice).shown_in("levels")
}
