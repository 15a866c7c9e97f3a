//! Labels that can be read from frames before the contact.

use crate::audit::check::{CheckAbout, Context, Finding, NO_LABELS, Result, Source};
use crate::audit::finding::percent;
use crate::quantile::quantile;
use bubbletouch_sim::audit::taxels::{contact_sums, untouched_taxels, without_class_means};
use ndarray::{Array2, Axis};
use std::collections::BTreeMap;

/// Maximum number of readings from which the label is read.
pub const MAX_READINGS: usize = 256;

pub const ABOUT: CheckAbout = CheckAbout {
    name: "before_contact",
    title: "Frames before contact",
    run,
};

pub const SOURCE: Source = Source {
    name: "before_contact",
    rows,
    holds_out_groups: true,
    is_tested: true,
};

/// Readings of all taxels in the first or the last frame, whichever varies less within classes; the frame may contain contact.
pub const QUIETEST: Source = Source {
    name: "quietest_frame",
    rows: |context| Some(some_columns(&quietest_frame(context)?.0, |_| true)),
    holds_out_groups: true,
    is_tested: false,
};

/// Number of frames before the contact of each touch, if all touches begin at rest.
pub const ONSET: Source = Source {
    name: "contact_onset",
    rows: onset,
    holds_out_groups: true,
    is_tested: true,
};

/// Frames without contact at any place of the recording: touches that consist of such a frame, or the first such frame of each touch.
pub const AT_REST: Source = Source {
    name: "frames_without_contact",
    rows: frames_without_contact,
    holds_out_groups: true,
    is_tested: true,
};

/// Number of frames without change at the end of each touch, as after padding to the longest touch.
pub const PADDING: Source = Source {
    name: "frames_of_padding",
    rows: padding,
    holds_out_groups: true,
    is_tested: true,
};

/// Returns the number of frames at the end of each sampled touch that are padding or equal the last recorded frame, shape (n_sample, 1). Returns `None` if
/// these numbers are equal.
fn padding(context: &Context) -> Option<Array2<f64>> {
    let n_frames = context.data.n_frames;
    let numbers = context.sample.iter().map(|touch| {
        let n_padded = context.n_padded[*touch];
        let last = touch * n_frames + n_frames - 1 - n_padded;
        let frames = (touch * n_frames..last).rev();
        let equal =
            frames.take_while(|&row| context.data.frames.row(row) == context.data.frames.row(last));
        (n_padded + equal.count()) as f64
    });
    let numbers: Vec<f64> = numbers.collect();
    if numbers.iter().all(|&number| number == numbers[0]) {
        return None;
    }
    Array2::from_shape_vec((numbers.len(), 1), numbers).ok()
}

/// Noise of the readings before the contact, or in frames without contact at any place.
pub const NOISE: Source = Source {
    name: "noise_before_contact",
    rows: |context| noise_levels(&rows(context).or_else(|| frames_without_contact(context))?),
    holds_out_groups: true,
    is_tested: true,
};

/// Minimum number of readings of a touch from which a noise level is computed. With fewer readings, its relative error exceeds 20 %.
const MIN_OF_NOISE: usize = 12;

/// Returns the noise level of each row of readings at rest, shape (n, 1): the standard deviation over taxels of the readings less their means over all rows.
/// Rows that begin with NaN have the level NaN. Returns `None` for fewer than [`MIN_OF_NOISE`] taxels, or readings without
/// noise.
pub fn noise_levels(readings: &Array2<f64>) -> Option<Array2<f64>> {
    if readings.ncols() < MIN_OF_NOISE {
        return None;
    }
    let known = (0..readings.nrows()).filter(|&row| !readings[(row, 0)].is_nan());
    let known = readings.select(Axis(0), &known.collect::<Vec<_>>());
    let mean = known.mean_axis(Axis(0))?;
    let levels = (readings - &mean).std_axis(Axis(1), 1.0);
    let is_noisy = levels.iter().any(|&level| level > 0.0);
    is_noisy.then(|| levels.insert_axis(Axis(1)))
}

/// Quantile of the contact of all frames, and the largest contact of a frame without contact relative to this quantile. At least 5 % of the frames must be
/// without contact; their readings may have levels that depend on the class.
const QUIET: f64 = 0.05;
const MAX_CONTACT: f64 = 1.3;
/// Minimum number of frames without contact, and of those of each of two classes.
const MIN_QUIET: [usize; 2] = [20, 5];
/// Maximum number of frames of which the contact is computed.
const MAX_FRAMES: usize = 20_000;

/// Returns readings of frames without contact, shape (n_sample, m); rows of NaN for touches without such a frame. Returns `None` if few frames are without
/// contact, or if taxels that are touched in other frames read contact in these frames, too.
fn frames_without_contact(context: &Context) -> Option<Array2<f64>> {
    let n_frames = context.data.n_frames;
    if n_frames > 1 && rows(context).is_some() {
        return None;
    }
    let stds = context.residuals.std_axis(Axis(0), 0.0);
    let active: Vec<usize> = (0..stds.len())
        .filter(|&taxel| stds[taxel] > 0.5 * context.active_std)
        .collect();
    let step = active.len().div_ceil(MAX_READINGS).max(1);
    let some: Vec<usize> = active.iter().copied().step_by(step).collect();
    let n_touches = context.sample.len().min(MAX_FRAMES / n_frames);
    let frames = context.sample[..n_touches]
        .iter()
        .flat_map(|touch| touch * n_frames..(touch + 1) * n_frames);
    let frames: Vec<usize> = frames.collect();
    let readings = context.data.frames.select(Axis(0), &frames);
    let readings = readings.select(Axis(1), &some);
    let mut squares = vec![0.0; frames.len()];
    for column in readings.columns() {
        let least = quantile(&mut column.to_vec(), QUIET);
        for (square, reading) in squares.iter_mut().zip(column) {
            *square += (reading - least).powi(2);
        }
    }
    let largest = MAX_CONTACT.powi(2) * quantile(&mut squares.clone(), QUIET);
    // The first quiet frame of each touch.
    let quiet = squares
        .chunks(n_frames)
        .enumerate()
        .filter_map(|(place, squares)| {
            let frame = squares.iter().position(|&square| square <= largest)?;
            Some((place, frames[place * n_frames + frame]))
        });
    let (places, quiet): (Vec<usize>, Vec<usize>) = quiet.unzip();
    let labels: Vec<usize> = places
        .iter()
        .map(|&place| context.sample_labels[place])
        .collect();
    let mut counts = BTreeMap::<usize, usize>::new();
    labels
        .iter()
        .for_each(|&label| *counts.entry(label).or_default() += 1);
    let n_known = counts
        .values()
        .filter(|&&count| count >= MIN_QUIET[1])
        .count();
    if quiet.len() < MIN_QUIET[0] || n_known < 2 {
        return None;
    }
    let quiet = context.data.frames.select(Axis(0), &quiet);
    let residuals = without_class_means(quiet.view(), &labels);
    let sums = contact_sums(residuals.view(), context.active_std);
    let rows = (quiet.view(), residuals.view());
    let is_untouched = untouched_taxels(rows, Some(&labels), &sums, context.active_std);
    let n_untouched = active.iter().filter(|&&taxel| is_untouched[taxel]).count();
    if (n_untouched as f64) < MIN_UNTOUCHED * active.len() as f64 {
        return None;
    }
    let varies = |taxel: usize| residuals.column(taxel).iter().any(|&x| x != 0.0);
    let readings = some_columns(&quiet, |taxel| is_untouched[taxel] && varies(taxel));
    if readings.ncols() == 0 {
        return None;
    }
    let mut all = Array2::from_elem((context.sample.len(), readings.ncols()), f64::NAN);
    for (&place, readings) in places.iter().zip(readings.rows()) {
        all.row_mut(place).assign(&readings);
    }
    Some(all)
}

/// Returns the finding about frames without contact at any place, if there are such frames.
fn at_rest(context: &Context) -> Option<Finding> {
    let found = context.readable.get(AT_REST.name)?;
    let sentence = format!(
        "{} touches contain a frame without contact. These frames name the class of {} of these touches; permuted labels give {}.",
        found.is_correct.len(),
        percent(found.accuracy),
        percent(found.chance)
    );
    let advice = "Leave frames without contact out of the labelled touches, subtract the level at rest of the session, and record the classes in random order.";
    Some(Finding::readable(found, sentence, advice).about("frames without contact"))
}

/// Minimum number of frames at rest with which touches begin, and this number as a fraction of the frames. In recordings that begin with the contact, the
/// shape of an object determines how its contact grows.
const MIN_REST: usize = 3;
const MIN_REST_SHARE: f64 = 0.1;
/// Maximum growth of the sum of the readings during the frames at rest, relative to the growth during the touch; means over touches.
const MAX_GROWTH: f64 = 0.01;
/// Fraction of the way from the smallest to the largest sum of a touch's readings at which the contact has begun.
const BEGUN: f64 = 0.25;

/// Returns the number of frames of each sampled touch before its contact, shape (n_sample, 1).
fn onset(context: &Context) -> Option<Array2<f64>> {
    let n_frames = context.data.n_frames;
    let n_rest = MIN_REST.max((MIN_REST_SHARE * n_frames as f64) as usize);
    if n_frames <= n_rest {
        return None;
    }
    let stds = context.residuals.std_axis(Axis(0), 0.0);
    let is_active = stds.mapv(|std| {
        if std > 0.5 * context.active_std {
            1.0
        } else {
            0.0
        }
    });
    let (mut onsets, mut at_rest, mut growth) = (Vec::new(), 0.0, 0.0);
    for touch in &context.sample {
        let rows = touch * n_frames..(touch + 1) * n_frames;
        let sums: Vec<f64> = rows
            .map(|row| context.data.frames.row(row).dot(&is_active))
            .collect();
        let least = sums.iter().copied().fold(f64::INFINITY, f64::min);
        let largest = sums.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let is_begun = |sum: &f64| *sum > least + BEGUN * (largest - least);
        let begun = sums.iter().position(is_begun).unwrap_or(n_frames);
        onsets.push(begun as f64);
        at_rest += sums[n_rest - 1] - sums[0];
        growth += largest - least;
    }
    (at_rest.abs() <= MAX_GROWTH * growth)
        .then(|| Array2::from_shape_vec((onsets.len(), 1), onsets).expect("one number a touch"))
}

/// Minimum fraction of the taxels that must be untouched in a frame before the contact, among the taxels that are touched in other frames.
const MIN_UNTOUCHED: f64 = 0.9;

/// Returns readings of taxels that are untouched in the first or the last frame of a touch, and touched in other frames. If the options name frames before the
/// contact, returns the means of all taxels in these frames.
fn rows(context: &Context) -> Option<Array2<f64>> {
    let n_frames = context.data.n_frames;
    if let Some(range) = &context.options.before_contact {
        let frames = range.start..range.end.min(n_frames);
        let n = frames.len() as f64;
        let sum = frames
            .map(|frame| context.frame_of_touches(frame))
            .reduce(|sum, frame| sum + frame)?;
        return Some(some_columns(&(sum / n), |_| true));
    }
    if n_frames < 2 {
        return None;
    }
    let (rows, residuals) = quietest_frame(context)?;
    let is_untouched = untouched_taxels(
        (rows.view(), residuals.view()),
        Some(&context.sample_labels),
        &context.contact,
        context.active_std,
    );
    // Another check covers the taxels that are never touched.
    let active = (0..rows.ncols()).filter(|&taxel| !context.is_untouched[taxel]);
    let (n_active, n_untouched) = active.fold((0, 0), |(n, untouched), taxel| {
        (n + 1, untouched + usize::from(is_untouched[taxel]))
    });
    if (n_untouched as f64) < MIN_UNTOUCHED * f64::from(n_active) {
        return None;
    }
    let is_counted = |taxel: usize| is_untouched[taxel] && !context.is_untouched[taxel];
    let rows = some_columns(&rows, is_counted);
    (rows.ncols() > 0).then_some(rows)
}

/// Returns the readings of the sampled touches in the first or the last frame, whichever varies less within classes. Also returns these readings less the means
/// of their classes.
fn quietest_frame(context: &Context) -> Option<(Array2<f64>, Array2<f64>)> {
    let n_frames = context.data.n_frames;
    let ends = [0, n_frames - 1].into_iter().filter(|_| n_frames > 1);
    let frames = ends.map(|frame| {
        let rows = context.frame_of_touches(frame);
        let residuals = without_class_means(rows.view(), &context.sample_labels);
        let squares = residuals.iter().map(|x| x * x).sum::<f64>();
        (rows, residuals, squares)
    });
    let quietest = frames.min_by(|a, b| a.2.total_cmp(&b.2));
    quietest.map(|(rows, residuals, _)| (rows, residuals))
}

/// Returns at most [`MAX_READINGS`] columns for which `is_counted` is true, and their mean.
pub fn some_columns(rows: &Array2<f64>, is_counted: impl Fn(usize) -> bool) -> Array2<f64> {
    let counted: Vec<usize> = (0..rows.ncols())
        .filter(|&column| is_counted(column))
        .collect();
    let step = counted.len().div_ceil(MAX_READINGS).max(1);
    let chosen: Vec<usize> = counted.into_iter().step_by(step).collect();
    rows.select(Axis(1), &chosen)
}

fn run(context: &Context) -> Result<Vec<Finding>> {
    if !context.has_classes() {
        return Ok(vec![Finding::not_checked("", NO_LABELS)]);
    }
    let mut findings: Vec<Finding> = at_rest(context).into_iter().collect();
    for (source, names, advice, subject) in [
        (
            PADDING,
            "The number of equal frames at the end names",
            "Record all touches with the same length, or cut them to the shortest; otherwise the classifier may name the length of the recording.",
            "padding",
        ),
        (
            NOISE,
            "The noise of readings without contact names",
            "Record the classes in random order and with the same settings of the sensor; otherwise the classifier may name the session by its noise.",
            "noise",
        ),
        (
            ONSET,
            "The number of frames before the contact names",
            "Align the touches at the beginning of the contact; otherwise the classifier may name how the recording was made.",
            "number of frames",
        ),
    ] {
        if let Some(found) = context.readable.get(source.name) {
            findings.push(Finding::names_class(found, names, advice).about(subject));
        }
    }
    let Some(found) = context.readable.get(SOURCE.name) else {
        let Some(quietest) = context.readable.get(QUIETEST.name) else {
            let why =
                "Each touch is a single frame, so that there are no frames before the contact.";
            findings.push(Finding::not_checked("", why));
            return Ok(findings);
        };
        let sentence = format!(
            "The quietest frame at an end of the touches names the class of {} of the touches, but may contain contact; permuted labels give {}.",
            percent(quietest.accuracy),
            percent(quietest.chance)
        );
        let note = Finding::note("", quietest.accuracy, sentence)
            .against(quietest.chance)
            .advice("If this frame precedes the contact, name it (before_contact) to test whether it names the class.")
            .shown_in("confounds");
        findings.push(note);
        return Ok(findings);
    };
    let advice = "Subtract the frame before contact from each touch, or record the classes in random order; otherwise the classifier may name the session.";
    findings.push(Finding::names_class(
        found,
        "Frames before the contact name",
        advice,
    ));
    Ok(findings)
}
