//! Measurement of the speed of the press kernel alone.

use crate::arrays::Object;
use crate::errors::exception;
use crate::model::model_of;
use crate::patch::Patch;
use crate::poses::Poses;
use crate::press::goal::Goal;
use bubbletouch::contact::Workspace;
use pyo3::prelude::*;
use std::slice::from_ref;
use std::time::Instant;

/// Measures how many taxel readings per second the press kernel computes on one thread, without output arrays. The number is the reference for presses that
/// fill arrays.
#[pyfunction]
pub fn _kernel_pace(
    py: Python,
    patch: &Bound<Patch>,
    object: &Object,
    poses: &Object,
    depth: &Object,
    seconds: f64,
) -> PyResult<f64> {
    let poses = Poses::from_argument("poses", poses)?.poses;
    let goal = Goal::from_arguments(Some(depth), None, None)?;
    goal.check(poses.len())?;
    let (patch, model) = (patch.get().inner(), model_of("object", object)?);
    py.detach(|| {
        let mut workspace = Workspace::new();
        let start = Instant::now();
        let mut n_readings = 0;
        while start.elapsed().as_secs_f64() < seconds {
            for (number, pose) in poses.iter().enumerate() {
                let press = goal.of_pose(number, patch, (from_ref(model), from_ref(pose)));
                press.run(&mut workspace).map_err(exception)?;
                std::hint::black_box(workspace.deflections());
                n_readings += patch.n_taxels();
            }
        }
        Ok(n_readings as f64 / start.elapsed().as_secs_f64())
    })
}
