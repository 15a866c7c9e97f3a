//! Drift: levels of untouched taxels that change in the order of recording.

use crate::audit::check::{CheckAbout, Context, Finding, Result};
use crate::audit::finding::percent;
use bubbletouch_sim::audit::dependence::{change_of_level, serial_dependence};
use bubbletouch_sim::audit::taxels::{rest_readings, without_class_means};
use ndarray::{Array2, Axis};

/// Minimum relevant change of the level, as a fraction of the full scale.
const RELEVANT: f64 = 0.001;

pub const ABOUT: CheckAbout = CheckAbout {
    name: "drift",
    title: "Drift",
    run,
};

/// Returns readings of taxels at rest that vary, less the means of their classes, shape (n_sample, m), and the display name of these taxels. If contact
/// reaches all taxels, readings during contact are clipped ([`rest_readings`]).
fn at_rest(context: &Context) -> (Array2<f64>, &'static str) {
    let rows = untouched(context);
    if rows.ncols() > 0 {
        return (rows, "untouched taxels");
    }
    let rest = rest_readings(context.sample_rows.view());
    let varies = |taxel: &usize| {
        rest.column(*taxel)
            .iter()
            .any(|&reading| reading != rest[(0, *taxel)])
    };
    let varying: Vec<usize> = (0..rest.ncols()).filter(varies).collect();
    let rest = without_class_means(
        rest.select(Axis(1), &varying).view(),
        &context.sample_labels,
    );
    (rest, "taxels at rest")
}

/// Returns the readings of untouched taxels that vary, less the means of their classes, shape (n_sample, m).
pub fn untouched(context: &Context) -> Array2<f64> {
    let taxels = 0..context.taxels.len();
    let counted =
        taxels.filter(|&taxel| context.is_untouched[taxel] && !context.taxels[taxel].is_constant());
    context
        .residuals
        .select(Axis(1), &counted.collect::<Vec<_>>())
}

fn run(context: &Context) -> Result<Vec<Finding>> {
    if context.data.grid.is_none() && untouched(context).ncols() == 0 {
        let why = "Contact reaches all taxels, and taxels without rows and columns may read contact in both directions.";
        return Ok(vec![Finding::not_checked("", why)]);
    }
    let (rows, taxels) = at_rest(context);
    if rows.ncols() == 0 {
        let why = "Taxels at rest always read the same.";
        return Ok(vec![Finding::not_checked("", why)]);
    }
    let n_permutations = context.options.n_permutations;
    let seed = context.seed(ABOUT.name);
    let found = serial_dependence(rows.view(), &context.sample_labels, n_permutations, &seed);
    let Some(found) = found else {
        return Ok(vec![Finding::not_checked("", "There are too few touches.")]);
    };
    let change = change_of_level(rows.view()) / (context.scale.1 - context.scale.0);
    let sentence = format!(
        "The levels of {} {taxels} change by {} of the full scale (standard deviation) from the first to the last third of the touches.",
        rows.ncols(),
        percent(change)
    );
    let finding = Finding::tested("", change, sentence, (found.p_value, change >= RELEVANT))
        .against(0.0)
        .advice("Record frames without contact now and then, subtract them, and record the classes in random order.")
        .shown_in("levels");
    Ok(vec![finding])
}
