//! Labels that can be read from taxels that are never touched.

use crate::audit::check::{CheckAbout, Context, Finding, NO_LABELS, Result, Source};
use crate::audit::checks::before_contact::{noise_levels, some_columns};
use ndarray::Array2;

pub const ABOUT: CheckAbout = CheckAbout {
    name: "untouched_taxels",
    title: "Taxels that nothing touches",
    run,
};

pub const SOURCE: Source = Source {
    name: "untouched_taxels",
    rows,
    holds_out_groups: true,
    is_tested: true,
};

/// Noise of the taxels that are never touched.
pub const NOISE: Source = Source {
    name: "noise_of_untouched_taxels",
    rows: |context| noise_levels(&rows(context)?),
    holds_out_groups: true,
    is_tested: true,
};

fn rows(context: &Context) -> Option<Array2<f64>> {
    let is_counted =
        |taxel: usize| context.is_untouched[taxel] && !context.taxels[taxel].is_constant();
    let rows = some_columns(&context.sample_rows, is_counted);
    (rows.ncols() > 0).then_some(rows)
}

fn run(context: &Context) -> Result<Vec<Finding>> {
    if !context.has_classes() {
        return Ok(vec![Finding::not_checked("", NO_LABELS)]);
    }
    let n = context.is_untouched.iter().filter(|&&is| is).count();
    let Some(found) = context.readable.get(SOURCE.name) else {
        let why = match n {
            0 => "Contact reaches all taxels.",
            _ => "The taxels that nothing touches always read the same.",
        };
        return Ok(vec![Finding::not_checked("", why)]);
    };
    let names = format!("The {n} taxels that nothing touches name");
    let advice = "Subtract the level of the untouched taxels from each frame, mask them, and record the classes in random order.";
    let mut findings = vec![Finding::names_class(found, &names, advice)];
    if let Some(found) = context.readable.get(NOISE.name) {
        let names = "The noise of the taxels that nothing touches names";
        let advice = "Mask the untouched taxels, and record the classes in random order and with the same settings of the sensor.";
        findings.push(Finding::names_class(found, names, advice).about("noise"));
    }
    Ok(findings)
}
