//! Saturated readings: the full scale, or a largest reading that several taxels share in many frames.

use crate::audit::check::{CheckAbout, Context, Finding, Result};
use crate::audit::finding::percent;
use crate::table::short_number;

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
        let sentence = "The largest reading is not shared by many frames.".to_owned();
        return Ok(vec![
            Finding::counted("", 0.0, sentence, false).against(0.0),
        ]);
    };
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
        .advice("Press less, reduce the gain of the readout, or state the limit: forces above it are not recorded.")
        .shown_in("taxels");
    Ok(vec![finding])
}
