//! Steps of the analogue-to-digital converter.

use crate::audit::check::{CheckAbout, Context, Finding, Result};
use crate::audit::finding::percent;
use crate::quantile::quantile;
use crate::table::short_number;
use bubbletouch_sim::audit::counts::{n_levels, variance_to_mean};
use ndarray::Array2;

/// Number of levels over the range of a taxel's readings below which its readings are coarse: steps of more than 1 % of the range.
const MIN_LEVELS: f64 = 100.0;
/// Minimum fraction of the touched taxels with coarse readings.
const MIN_SHARE: f64 = 0.1;
/// Maximum number of touched taxels whose levels are counted.
const MAX_TAXELS: usize = 256;
/// Ratio of variance and mean from which integers are counts of events: 1 less the error of the estimate.
const COUNTS: f64 = 0.8;

pub const ABOUT: CheckAbout = CheckAbout {
    name: "quantisation",
    title: "Quantisation",
    run,
};

/// Returns the sampled frames as recorded, if all readings are integers; otherwise `None`.
pub fn integers(context: &Context) -> Option<Array2<f64>> {
    let (zero, full_scale) = context.scale;
    let raw = (context.skin.touched.view()).mapv(|reading| zero + reading * (full_scale - zero));
    let tolerance = 1e-6 * full_scale.abs().max(1.0);
    let are_integers = raw.iter().all(|x| (x - x.round()).abs() <= tolerance);
    are_integers.then(|| raw.mapv(f64::round))
}

/// Returns whether the readings are counts of events: integers from 0 whose variance is at least their mean.
pub fn are_counts(context: &Context) -> bool {
    let Some(counts) = integers(context) else {
        return false;
    };
    let least = counts.iter().copied().fold(f64::INFINITY, f64::min);
    least == 0.0
        && variance_to_mean(counts.view(), context.data.grid).is_some_and(|ratio| ratio >= COUNTS)
}

fn run(context: &Context) -> Result<Vec<Finding>> {
    let mut stds: Vec<f64> = context.taxels.iter().map(|taxel| taxel.std).collect();
    let least = 0.5 * quantile(&mut stds, 0.95);
    let touched = (0..context.taxels.len()).filter(|&taxel| {
        let readings = &context.taxels[taxel];
        readings.std >= least && !readings.is_constant()
    });
    let touched: Vec<usize> = touched.collect();
    if touched.is_empty() {
        let why = "All readings of a taxel are equal.";
        return Ok(vec![Finding::not_checked("", why)]);
    }
    let step = touched.len().div_ceil(MAX_TAXELS);
    let saturation = context.plateau.unwrap_or(f64::INFINITY);
    let levels = touched.iter().step_by(step);
    let levels = levels.map(|&taxel| n_levels(context.skin.touched.column(taxel), saturation));
    let levels: Vec<f64> = levels.collect();
    let mut few: Vec<f64> = levels.iter().copied().filter(|&n| n < MIN_LEVELS).collect();
    let share = few.len() as f64 / levels.len() as f64;
    if share < MIN_SHARE {
        let sentence = format!("Touched taxels read at least {MIN_LEVELS} levels.");
        let mut levels = levels;
        let median = quantile(&mut levels, 0.5);
        let value = if median.is_finite() { median } else { f64::NAN };
        let finding = Finding::counted("", value, sentence, false);
        return Ok(vec![finding.against(MIN_LEVELS)]);
    }
    let median = quantile(&mut few, 0.5);
    if are_counts(context) {
        let sentence = format!(
            "The readings are counts of events, at most about {} for each taxel. Their variance is at least their mean, so that rounding loses nothing.",
            short_number(median - 1.0)
        );
        let note = Finding::note("", median, sentence).against(MIN_LEVELS);
        let advice =
            "State the time over which events are counted; longer times give larger counts.";
        return Ok(vec![note.advice(advice).shown_in("taxels")]);
    }
    let sentence = format!(
        "{} of the touched taxels read fewer than {MIN_LEVELS} levels over the range of their readings, about {} of them.",
        percent(share),
        short_number(median)
    );
    let finding = Finding::counted("", median, sentence, true)
        .against(MIN_LEVELS)
        .advice("Use the full range of the converter, or more bits; otherwise small differences of pressure are lost.")
        .shown_in("taxels");
    Ok(vec![finding])
}
