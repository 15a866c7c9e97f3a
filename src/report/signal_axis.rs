//! What happens to the signal, on axes and in words.

use crate::report::axis::{Axis, AxisValue, short_number};
use crate::study::Imperfection;
use crate::study::table::Cell;

/// A signal that nothing happens to.
pub(super) const IDEAL: &str = "ideal";
/// The same in a sentence.
pub(super) const IDEAL_SIGNAL: &str = "an ideal signal";

/// The place on a chart's axis of no converter: left of 24 bits, as if it had 32.
const NO_CONVERTER: f64 = -5.0;

/// The title of a chart's axis, with unit.
pub(super) fn title(kind: Imperfection) -> &'static str {
    match kind {
        Imperfection::Hysteresis => {
            "width of the hysteresis loop (% of full scale, square-root scale)"
        }
        Imperfection::Crosstalk => {
            "crosstalk: what leaks to four neighbours (%, square-root scale)"
        }
        Imperfection::Gain => "gain mismatch: standard deviation (%, square-root scale)",
        Imperfection::Drift => {
            "drift: standard deviation at the end (% of full scale, square-root scale)"
        }
        Imperfection::Dead => "dead taxels (%, square-root scale)",
        Imperfection::Stuck => "stuck taxels (%, square-root scale)",
        Imperfection::Scan => "time to scan the array (ms, square-root scale)",
        Imperfection::Quantisation => "resolution of the converter (bits)",
    }
}

/// The strength in a cell. Strengths rise along an axis; bits fall along theirs, on a logarithmic scale.
pub(super) fn value(kind: Imperfection, cell: &Cell) -> AxisValue {
    let strength = cell.strengths().of(kind).unwrap_or(0.0);
    let label = kind.describe(strength);
    let (number, tick) = match kind {
        Imperfection::Quantisation if strength == 0.0 => (NO_CONVERTER, label.clone()),
        Imperfection::Quantisation => (-strength.log2(), short_number(strength)),
        Imperfection::Scan => (strength, short_number(strength)),
        _ => {
            let percent = (strength * 1e8).round() / 1e6;
            (percent, short_number(percent))
        }
    };
    AxisValue {
        number: Some(number),
        tick,
        label,
    }
}

/// All that happens to the signal in a cell: `noise 5 %, gain mismatch 20 %`.
pub(super) fn words(cell: &Cell) -> String {
    let noise = (cell.noise_std != 0.0).then(|| Axis::Noise.phrase(cell));
    let smoothing = (cell.smoothing_mm != 0.0).then(|| Axis::Smoothing.phrase(cell));
    let strengths = cell.strengths();
    let imperfections = strengths
        .present()
        .map(|(kind, strength)| format!("{} {}", kind.name(), kind.describe(strength)));
    let all: Vec<String> = noise
        .into_iter()
        .chain(smoothing)
        .chain(imperfections)
        .collect();
    match all.is_empty() {
        true => IDEAL.to_owned(),
        false => all.join(", "),
    }
}
