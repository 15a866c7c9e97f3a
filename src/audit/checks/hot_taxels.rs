//! Hot taxels: a pressure or strong noise while the taxels around them are at rest.

use crate::audit::check::{CheckAbout, Context, Finding, Result};
use crate::audit::finding::percent;
use crate::table::short_number;
use bubbletouch_sim::audit::hot::{HotTaxel, hot_taxels};

pub const ABOUT: CheckAbout = CheckAbout {
    name: "hot_taxels",
    title: "Hot taxels",
    run,
};

/// Finds the hot taxels; constant taxels are stuck, not hot. Without known neighbours, none are found.
pub fn found(context: &Context) -> Vec<HotTaxel> {
    let Some(around) = &context.around else {
        return Vec::new();
    };
    let is_sound: Vec<bool> = context
        .taxels
        .iter()
        .map(|taxel| !taxel.is_constant())
        .collect();
    hot_taxels(context.skin.touched.view(), around, &is_sound)
}

fn run(context: &Context) -> Result<Vec<Finding>> {
    if context.around.is_none() {
        let why = "The taxels have no rows and columns, and contact changes their readings in both directions.";
        return Ok(vec![Finding::not_checked("", why)]);
    }
    let found = found(context);
    let n_taxels = context.taxels.len();
    let share = found.len() as f64 / n_taxels as f64;
    let sentence = match found.first() {
        None => "No taxel reads a pressure or strong noise while the taxels around it are at rest."
            .to_owned(),
        Some(hot) => format!(
            "{} of {n_taxels} taxels read a pressure or strong noise while the taxels around them are at rest, such as number {}: {} of the full scale above them, noise {} times the median.",
            found.len(),
            hot.taxel,
            percent(hot.excess),
            short_number(hot.noise_ratio)
        ),
    };
    let finding = Finding::counted("", share, sentence, !found.is_empty())
        .against(0.0)
        .advice("Mask these taxels, or subtract their level at rest if it is constant.")
        .shown_in("taxels");
    Ok(vec![finding])
}
