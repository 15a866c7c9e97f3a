//! Image files of frames.

use crate::arrays::{Object, array};
use crate::errors::{check_folder, exception, guarded};
use bubbletouch::report::frame_files;
use bubbletouch::world::Grid;
use ndarray::Array2;
use pyo3::prelude::*;
use std::path::PathBuf;

/// Writes the deflections (ny, nx; metres) of a grid with this pitch (metres) to a file. The extension selects a picture (.png), a table (.csv) or
/// arrays (.npz). Raises OSError if the file cannot be written, and ValueError if an argument is invalid.
#[pyfunction]
pub fn write_frame(path: PathBuf, frame: &Object, pitch: f64) -> PyResult<()> {
    guarded(|| {
        let is_shape = |shape: &[usize]| shape.len() == 2;
        let frame =
            array("frame", frame, "(ny, nx)", is_shape)?.finite("frame", "finite numbers")?;
        let (ny, nx) = (frame.shape()[0], frame.shape()[1]);
        let grid = Grid { nx, ny, pitch };
        grid.check().map_err(exception)?;
        check_folder(&path)?;
        let frame = Array2::from_shape_vec((ny, nx), frame.values().to_vec());
        let frame = frame.expect("as many numbers as the shape");
        frame_files::write_frame(&path, &frame, &grid).map_err(exception)
    })
}
