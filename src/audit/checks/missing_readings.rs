//! Missing readings: NaN and infinite numbers.

use crate::audit::check::{CheckAbout, Context, Finding, Result};
use crate::audit::finding::percent;

pub const ABOUT: CheckAbout = CheckAbout {
    name: "missing_readings",
    title: "Missing readings",
    run,
};

fn run(context: &Context) -> Result<Vec<Finding>> {
    let n: usize = context.n_missing.iter().sum();
    let share = n as f64 / context.data.frames.len() as f64;
    let n_taxels = context.n_missing.iter().filter(|&&count| count > 0).count();
    let sentence = match n {
        0 => "No reading is missing.".to_owned(),
        _ => format!(
            "{n} readings ({}) of {n_taxels} taxels are NaN or infinite. The other checks use the median of the taxel instead.",
            percent(share)
        ),
    };
    let finding = Finding::counted("", share, sentence, n > 0)
        .against(0.0)
        .advice("Mask taxels with many missing readings, and leave out frames with others; state both. taxels.csv has the counts.")
        .shown_in("taxels");
    Ok(vec![finding])
}
