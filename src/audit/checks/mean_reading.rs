//! Labels that can be read from the mean of the frames better than from their shape.

use crate::audit::check::{CheckAbout, Context, Finding, NO_LABELS, Result, Source};
use crate::audit::finding::percent;
use ndarray::{Array2, Axis};
use statrs::distribution::{Binomial, DiscreteCDF};

pub const ABOUT: CheckAbout = CheckAbout {
    name: "mean_reading",
    title: "Mean reading",
    run,
};

/// Minimum relevant difference of the two accuracies. If it is smaller, the shape alone carries nearly the same claim.
const RELEVANT: f64 = 0.05;

pub const MEAN: Source = Source {
    name: "mean_reading",
    rows: |context| Some(means(context)),
    holds_out_groups: true,
    is_tested: false,
};

pub const SHAPE: Source = Source {
    name: "shape",
    rows: |context| Some(shapes(context.sample_features())),
    holds_out_groups: true,
    is_tested: false,
};

pub const INVARIANT_SHAPE: Source = Source {
    name: "invariant_shape",
    rows: |context| {
        let invariant = context.features.invariant.as_ref()?;
        Some(shapes(invariant.select(Axis(0), &context.sample)))
    },
    holds_out_groups: true,
    is_tested: false,
};

/// Returns the mean of all readings of each sampled touch.
fn means(context: &Context) -> Array2<f64> {
    let means = context.sample_rows.mean_axis(Axis(1));
    means.expect("at least one taxel").insert_axis(Axis(1))
}

/// Returns the rows less their means, with norm 1.
pub fn shapes(mut rows: Array2<f64>) -> Array2<f64> {
    for mut row in rows.rows_mut() {
        let mean = row.mean().unwrap_or(0.0);
        row -= mean;
        let norm = row.dot(&row).sqrt();
        row /= if norm > 0.0 { norm } else { 1.0 };
    }
    rows
}

fn run(context: &Context) -> Result<Vec<Finding>> {
    if !context.has_classes() {
        return Ok(vec![Finding::not_checked("", NO_LABELS)]);
    }
    let readable = |name: &str| context.readable.get(name);
    let shapes = [SHAPE, INVARIANT_SHAPE];
    let shape = shapes.iter().filter_map(|source| readable(source.name));
    let shape = shape.max_by(|a, b| a.accuracy.total_cmp(&b.accuracy));
    let (Some(mean), Some(shape)) = (readable(MEAN.name), shape) else {
        return Ok(vec![Finding::not_checked("", "There are too few touches.")]);
    };
    let count = |first: &[bool], second: &[bool]| {
        let pairs = first.iter().zip(second);
        pairs.filter(|(first, second)| **first && !**second).count() as u64
    };
    let [only_mean, only_shape] = [
        count(&mean.is_correct, &shape.is_correct),
        count(&shape.is_correct, &mean.is_correct),
    ];
    // McNemar's exact test: if both are equally accurate, each touch that only one of them recognises favours either with probability 1/2.
    let binomial = Binomial::new(0.5, only_mean + only_shape);
    let p_value = match (only_mean, binomial) {
        (1.., Ok(binomial)) => binomial.sf(only_mean - 1),
        _ => 1.0,
    };
    let sentence = format!(
        "The mean reading alone names the class of {} of the touches; the shape of the frames, without mean and scale, {}; permuted labels {}.",
        percent(mean.accuracy),
        percent(shape.accuracy),
        percent(mean.chance)
    );
    let advice = "The classes differ in force, depth or offset more than in shape. Press all classes with the same forces, or claim no more than a recognition of force.";
    let is_relevant = mean.accuracy - shape.accuracy >= RELEVANT;
    let finding = Finding::tested("", mean.accuracy, sentence, (p_value, is_relevant))
        .against(shape.accuracy)
        .advice(advice)
        .shown_in("confounds");
    Ok(vec![finding])
}
