//! Dead and stuck taxels: constant readings while the taxels around them change.

use crate::audit::check::{CheckAbout, Context, Finding, Result};
use crate::audit::finding::percent;
use crate::calibration::faults::{self, Fault};
use bubbletouch_sim::audit::frozen::{
    FrozenTaxel, Searched, always_quiet_taxels, frozen_taxels, quiet_taxels,
};
use bubbletouch_sim::statistics::quantile::quantile;
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

/// Maximum fraction of the taxels of a list that are faulty. The other taxels give the variation of a working taxel that nothing touches.
const MAX_FAULTY: f64 = 0.1;
/// Maximum standard deviation of a faulty taxel of a list, relative to a working taxel that nothing touches.
const MAX_VARIATION: f64 = 0.1;

/// Returns the faulty taxels. On a grid, a fault counts only if the taxel lies between two touched taxels in some frames; other faulty taxels between them, as in
/// faulty rows side by side, are skipped. Outside the contact area, a faultless taxel is constant, too. In a list, a faulty taxel varies less than taxels that
/// nothing touches, and keeps a reading that is rare among the readings of all taxels.
pub fn found(context: &Context) -> Vec<Fault> {
    let faults = faults::find(&context.skin);
    let Some((rows, columns)) = context.data.grid else {
        let mut stds: Vec<f64> = context.taxels.iter().map(|taxel| taxel.std).collect();
        let untouched = quantile(&mut stds, MAX_FAULTY);
        let frames = &context.skin.touched;
        let is_still = |fault: &Fault| {
            let level = frames[(0, fault.taxel)];
            let n_equal = frames.iter().filter(|&&reading| reading == level).count();
            context.taxels[fault.taxel].std < MAX_VARIATION * untouched
                && (n_equal as f64) < MAX_FAULTY * frames.len() as f64
        };
        return faults.faults.into_iter().filter(is_still).collect();
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
    findings.extend(for_some_time(context, &found));
    Ok(findings)
}

/// Looks for taxels that keep a reading, or remain at rest, for some time.
fn for_some_time(context: &Context, faults: &[Fault]) -> Vec<Finding> {
    let Some(around) = &context.around else {
        let why = "The taxels have no rows and columns, and contact changes their readings in both directions.";
        return vec![Finding::not_checked("", why).about("for some time")];
    };
    let mut is_counted: Vec<bool> = context
        .taxels
        .iter()
        .map(|taxel| !taxel.is_constant())
        .collect();
    faults
        .iter()
        .for_each(|fault| is_counted[fault.taxel] = false);
    let searched = Searched {
        frames: context.skin.touched.view(),
        around,
        labels: &context.frame_labels,
        units: &context.frame_units,
        touched: TOUCHED,
        is_counted: &is_counted,
        significance: ANY,
    };
    let finding = |found: &[FrozenTaxel], [one, verb]: [&str; 2], about: &str| {
        let taxels: BTreeSet<usize> = found.iter().map(|run| run.taxel).collect();
        let sentence = match found.iter().max_by_key(|run| run.n_frames) {
            None => format!("No taxel {one} for some time while the taxels around it change."),
            Some(run) => format!(
                "{} taxels {verb} for some time while the taxels around them change, such as number {} during {} of the frames.",
                taxels.len(),
                run.taxel,
                percent(run.n_frames as f64 / context.skin.touched.nrows() as f64)
            ),
        };
        let share = taxels.len() as f64 / context.taxels.len() as f64;
        Finding::counted("", share, sentence, !found.is_empty())
            .about(about)
            .against(0.0)
            .advice("Mask these taxels in the recordings in which they are faulty, or in all, and state their number.")
            .shown_in("taxels")
    };
    let always = always_quiet_taxels(&searched).into_iter();
    let always = always.map(|taxel| FrozenTaxel {
        taxel,
        first: 0,
        n_frames: searched.frames.nrows(),
    });
    let always: Vec<FrozenTaxel> = always.collect();
    // A taxel that is always at rest is at rest for some time, too.
    let is_other = |run: &FrozenTaxel| always.iter().all(|other| other.taxel != run.taxel);
    let mut quiet = quiet_taxels(&searched);
    quiet.retain(is_other);
    quiet.extend(&always);
    vec![
        finding(
            &frozen_taxels(&searched),
            ["keeps one reading", "keep one reading"],
            "for some time",
        ),
        finding(
            &quiet,
            ["remains at rest", "remain at rest, apart from noise,"],
            "at rest for some time",
        ),
    ]
}
