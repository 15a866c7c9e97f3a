//! Image files of frames.

use crate::arrays::view;
use crate::errors::{bad_input, check_folder, exception, guarded};
use bubbletouch::report::frame_files;
use bubbletouch::world::Grid;
use ndarray::Ix2;
use pyo3::prelude::*;
use std::path::PathBuf;

/// Writes the deflections (ny, nx; metres) of a grid with this pitch (metres) to a file. The extension selects a picture (.png), a table (.csv) or
/// arrays (.npz). Raises OSError if the file cannot be written, and ValueError if an argument is invalid.
#[pyfunction]
pub fn write_frame(path: PathBuf, frame: &Bound<PyAny>, pitch: f64) -> PyResult<()> {
    guarded(|| {
        let is_shape = |shape: &[usize]| matches!(shape, [_, _]);
        view("frame", frame, "(ny, nx)", is_shape, |frame| {
            if let Some(bad) = frame.iter().find(|value| !value.is_finite()) {
                return Err(bad_input("frame", bad, "finite numbers"));
            }
            let frame = frame.to_owned().into_dimensionality::<Ix2>();
            let frame = frame.expect("the shape was looked at");
            let (ny, nx) = frame.dim();
            let grid = Grid { nx, ny, pitch };
            grid.check().map_err(exception)?;
            check_folder(&path)?;
            frame_files::write_frame(&path, &frame, &grid).map_err(exception)
        })
    })
}
