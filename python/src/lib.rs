//! Module `bubbletouch._core`: the library's interface to Python.
//!
//! The Python package (`python/bubbletouch`) exports the items of this module, and documents them in `_core.pyi`. This module contains no algorithms.
//! Arguments are checked and converted from arrays, the library is called without the interpreter's lock, and results are converted to arrays.

#![expect(clippy::too_many_arguments, reason = "arguments have names in Python")]

mod arrays;
mod audit;
mod batch;
mod catalogue;
mod errors;
mod foreign;
mod length_unit;
mod mesh;
mod model;
mod output_array;
mod patch;
mod picture;
mod placement;
mod poses;
mod press;
mod projection;
mod reconstruction;
mod robot;
mod signal;
mod simulation;
mod skin;
mod sphere_union;
mod study;
mod svm;
mod table;
mod threads;

use pyo3::prelude::*;

#[pymodule]
mod _core {
    use super::*;

    #[pymodule_export]
    use {
        audit::run_audit,
        catalogue::{Catalogue, Solid},
        errors::{_panic, InternalError},
        mesh::Mesh,
        patch::Patch,
        picture::write_frame,
        placement::touch_poses,
        press::contacts::Contacts,
        projection::Projection,
        reconstruction::Reconstructor,
        robot::{Joint, Robot},
        signal::{Chain, Step},
        simulation::Simulation,
        skin::{ShearState, Skin},
        sphere_union::SphereUnion,
        study::{advise, rename_old_results, run_study, toml_of, with_recorded},
        svm::{KernelSvm, LinearModel, choose_svm},
        table::{column_families, read_table},
    };

    #[pymodule_init]
    fn init(_module: &Bound<'_, PyModule>) -> PyResult<()> {
        errors::keep_panics();
        Ok(())
    }
}
