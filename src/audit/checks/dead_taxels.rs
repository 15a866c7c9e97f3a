//! Dead and stuck taxels: constant readings while the taxels around them change.

use crate::audit::check::{CheckAbout, Context, Finding, Result};
use crate::audit::finding::percent;
use crate::calibration::faults::{self, Fault};
use bubbletouch_sim::audit::frozen::frozen_taxels;
use std::collections::BTreeSet;

pub const ABOUT: CheckAbout = CheckAbout {
    name: "dead_taxels",
    title: "Dead and stuck taxels",
    run,
};

/// Reading above which a taxel counts as touched, as a fraction of the full scale.
const TOUCHED: f64 = 0.1;
/// Probability that any working taxel counts as frozen for some time.
const ANY: f64 = 0.001;
/// Minimum number of frames in which a constant taxel lies between two touched taxels.
const MIN_FRAMES: usize = 3;

/// Returns the faulty taxels. On a grid, a fault counts only if the taxel lies between two touched taxels in some frames; other faulty taxels between them, as in
/// faulty rows side by side, are skipped. Outside the contact area, a faultless taxel is constant, too.
pub fn found(context: &Context) -> Vec<Fault> {
    let faults = faults::find(&context.skin);
    let Some((rows, columns)) = context.data.grid else {
        return faults.faults;
    };
    let working = |mut taxels: std::ops::Range<usize>, y: Option<usize>, x: usize| {
        let place = |at: usize| y.map_or(at * columns + x, |y| y * columns + at);
        let first = taxels
            .clone()
            .map(place)
            .find(|&taxel| faults.is_sound[taxel]);
        let last = taxels.rfind(|&at| faults.is_sound[place(at)]).map(place);
        [first, last]
    };
    let is_between = |fault: &Fault| {
        let (y, x) = (fault.taxel / columns, fault.taxel % columns);
        // The nearest working taxels to the left and right, and below and above.
        let across = [
            working(0..x, Some(y), x)[1],
            working(x + 1..columns, Some(y), x)[0],
        ];
        let along = [working(0..y, None, x)[1], working(y + 1..rows, None, x)[0]];
        let pairs = [across, along].map(|[first, last]| Some([first?, last?]));
        let frames = context.skin.touched.outer_iter().filter(|frame| {
            let mut pairs = pairs.iter().flatten();
            pairs.any(|pair| pair.iter().all(|&taxel| frame[taxel] > TOUCHED))
        });
        frames.take(MIN_FRAMES).count() == MIN_FRAMES
    };
    let found = faults.faults.iter().filter(|fault| is_between(fault));
    found.copied().collect()
}

fn run(context: &Context) -> Result<Vec<Finding>> {
    let found = found(context);
    let n_taxels = context.taxels.len();
    let count = |is_dead: bool| found.iter().filter(|f| f.is_dead == is_dead).count();
    let finding = |n: usize, subject: &str, level: &str| {
        let list: Vec<String> = found
            .iter()
            .filter(|fault| fault.is_dead == (subject == "dead"))
            .take(5)
            .map(|fault| fault.taxel.to_string())
            .collect();
        let sentence = match n {
            0 => format!("No taxel stays at {level} while the taxels around it change."),
            _ => format!(
                "{n} of {n_taxels} taxels ({}) stay at {level} while the taxels around them change, such as number {}.",
                percent(n as f64 / n_taxels as f64),
                list.join(", ")
            ),
        };
        Finding::counted("", n as f64 / n_taxels as f64, sentence, n > 0)
            .about(subject)
            .against(0.0)
            .advice("Mask these taxels in all recordings, also in those of other sessions, and state their number.")
            .shown_in("taxels")
    };
    let mut findings = vec![
        finding(count(true), "dead", "the zero"),
        finding(count(false), "stuck", "another level"),
    ];
    findings.push(frozen_finding(context, &found));
    Ok(findings)
}

/// Looks for taxels that keep a reading for some time.
fn frozen_finding(context: &Context, faults: &[Fault]) -> Finding {
    let Some(grid) = context.data.grid else {
        let why =
            "The taxels have no rows and columns, so that the taxels around a taxel are unknown.";
        return Finding::not_checked("", why).about("for some time");
    };
    let mut is_counted: Vec<bool> = context
        .taxels
        .iter()
        .map(|taxel| !taxel.is_constant())
        .collect();
    faults
        .iter()
        .for_each(|fault| is_counted[fault.taxel] = false);
    let frames = context.skin.touched.view();
    let found = frozen_taxels(
        frames,
        grid,
        &context.frame_labels,
        TOUCHED,
        &is_counted,
        ANY,
    );
    let taxels: BTreeSet<usize> = found.iter().map(|run| run.taxel).collect();
    let sentence = match found.iter().max_by_key(|run| run.n_frames) {
        None => {
            "No taxel keeps a reading for some time while the taxels around it change.".to_owned()
        }
        Some(run) => format!(
            "{} taxels keep one reading for some time while the taxels around them change, such as number {} during {} of the frames.",
            taxels.len(),
            run.taxel,
            percent(run.n_frames as f64 / frames.nrows() as f64)
        ),
    };
    let share = taxels.len() as f64 / frames.ncols() as f64;
    Finding::counted("", share, sentence, !found.is_empty())
        .about("for some time")
        .against(0.0)
        .advice("Mask these taxels in the recordings in which they are faulty, or in all, and state their number.")
        .shown_in("taxels")
}
