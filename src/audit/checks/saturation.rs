//! Saturated readings: the full scale, a largest reading that several taxels share in many frames, or taxels that are clipped at levels of their own.

use crate::audit::check::{CheckAbout, Context, Finding, Result};
use crate::audit::checks::quantisation::integers;
use crate::audit::finding::percent;
use crate::table::short_number;
use bubbletouch_sim::audit::clipped::clipped_at;
use bubbletouch_sim::audit::wrapped::wrapped;
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
    Ok(vec![of_readings(context), wrap_around(context)])
}

/// Looks for integers that wrap around.
fn wrap_around(context: &Context) -> Finding {
    let Some(frames) = integers(context) else {
        return Finding::not_checked("", "The readings are no integers.").about("wrap-around");
    };
    let is_varying = context.taxels.iter().map(|taxel| !taxel.is_constant());
    let is_varying: Vec<bool> = is_varying.collect();
    let found = wrapped(frames.view(), context.around.as_ref(), &is_varying);
    let n_frames = found.map_or(0, |found| found.n_frames);
    let share = n_frames as f64 / frames.nrows() as f64;
    let sentence = match found {
        None => "No readings seem to wrap around at the ends of the range of integers.".to_owned(),
        Some(found) => format!(
            "{} of the frames contain readings that {} integers of {} bits.",
            percent(share),
            match found.is_below_zero {
                true => "seem to be below zero and to continue at the largest of the",
                false => "seem to exceed the largest and to continue at the smallest of the",
            },
            found.bits
        ),
    };
    Finding::counted("", share, sentence, found.is_some())
        .about("wrap-around")
        .against(0.0)
        .advice("Record with a wider type or a smaller gain, or undo the wrap-around before use; the jumps are no contact.")
        .shown_in("taxels")
}

/// Looks for readings that the full scale limits.
fn of_readings(context: &Context) -> Finding {
    // The frames are fractions of the full scale.
    let level = match context.data.full_scale {
        Some(_) => Some(context.plateau.map_or(1.0, |level| level.min(1.0))),
        None => context.plateau,
    };
    let Some(level) = level else {
        return of_taxels(context);
    };
    if context.data.full_scale.is_none() && is_normalised(context, level) {
        let sentence = "The largest reading of each frame is the same: the frames are scaled, so that saturation cannot be seen.";
        return Finding::not_checked("", sentence);
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
            None if context.scale.1 < context.scale.0 => {
                "the smallest reading, which several taxels share"
            }
            None => "the largest reading, which several taxels share",
        }
    );
    Finding::counted("", share, sentence, n_saturated > 0)
        .against(0.0)
        .advice(ADVICE)
        .shown_in("taxels")
}

/// Returns whether exactly one reading of nearly each frame is at the level, as after division of each frame by its largest reading.
fn is_normalised(context: &Context, level: f64) -> bool {
    let frames = context.skin.touched.outer_iter();
    let is_single = |frame: &ArrayView1<f64>| frame.iter().filter(|&&x| x >= level).count() == 1;
    let n_single = frames.filter(is_single).count();
    n_single as f64 >= MIN_SCALED * context.skin.touched.nrows() as f64
}

/// Looks for taxels that are clipped at levels of their own. If contact reduces the readings, the smallest readings are clipped.
fn of_taxels(context: &Context) -> Finding {
    let frames = context.skin.touched.view();
    let active: Vec<usize> = (0..frames.ncols())
        .filter(|&taxel| {
            let readings = &context.taxels[taxel];
            !readings.is_constant()
                && context.residuals.column(taxel).std(0.0) > 0.25 * context.active_std
        })
        .collect();
    let significance = ANY / active.len().max(1) as f64;
    let clipped = active.iter().filter_map(|&taxel| {
        let mut readings = frames.column(taxel).to_vec();
        readings.sort_by(f64::total_cmp);
        let level = clipped_at(ArrayView1::from(&readings), significance)?;
        Some((taxel, readings.iter().filter(|&&x| x == level).count()))
    });
    let clipped: Vec<(usize, usize)> = clipped.collect();
    let n: usize = clipped.iter().map(|(_, n)| n).sum();
    let share = n as f64 / (frames.nrows() * active.len().max(1)) as f64;
    let is_falling = context.scale.1 < context.scale.0;
    let end = if is_falling { "smallest" } else { "largest" };
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
