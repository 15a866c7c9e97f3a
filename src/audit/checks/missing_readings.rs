//! Missing readings: NaN and infinite numbers, placeholders such as −1, and repeated frames.

use crate::audit::check::{CheckAbout, Context, Finding, Result};
use crate::audit::finding::percent;
use crate::table::short_number;
use bubbletouch_sim::audit::placeholders::{count_repeated, placeholder};

pub const ABOUT: CheckAbout = CheckAbout {
    name: "missing_readings",
    title: "Missing readings",
    run,
};

fn run(context: &Context) -> Result<Vec<Finding>> {
    let n_padded: usize = context.n_padded.iter().sum();
    let n_recorded = context.data.frames.nrows() - n_padded;
    // A taxel that never reads is a place without a sensor.
    let present = || {
        context
            .n_missing
            .iter()
            .filter(|&&count| count < n_recorded)
    };
    let n: usize = present().sum();
    let n_present = present().count();
    let share = n as f64 / (n_recorded * n_present) as f64;
    let n_taxels = present().filter(|&&count| count > 0).count();
    let mut sentence = match n {
        0 => "No reading is missing.".to_owned(),
        _ => format!(
            "{n} readings ({}) of {n_taxels} taxels are NaN or infinite. The other checks use the median of the taxel instead.",
            percent(share)
        ),
    };
    let n_absent = context.n_missing.len() - n_present;
    if n_absent > 0 {
        sentence += &format!(
            " {n_absent} of {} taxels have no reading in any frame: they count as absent.",
            context.n_missing.len()
        );
    }
    if n_padded > 0 {
        let lengths = context.n_padded.iter();
        let lengths = lengths.map(|n_padded| context.data.n_frames - n_padded);
        let [shortest, longest] =
            [lengths.clone().min(), lengths.max()].map(Option::unwrap_or_default);
        sentence += &format!(
            " Touches have {shortest} to {longest} frames; frames after the end of a touch are not counted."
        );
    }
    let finding = Finding::counted("", share, sentence, n > 0)
        .against(0.0)
        .advice("Mask taxels with many missing readings, and leave out frames with others; state both. taxels.csv has the counts.")
        .shown_in("taxels");
    Ok(vec![
        finding,
        placeholders(context),
        repeated_frames(context),
    ])
}

/// Looks for a value in place of missing readings.
fn placeholders(context: &Context) -> Finding {
    let is_counted: Vec<bool> = varying(context);
    let frames = context.skin.touched.view();
    let found = placeholder(frames, &is_counted);
    let (share, sentence) = match found {
        None => (0.0, "No value stands for missing readings.".to_owned()),
        Some(found) => {
            let value = context.scale.0 + found.value * (context.scale.1 - context.scale.0);
            let share = found.n_readings as f64 / frames.len() as f64;
            let sentence = format!(
                "{} of the readings are exactly {}, which noise explains neither there nor beside it: the value seems to stand for a missing reading.",
                percent(share),
                // Fractions of the full scale are rounded.
                short_number((value * 1e9).round() / 1e9)
            );
            (share, sentence)
        }
    };
    Finding::counted("", share, sentence, found.is_some())
        .about("placeholder")
        .against(0.0)
        .advice("Replace the value by NaN, mask these readings, and state their number.")
        .shown_in("taxels")
}

/// Looks for frames that repeat the frame before.
fn repeated_frames(context: &Context) -> Finding {
    let data = &context.data;
    if data.n_frames == 1 {
        let why = "Each touch is a single frame; repeated touches are near-duplicates.";
        return Finding::not_checked("", why).about("repeated frames");
    }
    let n = count_repeated(
        data.frames.view(),
        (data.n_frames, &context.n_padded),
        &varying(context),
    );
    let n_padded: usize = context.n_padded.iter().sum();
    let share = n as f64 / (data.frames.nrows() - n_padded) as f64;
    let sentence = match n {
        0 => "No frame of a touch repeats the frame before it.".to_owned(),
        _ => format!(
            "{n} frames ({}) are exactly equal to the frame before them, although readings have noise: the readout seems to have repeated them.",
            percent(share)
        ),
    };
    Finding::counted("", share, sentence, n > 0)
        .about("repeated frames")
        .against(0.0)
        .advice("Treat repeated frames as missing, and state their number.")
}

/// Returns whether the readings of each taxel vary.
fn varying(context: &Context) -> Vec<bool> {
    let taxels = context.taxels.iter();
    taxels.map(|taxel| !taxel.is_constant()).collect()
}
