//! Drift: levels of untouched taxels, and gains, that change in the order of recording.

use crate::audit::check::{CheckAbout, Context, Finding, Result};
use crate::audit::finding::percent;
use crate::quantile::quantile;
use bubbletouch_sim::audit::dependence::{change_of_level, serial_dependence};
use bubbletouch_sim::audit::gain::{means_of_runs, relative_gains};
use bubbletouch_sim::audit::taxels::{rest_readings, without_class_means};
use ndarray::{Array2, Axis};

/// Minimum relevant change of the level, as a fraction of the full scale.
const RELEVANT: f64 = 0.001;

pub const ABOUT: CheckAbout = CheckAbout {
    name: "drift",
    title: "Drift",
    run,
};

/// Minimum number of untouched taxels from which their levels alone are tested.
const MIN_UNTOUCHED: usize = 8;
/// Fraction of the taxels with the least changes that count as taxels at rest. Frequent contact changes the others.
const CALM: f64 = 0.25;

/// Returns readings of taxels at rest that vary, less the means of their classes, shape (n_sample, m), and the display name of these taxels. If contact
/// reaches nearly all taxels, readings during contact are clipped ([`rest_readings`]), and the taxels with the least changes count.
fn at_rest(context: &Context) -> (Array2<f64>, &'static str) {
    let rows = untouched(context);
    if rows.ncols() >= MIN_UNTOUCHED || (rows.ncols() > 0 && context.around.is_none()) {
        return (rows, "untouched taxels");
    }
    // Contact must increase the readings.
    let is_falling = context.scale.1 < context.scale.0;
    let sign = if is_falling { -1.0 } else { 1.0 };
    let rest = rest_readings(context.sample_rows.mapv(|x| sign * x).view());
    let rest = without_class_means(rest.view(), &context.sample_labels);
    let stds = rest.std_axis(Axis(0), 0.0);
    let mut varying: Vec<f64> = stds.iter().copied().filter(|&std| std > 0.0).collect();
    if varying.is_empty() {
        return (rows, "untouched taxels");
    }
    let most = quantile(&mut varying, CALM);
    let calm = (0..rest.ncols()).filter(|&taxel| stds[taxel] > 0.0 && stds[taxel] <= most);
    (
        rest.select(Axis(1), &calm.collect::<Vec<_>>()),
        "taxels at rest",
    )
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
    Ok(vec![level(context), gain(context)])
}

/// Minimum relevant change of the gain.
const RELEVANT_GAIN: f64 = 0.01;
/// Significance level from which neighbouring touches count as alike in their shapes.
const ALIKE: f64 = 0.01;

/// Tests whether the gain changes in the order of recording. Touches of one class and group that follow each other are compared as one touch.
fn gain(context: &Context) -> Finding {
    let not_checked = |why: &str| Finding::not_checked("", why).about("gain");
    let rows = context.sample_features();
    let Some(found) = relative_gains(rows.view(), &context.sample_labels) else {
        return not_checked("No class has 20 touches with contact.");
    };
    let of = |list: &[usize]| -> Vec<usize> { found.rows.iter().map(|&row| list[row]).collect() };
    let labels = of(&context.sample_labels);
    let units = match &context.data.groups {
        Some(groups) => of(&context.sample)
            .iter()
            .map(|&touch| groups[touch])
            .collect(),
        None => (0..labels.len()).collect::<Vec<_>>(),
    };
    let n_permutations = context.options.n_permutations;
    let dependence = |rows: &Array2<f64>, name: &str| {
        let (means, labels) = means_of_runs(rows.view(), &labels, &units);
        let residuals = without_class_means(means.view(), &labels);
        let square = residuals.iter().map(|x| x * x).sum::<f64>() / residuals.len() as f64;
        let seed = context.seed(name);
        let found = serial_dependence(residuals.view(), &labels, n_permutations, &seed)?;
        Some((found, square))
    };
    let gains = Array2::from_shape_vec((found.gains.len(), 1), found.gains.clone());
    let gains = gains.expect("one gain per row");
    let (Some((shape, _)), Some((gain, square))) = (
        dependence(&found.shapes, "shapes in time"),
        dependence(&gains, "gain"),
    ) else {
        return not_checked("There are too few touches, or all gains are equal.");
    };
    if shape.p_value <= ALIKE {
        let why = "Touches that follow each other have similar shapes, so that a drift of the gain cannot be told from copies of touches.";
        return not_checked(why);
    }
    // Neighbours in time share the slow part of the gain.
    let change = (square * gain.correlation.max(0.0)).sqrt();
    let sentence = format!(
        "The gain changes slowly by {} (standard deviation) in the order of the touches, compared with touches of equal shape.",
        percent(change)
    );
    Finding::tested("", change, sentence, (gain.p_value, change >= RELEVANT_GAIN))
        .about("gain")
        .against(0.0)
        .advice("Press a reference object now and then and divide by its reading, or use features without scale; record the classes in random order.")
        .shown_in("levels")
}

/// Tests whether the level of taxels at rest changes in the order of recording.
fn level(context: &Context) -> Finding {
    if context.around.is_none() && untouched(context).ncols() == 0 {
        let why = "Contact reaches all taxels, and taxels without rows and columns may read contact in both directions.";
        return Finding::not_checked("", why);
    }
    let (rows, taxels) = at_rest(context);
    if rows.ncols() == 0 {
        let why = "Taxels at rest always read the same.";
        return Finding::not_checked("", why);
    }
    let n_permutations = context.options.n_permutations;
    let seed = context.seed(ABOUT.name);
    let found = serial_dependence(rows.view(), &context.sample_labels, n_permutations, &seed);
    let Some(found) = found else {
        return Finding::not_checked("", "There are too few touches.");
    };
    // A level that rises and falls again has equal ends, but neighbours in time share it.
    let square = rows.iter().map(|x| x * x).sum::<f64>() / rows.len() as f64;
    let slow = (square * found.correlation.max(0.0)).sqrt();
    let change = change_of_level(rows.view()).max(slow) / (context.scale.1 - context.scale.0).abs();
    let sentence = format!(
        "The levels of {} {taxels} change by {} of the full scale (standard deviation) in the order of the touches.",
        rows.ncols(),
        percent(change)
    );
    Finding::tested("", change, sentence, (found.p_value, change >= RELEVANT))
        .against(0.0)
        .advice("Record frames without contact now and then, subtract them, and record the classes in random order.")
        .shown_in("levels")
}
