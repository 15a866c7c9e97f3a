//! Saturated readings: the full scale, a largest reading that several taxels share in many frames, or taxels that are clipped at levels of their own.

use crate::audit::check::{CheckAbout, Context, Finding, Result};
use crate::audit::finding::percent;
use crate::calibration::plateau;
use crate::table::short_number;
use bubbletouch_sim::audit::clipped::clipped_at;
use ndarray::ArrayView1;

/// Probability that any taxel without saturation counts as clipped.
const ANY: f64 = 0.001;
/// Minimum fraction of frames with a single largest reading, from which the frames count as scaled to their largest reading.
const MIN_SCALED: f64 = 0.99;

const ADVICE: &str = "Press less, reduce the gain of the readout, or state the limit: forces above it are not recorded.";

pub const ABOUT: CheckAbout = CheckAbout {
    name: "saturation",
    title: "Saturation",
    run,
};

fn run(context: &Context) -> Result<Vec<Finding>> {
    // The frames are fractions of the full scale.
    let level = match context.data.full_scale {
        Some(_) => Some(context.plateau.map_or(1.0, |level| level.min(1.0))),
        None => context.plateau,
    };
    let Some(level) = level else {
        return Ok(vec![of_taxels(context)]);
    };
    if context.data.full_scale.is_none() && is_normalised(context, level) {
        let sentence = "The largest reading of each frame is the same: the frames are scaled, so that saturation cannot be seen.";
        return Ok(vec![Finding::not_checked("", sentence)]);
    }
    let frames = context.skin.touched.outer_iter();
    let is_constant = |taxel: usize| context.taxels[taxel].is_constant();
    let is_saturated = frames.map(|frame| {
        let mut readings = frame.iter().enumerate();
        readings.any(|(taxel, &reading)| reading >= level && !is_constant(taxel))
    });
    let n_saturated = is_saturated.filter(|&is| is).count();
    let share = n_saturated as f64 / context.skin.touched.nrows() as f64;
    let reading = context.scale.0 + level * (context.scale.1 - context.scale.0);
    let sentence = format!(
        "{} of the frames contain a taxel at {}, {}.",
        percent(share),
        short_number(reading),
        match context.data.full_scale {
            Some(_) => "the full scale or a plateau below it",
            None => "the largest reading, which several taxels share",
        }
    );
    let finding = Finding::counted("", share, sentence, n_saturated > 0)
        .against(0.0)
        .advice(ADVICE)
        .shown_in("taxels");
    Ok(vec![finding])
}

/// Returns whether exactly one reading of nearly each frame is at the level, as after division of each frame by its largest reading.
fn is_normalised(context: &Context, level: f64) -> bool {
    let frames = context.skin.touched.outer_iter();
    let is_single = |frame: &ArrayView1<f64>| frame.iter().filter(|&&x| x >= level).count() == 1;
    let n_single = frames.filter(is_single).count();
    n_single as f64 >= MIN_SCALED * context.skin.touched.nrows() as f64
}

/// Returns the fraction of frames with a taxel at the smallest reading, and this reading, if several taxels share it in many frames.
fn lower_plateau(context: &Context) -> Option<(f64, f64)> {
    let frames = || context.skin.touched.outer_iter();
    let negative = |(taxel, &reading): (usize, &f64)| match context.taxels[taxel].is_constant() {
        true => f64::NAN,
        false => -reading,
    };
    let level = -plateau(|| frames().map(|frame| frame.into_iter().enumerate().map(negative)))?;
    let is_clipped = |frame: &ArrayView1<f64>| {
        let mut readings = frame.iter().enumerate();
        readings.any(|(taxel, &x)| x <= level && !context.taxels[taxel].is_constant())
    };
    let n_clipped = frames().filter(is_clipped).count();
    Some((
        n_clipped as f64 / context.skin.touched.nrows() as f64,
        level,
    ))
}

/// Looks for taxels that are clipped at levels of their own. If contact reduces the readings, the smallest readings are clipped.
fn of_taxels(context: &Context) -> Finding {
    let frames = context.skin.touched.view();
    let std = context.active_std / (context.scale.1 - context.scale.0);
    let active: Vec<usize> = (0..frames.ncols())
        .filter(|&taxel| {
            let readings = &context.taxels[taxel];
            !readings.is_constant()
                && context.residuals.column(taxel).std(0.0) > 0.25 * context.active_std
        })
        .collect();
    let cubes = |taxel: &usize| {
        let readings = frames.column(*taxel);
        let mean = readings.mean().unwrap_or(0.0);
        readings
            .iter()
            .map(|x| ((x - mean) / std).powi(3))
            .sum::<f64>()
    };
    let skewness: f64 = active.iter().map(cubes).sum();
    let sign = if skewness < 0.0 { -1.0 } else { 1.0 };
    if sign < 0.0
        && let Some((share, level)) = lower_plateau(context)
    {
        let reading = context.scale.0 + level * (context.scale.1 - context.scale.0);
        let sentence = format!(
            "{} of the frames contain a taxel at {}, the smallest reading, which several taxels share.",
            percent(share),
            short_number(reading)
        );
        return Finding::counted("", share, sentence, true)
            .against(0.0)
            .advice(ADVICE)
            .shown_in("taxels");
    }
    let significance = ANY / active.len().max(1) as f64;
    let clipped = active.iter().filter_map(|&taxel| {
        let mut readings: Vec<f64> = frames.column(taxel).iter().map(|x| sign * x).collect();
        readings.sort_by(f64::total_cmp);
        let level = clipped_at(ArrayView1::from(&readings), significance)?;
        Some((taxel, readings.iter().filter(|&&x| x == level).count()))
    });
    let clipped: Vec<(usize, usize)> = clipped.collect();
    let n: usize = clipped.iter().map(|(_, n)| n).sum();
    let share = n as f64 / (frames.nrows() * active.len().max(1)) as f64;
    let end = if sign < 0.0 { "smallest" } else { "largest" };
    let sentence = match clipped.first() {
        None => format!("The {end} reading is not shared by many frames."),
        Some((taxel, of_taxel)) => format!(
            "{} taxels read their {end} reading more often than the readings beside it allow, such as number {taxel} in {} of the frames.",
            clipped.len(),
            percent(*of_taxel as f64 / frames.nrows() as f64)
        ),
    };
    Finding::counted("", share, sentence, !clipped.is_empty())
        .against(0.0)
        .advice(ADVICE)
        .shown_in("taxels")
}
