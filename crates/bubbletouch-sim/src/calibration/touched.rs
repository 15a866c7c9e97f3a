//! Frames with contact after subtraction of the taxels' zero offsets.

use super::RecordedSkin;
use super::faults::FoundFaults;
use super::saturation::plateau;
use super::untouched::Untouched;
use ndarray::Array2;

/// Returns the smallest reading at which a taxel counts as saturated: the full scale, or a smaller largest reading that many frames share.
pub(super) fn saturation(skin: &RecordedSkin, faults: &FoundFaults) -> f64 {
    let frames = || {
        skin.touched.outer_iter().map(|frame| {
            let readings = frame.into_iter().zip(&faults.is_sound);
            readings.map(|(&reading, &is_sound)| if is_sound { reading } else { f64::NAN })
        })
    };
    plateau(frames).map_or(1.0, |level| level.min(1.0))
}

/// Returns the frames with contact after subtraction of the zero offsets, which are interpolated between runs of frames without contact. Unknown readings and
/// readings of faulty taxels are NaN. Readings that the converter clipped at zero stay at zero. Saturated readings become 1, and all estimates omit them.
pub(super) fn touched(
    skin: &RecordedSkin,
    faults: &FoundFaults,
    (untouched, drift): (Option<&Untouched>, f64),
    saturation: f64,
) -> Array2<f64> {
    let mut touched = skin.touched.clone();
    for (mut frame, &time) in touched.outer_iter_mut().zip(&skin.touched_times) {
        for (taxel, reading) in frame.iter_mut().enumerate() {
            *reading = match untouched {
                _ if !faults.is_sound[taxel] => f64::NAN,
                _ if *reading >= saturation => 1.0,
                Some(untouched) if !(untouched.is_clipped && *reading == 0.0) => {
                    // Without drift, the zero of a taxel whose zero is unknown is at the lowest reading.
                    let zero = untouched.zero(taxel, time);
                    let zero = zero.unwrap_or(if drift > 0.0 { f64::NAN } else { 0.0 });
                    *reading - zero
                }
                _ => *reading,
            };
        }
    }
    touched
}
