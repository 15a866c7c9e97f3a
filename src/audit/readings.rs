//! Third question: are the readings sound?

use crate::audit::context::Context;
use crate::audit::finding::{Finding, Verdict, percent};
use crate::table::short_number;
use bubbletouch_sim::audit::taxels::{
    equal_taxels, largest_readings, levels, placeholder, plateau, stuck_taxels,
};
use bubbletouch_svm::audit::permute;
use ndarray::Array1;
use rand::seq::SliceRandom;
use std::collections::BTreeSet;

/// Number of blocks of consecutive touches of a test of drift. More blocks are less independent of each other.
const N_BLOCKS: usize = 20;
/// Number of parts of a recording without sessions in which taxels can be stuck.
const N_PARTS: usize = 10;
/// Minimum number of blocks or groups of a test of drift: permutations of fewer resolve no small p-values.
const MIN_UNITS: usize = 8;

/// State of a taxel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TaxelState {
    /// Nothing was found.
    Working,
    /// All readings are equal.
    Constant,
    /// All readings of a session or part are equal.
    Stuck,
    /// The readings repeat those of another taxel.
    Equal,
}

impl TaxelState {
    /// Returns the word for the state in tables.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Working => "working",
            Self::Constant => "constant",
            Self::Stuck => "stuck",
            Self::Equal => "equal",
        }
    }
}

/// Returns the state of each taxel, and the findings about them.
fn taxels(context: &Context) -> (Vec<TaxelState>, Vec<Finding>) {
    let n = context.taxels.len();
    let mut states = vec![TaxelState::Working; n];
    let frames = context.frames.view();
    let equal = equal_taxels(frames, &context.taxels);
    equal
        .iter()
        .for_each(|pair| states[pair.1] = TaxelState::Equal);
    let parts = context
        .frame_touches
        .iter()
        .map(|&touch| match &context.data.sessions {
            Some(sessions) => sessions[touch],
            None => touch * N_PARTS / context.labels.len(),
        });
    let stuck = stuck_taxels(frames, &parts.collect::<Vec<_>>());
    stuck
        .iter()
        .for_each(|found| states[found.0] = TaxelState::Stuck);
    let is_constant = |taxel: &usize| context.taxels[*taxel].is_constant();
    let constant: Vec<usize> = (0..n).filter(is_constant).collect();
    constant
        .iter()
        .for_each(|&taxel| states[taxel] = TaxelState::Constant);
    let note = |check: &'static str, found: &[usize], what: &str, none: &str| {
        let sentence = match found.is_empty() {
            true => none.to_owned(),
            false => format!("{} of {n} taxels {what}: {}.", found.len(), list(found)),
        };
        let share = found.len() as f64 / n as f64;
        let finding = Finding::counted(check, !found.is_empty(), sentence).value(share, 0.0);
        finding
            .advice("Look at these taxels; leave them out if they are not sound.")
            .shown_in("taxels")
    };
    let levels: BTreeSet<String> = constant
        .iter()
        .map(|&taxel| short_number(context.taxels[taxel].mean))
        .collect();
    let levels = levels.into_iter().take(3).collect::<Vec<_>>().join(", ");
    let part = if context.data.sessions.is_some() {
        "session"
    } else {
        "tenth of the recording"
    };
    let stuck: BTreeSet<usize> = stuck.into_iter().map(|found| found.0).collect();
    let repeated: BTreeSet<usize> = equal.into_iter().map(|pair| pair.1).collect();
    let findings = vec![
        note(
            "constant_taxels",
            &constant,
            &format!("have one reading in all frames ({levels})"),
            "No taxel has one reading in all frames.",
        ),
        note(
            "stuck_taxels",
            &Vec::from_iter(stuck),
            &format!(
                "have one reading in all frames of a {part}, which they rarely have otherwise"
            ),
            "No taxel keeps a reading for a part of the recording.",
        ),
        note(
            "equal_taxels",
            &Vec::from_iter(repeated),
            "are equal or proportional to another taxel in all frames",
            "No taxel repeats another one.",
        ),
    ];
    (states, findings)
}

/// Returns the first numbers of a list as text.
fn list(numbers: &[usize]) -> String {
    let first: Vec<String> = numbers.iter().take(12).map(usize::to_string).collect();
    let more = if numbers.len() > first.len() {
        ", …"
    } else {
        ""
    };
    first.join(", ") + more
}

/// Answers the third question: the state of each taxel, and all findings.
pub fn answer(context: &Context) -> (Vec<TaxelState>, Vec<Finding>) {
    let (states, mut findings) = taxels(context);
    findings.push(missing(context));
    findings.push(saturation(context));
    let levels = levels(context.means.view(), &context.labels);
    for (subject, values, verdict) in [
        ("level", &levels[0], Verdict::Fault),
        ("contact", &levels[1], Verdict::Note),
    ] {
        findings.extend(drift(context, subject, values, verdict));
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

/// Counts touches whose largest reading is the full scale, or a level at which the readings end.
fn saturation(context: &Context) -> Finding {
    let (largest, sign) = largest_readings(
        context.data.frames.view(),
        context.data.n_frames,
        &context.taxels,
    );
    let found = match context.data.full_scale {
        Some(full) => {
            let n = largest
                .iter()
                .filter(|&&reading| reading >= sign * full)
                .count();
            Some((sign * full, n)).filter(|found| found.1 > 0)
        }
        None => plateau(largest),
    };
    let n = context.labels.len();
    let Some((level, n_saturated)) = found else {
        let sentence = "The readings do not end at a common level.";
        return Finding::counted("saturation", false, sentence).value(0.0, 0.0);
    };
    let share = n_saturated as f64 / n as f64;
    let sentence = format!(
        "The largest reading of {n_saturated} of {n} touches ({}) is {}, at which the readings end.",
        percent(share),
        short_number(sign * level)
    );
    Finding::counted("saturation", true, sentence)
        .value(share, 0.0)
        .advice(
            "Use a larger range of the sensor or press less: above this level, the force is lost.",
        )
}

/// Returns the independent parts of the recording in their order: groups if each is a run of touches, otherwise blocks of consecutive touches.
fn parts(context: &Context) -> Vec<Vec<usize>> {
    let n = context.labels.len();
    if let Some(units) = &context.units {
        let n_runs = 1 + units.windows(2).filter(|pair| pair[0] != pair[1]).count();
        if n_runs == units.iter().collect::<BTreeSet<_>>().len() && n_runs >= MIN_UNITS {
            let mut runs = vec![vec![0]];
            for touch in 1..n {
                if units[touch] != units[touch - 1] {
                    runs.push(Vec::new());
                }
                runs.last_mut().expect("a run").push(touch);
            }
            return runs;
        }
    }
    let n_blocks = N_BLOCKS.min(n / 3);
    (0..n_blocks)
        .map(|block| (block * n / n_blocks..(block + 1) * n / n_blocks).collect())
        .collect()
}

/// Tests whether values follow a slow trend in the order of recording, linear or decaying to a constant. Parts of the recording are exchanged.
fn drift(context: &Context, subject: &str, values: &[f64], verdict: Verdict) -> Option<Finding> {
    let parts = parts(context);
    if parts.len() < MIN_UNITS {
        return None;
    }
    let n = parts.len() as f64;
    let mean = |part: &Vec<usize>| {
        part.iter().map(|&touch| values[touch]).sum::<f64>() / part.len() as f64
    };
    let mut means: Vec<f64> = parts.iter().map(mean).collect();
    let centred = |basis: &dyn Fn(f64) -> f64| {
        let basis = Array1::from_iter((0..parts.len()).map(|k| basis(k as f64)));
        let basis = &basis - basis.mean().unwrap_or(0.0);
        let norm = basis.dot(&basis).sqrt();
        basis / norm
    };
    let trends = [centred(&|k| k), centred(&|k| (-8.0 * k / n).exp())];
    let statistic = |means: &[f64]| {
        let means = Array1::from_iter(means.iter().copied());
        trends
            .iter()
            .map(|trend| trend.dot(&means).abs())
            .fold(0.0, f64::max)
    };
    let observed = statistic(&means);
    let quarter = parts.len().div_ceil(4);
    let change =
        means[parts.len() - quarter..].iter().sum::<f64>() - means[..quarter].iter().sum::<f64>();
    let change = change / quarter as f64;
    let mut rng = context.seed("drift").named(subject).rng();
    let found = permute(&context.options.permutations(), observed, || {
        means.shuffle(&mut rng);
        statistic(&means)
    });
    let (value, what) = match subject {
        "level" => {
            let value = change / context.range();
            (
                value,
                format!(
                    "The level of all taxels changes by {} of the range of the readings",
                    percent_of_change(value)
                ),
            )
        }
        _ => (
            change.exp_m1(),
            format!(
                "The size of the contact changes by {}",
                percent_of_change(change.exp_m1())
            ),
        ),
    };
    let sentence = format!("{what} from the first to the last quarter of the recording.");
    let advice = match subject {
        "level" => {
            "Subtract a level that was recorded without contact from each touch, or hold out blocks of time."
        }
        _ => "Find out whether the sensor or the press became weaker, and hold out blocks of time.",
    };
    let finding = Finding::new("drift", verdict, sentence)
        .about(subject)
        .value(value, 0.0);
    Some(finding.tested(&found).advice(advice).shown_in("levels"))
}

/// Formats a change with its sign.
fn percent_of_change(change: f64) -> String {
    format!(
        "{}{}",
        if change < 0.0 { "−" } else { "+" },
        percent(change.abs())
    )
}
