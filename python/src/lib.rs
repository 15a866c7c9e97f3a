//! Module `bubbletouch._core`: the library's interface to Python.
//!
//! The Python package (`python/bubbletouch`) exports the items of this module, and documents them in `_core.pyi`. This module contains no algorithms.
//! Arguments are checked and converted from arrays, the library is called without the interpreter's lock, and results are converted to arrays.

mod arrays;
mod audit;
mod batch;
mod catalogue;
mod errors;
mod foreign;
mod kernel_pace;
mod length_unit;
mod mesh;
mod model;
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
    use audit::run_audit;
    #[pymodule_export]
    use catalogue::{Catalogue, Solid};
    #[pymodule_export]
    use errors::{_panic, InternalError};
    #[pymodule_export]
    use kernel_pace::_kernel_pace;
    #[pymodule_export]
    use mesh::Mesh;
    #[pymodule_export]
    use patch::Patch;
    #[pymodule_export]
    use picture::write_frame;
    #[pymodule_export]
    use placement::touch_poses;
    #[pymodule_export]
    use press::contacts::Contacts;
    #[pymodule_export]
    use projection::Projection;
    #[pymodule_export]
    use reconstruction::Reconstructor;
    #[pymodule_export]
    use robot::{Joint, Robot};
    #[pymodule_export]
    use signal::{Chain, Step};
    #[pymodule_export]
    use simulation::Simulation;
    #[pymodule_export]
    use skin::{ShearState, Skin};
    #[pymodule_export]
    use sphere_union::SphereUnion;
    #[pymodule_export]
    use study::{advise, rename_old_results, run_study, toml_of, with_recorded};
    #[pymodule_export]
    use svm::{KernelSvm, LinearModel, choose_svm};
    #[pymodule_export]
    use table::{column_families, read_table};

    #[pymodule_init]
    fn init(_module: &Bound<'_, PyModule>) -> PyResult<()> {
        errors::keep_panics();
        Ok(())
    }
}
