//! Output of one frame to a file, in the format that the file extension selects.

use crate::error::{Error, Result};
use crate::files::{write_bytes, write_whole};
use crate::report::pictures::pressure_map::peak_sentence;
use crate::report::pictures::{ColourScale, check_frame};
use crate::report::recording::skin_picture::SkinPicture;
use crate::report::recording::{ForceKind, RecordedPatch};
use crate::signal::Quantity;
use crate::world::Grid;
use ndarray::{Array1, Array2, ArrayView1};
use ndarray_npy::{NpzWriter, WriteNpzError};
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

/// Writes one frame of deflections (ny × nx, metres) as `.csv`, `.npz` or `.png`, as the file extension requires.
///
/// - `.csv`: ny lines of nx numbers with 17 significant digits, no header.
/// - `.npz`: arrays `deflection` (ny × nx), `x` (nx) and `y` (ny), metres, f64; opens with `np.load`.
/// - `.png`: a heat map.
///
/// # Errors
/// If the extension is not supported, the shape differs from the grid, or a picture would contain values that are not finite.
pub fn write_frame(path: &Path, deflection: &Array2<f64>, grid: &Grid) -> Result<()> {
    let ending = path.extension().and_then(|ending| ending.to_str());
    if deflection.dim() != (grid.ny, grid.nx) {
        return Err(Error::input(
            "frame",
            format!("{} × {}", deflection.nrows(), deflection.ncols()),
            format!("{} rows × {} columns, as the grid", grid.ny, grid.nx),
        ));
    }
    match ending.map(str::to_ascii_lowercase).as_deref() {
        Some("csv") => write_bytes(path, frame_csv(deflection).as_bytes()),
        Some("npz") => write_npz(path, deflection, grid),
        Some("png") => {
            check_frame(deflection)?;
            let quantity = Quantity::Deflection;
            let title = peak_sentence(deflection, grid.pitch * 1e3, quantity);
            let patch = RecordedPatch::of_grid(title, *grid, ForceKind::Normal);
            let scale = ColourScale::over(deflection, quantity);
            let values: Vec<f64> = deflection.iter().copied().collect();
            let picture = SkinPicture::new(&patch, scale)?;
            write_bytes(path, &picture.frame(&values, "")?.png()?)
        }
        _ => Err(Error::input(
            path.display(),
            match ending {
                Some(ending) => format!("ends in .{ending}"),
                None => "has no ending".to_owned(),
            },
            "a name that ends in .csv, .npz or .png",
        )),
    }
}

/// Formats a frame as CSV. Each number has 17 significant digits, so that reading the file returns the same bits.
pub fn frame_csv(frame: &Array2<f64>) -> String {
    let line = |row: ArrayView1<f64>| {
        let numbers: Vec<String> = row.iter().map(|value| format!("{value:.16e}")).collect();
        numbers.join(",") + "\n"
    };
    frame.outer_iter().map(line).collect()
}

fn write_npz(path: &Path, deflection: &Array2<f64>, grid: &Grid) -> Result<()> {
    let x: Array1<f64> = (0..grid.nx).map(|column| grid.x(column)).collect();
    let y: Array1<f64> = (0..grid.ny).map(|row| grid.y(row)).collect();
    let write = |file: &mut BufWriter<File>| -> std::result::Result<(), WriteNpzError> {
        let mut archive = NpzWriter::new(file);
        archive.add_array("deflection", deflection)?;
        archive.add_array("x", &x)?;
        archive.add_array("y", &y)?;
        archive.finish().map(drop)
    };
    write_whole(path, |file| write(file).map_err(std::io::Error::other))
}
