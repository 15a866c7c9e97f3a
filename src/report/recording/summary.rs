//! Summary of a recording as a text table.

use super::reader::RecordingFile;
use crate::error::Result;
use crate::report::terminal::rows_text;
use crate::signal::Quantity;
use crate::spelling::counted;
use crate::table::short_number;

/// Returns a text summary of a recording: frames and times, patches with their largest values, objects, and metadata. Reads all data of the file.
///
/// # Errors
/// If the file cannot be read.
pub fn recording_table(file: &mut RecordingFile) -> Result<String> {
    let mut text = time_sentence(file.time()) + "\n";
    let n_patches = file.header().patches.len();
    if n_patches > 0 {
        let header = [
            "patch",
            "taxels",
            "layout",
            "forces",
            "most touched",
            "peak (mm)",
            "at frame",
            "peak force (N)",
        ];
        let rows = (0..n_patches).map(|patch| row(file, patch));
        let rows = rows.collect::<Result<Vec<_>>>()?;
        text += &format!("\n{}\n", rows_text(&header, &[0, 2, 3], rows));
    }
    let header = file.header();
    if !header.objects.is_empty() {
        text += &format!("\nobjects: {}\n", header.objects.join(", "));
    }
    if !header.about.is_null() {
        text += &format!("\nabout: {:#}\n", header.about);
    }
    Ok(text)
}

/// Returns the summary row of a patch, with its largest values over all frames.
fn row(file: &mut RecordingFile, patch: usize) -> Result<Vec<String>> {
    let (mut most_touched, mut peak_frame) = (0, 0);
    let (mut peak_deflection, mut peak_force) = (0.0, 0.0);
    file.each_frame(patch, Quantity::Deflection, |frame, values| {
        let n_touched = values.iter().filter(|&&value| value > 0.0).count();
        most_touched = most_touched.max(n_touched);
        let peak = values.iter().copied().fold(0.0, f64::max);
        if peak > peak_deflection {
            (peak_deflection, peak_frame) = (peak, frame);
        }
    })?;
    file.each_frame(patch, Quantity::Force, |_, values| {
        peak_force = values.iter().copied().fold(peak_force, f64::max);
    })?;
    let patch = &file.header().patches[patch];
    let layout = patch.grid.map_or("free".to_owned(), |grid| {
        let pitch_mm = short_number(grid.pitch * 1e3);
        format!("{} × {} at {pitch_mm} mm", grid.nx, grid.ny)
    });
    let or_dash = |text: String| match most_touched {
        0 => "–".to_owned(),
        _ => text,
    };
    Ok(vec![
        patch.name.clone(),
        patch.n_taxels().to_string(),
        layout,
        format!("{:?}", patch.force).to_lowercase(),
        most_touched.to_string(),
        or_dash(short_number(peak_deflection * 1e3)),
        or_dash(peak_frame.to_string()),
        or_dash(short_number(peak_force)),
    ])
}

fn time_sentence(time: &[f64]) -> String {
    let (Some(first), Some(last)) = (time.first(), time.last()) else {
        return "no frames".to_owned();
    };
    let mut sentence = format!(
        "{} from {} s to {} s",
        counted(time.len(), "frame"),
        short_number(*first),
        short_number(*last)
    );
    if time.len() > 1 {
        let steps = time.windows(2).map(|pair| pair[1] - pair[0]);
        let low = steps.clone().fold(f64::INFINITY, f64::min);
        let high = steps.fold(0.0, f64::max);
        let (low, high) = (short_number(low * 1e3), short_number(high * 1e3));
        sentence += &match low == high {
            true => format!(", one every {low} ms"),
            false => format!(", one every {low} to {high} ms"),
        };
    }
    sentence
}
