//! Steps of the analogue-to-digital converter.

use crate::audit::check::{CheckAbout, Context, Finding, Result};
use crate::audit::finding::percent;
use crate::calibration::converter;

/// Minimum relevant variance of rounding, relative to the variance of the readings of active taxels within a class.
const RELEVANT: f64 = 0.01;

pub const ABOUT: CheckAbout = CheckAbout {
    name: "quantisation",
    title: "Quantisation",
    run,
};

fn run(context: &Context) -> Result<Vec<Finding>> {
    let saturation = context.plateau.unwrap_or(1.0);
    let Some(step) = converter::step(&context.skin, saturation) else {
        let sentence = "The readings have no common step.".to_owned();
        return Ok(vec![
            Finding::counted("", 0.0, sentence, false).against(0.0),
        ]);
    };
    let std = context.active_std / (context.scale.1 - context.scale.0);
    // A step q adds errors of variance q²/12.
    let share = match std > 0.0 {
        true => step * step / 12.0 / (std * std),
        false => f64::INFINITY,
    };
    let sentence = format!(
        "All readings are multiples of {} of the full scale. Rounding adds {} to the variance of the readings of a touched taxel.",
        percent(step),
        percent(share)
    );
    let finding = Finding::counted("", share, sentence, share >= RELEVANT)
        .against(0.0)
        .advice("Use the full range of the converter, or more bits; otherwise small differences of pressure are lost.")
        .shown_in("taxels");
    Ok(vec![finding])
}
