//! What is in a recording, as a table for people.

use super::reader::RecordingFile;
use crate::error::Result;
use crate::signal::Quantity;
use crate::table::short_number;
use comfy_table::{CellAlignment, Table, presets::NOTHING};

/// The largest values of a patch over all frames.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
struct PatchSummary {
    /// Metres; 0 if nothing was ever touched.
    peak_deflection: f64,
    /// The first frame with it.
    peak_frame: usize,
    /// Newtons on one taxel.
    peak_force: f64,
    /// Taxels pushed in in one frame, at most.
    most_touched: usize,
}

/// Reads a patch through once, in bounded memory.
fn summarise(file: &mut RecordingFile, patch: usize) -> Result<PatchSummary> {
    let mut summary = PatchSummary::default();
    file.each_frame(patch, Quantity::Deflection, |frame, values| {
        let n_touched = values.iter().filter(|&&value| value > 0.0).count();
        summary.most_touched = summary.most_touched.max(n_touched);
        let peak = values.iter().copied().fold(0.0, f64::max);
        if peak > summary.peak_deflection {
            (summary.peak_deflection, summary.peak_frame) = (peak, frame);
        }
    })?;
    file.each_frame(patch, Quantity::Force, |_, values| {
        summary.peak_force = values.iter().copied().fold(summary.peak_force, f64::max);
    })?;
    Ok(summary)
}

/// Frames and time, patches with their peaks, objects, and what the writer had to say; every number is read.
pub fn recording_table(file: &mut RecordingFile) -> Result<String> {
    let mut text = time_sentence(file.time()) + "\n";
    let n_patches = file.header().patches.len();
    if n_patches > 0 {
        let mut table = Table::new();
        table.load_preset(NOTHING);
        table.set_header([
            "patch",
            "taxels",
            "layout",
            "forces",
            "most touched",
            "peak (mm)",
            "at frame",
            "peak force (N)",
        ]);
        for patch in 0..n_patches {
            let summary = summarise(file, patch)?;
            table.add_row(row(file, patch, &summary));
        }
        for column in [1, 4, 5, 6, 7] {
            if let Some(column) = table.column_mut(column) {
                column.set_cell_alignment(CellAlignment::Right);
            }
        }
        text += &format!("\n{table}\n");
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

fn row(file: &RecordingFile, patch: usize, summary: &PatchSummary) -> [String; 8] {
    let patch = &file.header().patches[patch];
    let layout = patch.grid.map_or("free".to_owned(), |grid| {
        let pitch_mm = short_number(grid.pitch * 1e3);
        format!("{} × {} at {pitch_mm} mm", grid.nx, grid.ny)
    });
    let is_touched = summary.most_touched > 0;
    let or_dash = |text: String| if is_touched { text } else { "–".to_owned() };
    [
        patch.name.clone(),
        patch.n_taxels().to_string(),
        layout,
        format!("{:?}", patch.force).to_lowercase(),
        summary.most_touched.to_string(),
        or_dash(short_number(summary.peak_deflection * 1e3)),
        or_dash(summary.peak_frame.to_string()),
        or_dash(short_number(summary.peak_force)),
    ]
}

fn time_sentence(time: &[f64]) -> String {
    let (Some(first), Some(last)) = (time.first(), time.last()) else {
        return "no frames".to_owned();
    };
    let mut sentence = format!(
        "{} frames from {} s to {} s",
        time.len(),
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
