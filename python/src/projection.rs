//! Class `Projection`: compression of frames to measurements.

use crate::arrays::{Matrix, Object, frames, whole_number};
use crate::errors::{bad_input, exception, guarded};
use crate::patch::side;
use crate::threads::in_pool;
use bubbletouch::random::Seed;
use bubbletouch::sensing::{self, Ensemble};
use bubbletouch::world::ImageShape;
use numpy::IntoPyArray;
use pyo3::prelude::*;

/// Random projection y = Φx of frames with ny × nx taxels to m measurements; Φ is drawn once.
///
/// Example: Projection("sbhe", patch.shape, 64, seed=7).
///
/// ensemble: gaussian, bernoulli, circulant, sparse, sbhe, block_average, subsample, fourier, or identity (all taxels, for any m).
/// n_measurements: 1 to the number of taxels.
///
/// Raises ValueError if an argument is invalid.
#[pyclass(frozen, module = "bubbletouch")]
pub struct Projection {
    projection: sensing::Projection,
    /// Constructor arguments, which pickling stores: ensemble, shape of a frame, number of measurements, and seed.
    asked: (String, (usize, usize), usize, u64),
}

impl Projection {
    /// Returns the projection of the Rust library that this object wraps.
    pub fn inner(&self) -> &sensing::Projection {
        &self.projection
    }

    /// Returns the numbers of rows and columns of a frame.
    pub fn shape(&self) -> (usize, usize) {
        self.asked.1
    }
}

fn ensemble_of(name: &str) -> PyResult<Ensemble> {
    // Learned ensembles are fitted to touches and exist only in studies.
    let drawn = || {
        let all = Ensemble::ALL.iter().zip(Ensemble::NAMES);
        all.filter(|(ensemble, _)| ensemble.is_drawn())
    };
    let found = drawn().find_map(|(ensemble, (known, _))| (*known == name).then_some(*ensemble));
    found.ok_or_else(|| {
        let known: Vec<&str> = drawn().map(|(_, (known, _))| *known).collect();
        bad_input("ensemble", format!("`{name}`"), known.join(", "))
    })
}

#[pymethods]
impl Projection {
    #[new]
    #[pyo3(signature = (ensemble, shape, n_measurements, seed=0))]
    fn new(ensemble: &str, shape: (i64, i64), n_measurements: i64, seed: i128) -> PyResult<Self> {
        guarded(|| {
            let seed = whole_number("seed", seed)?;
            let grid = (side("shape", shape.0)?, side("shape", shape.1)?);
            let m = side("n_measurements", n_measurements)?;
            let drawn = ensemble_of(ensemble)?;
            let (ny, nx) = grid;
            let shape = ImageShape { ny, nx };
            let projection = sensing::Projection::new(drawn, shape, m, &Seed::new(seed));
            Ok(Self {
                projection: projection.map_err(exception)?,
                asked: (ensemble.to_owned(), grid, m, seed),
            })
        })
    }

    /// Returns the measurements (n, m) of frames (n, …) with n_taxels numbers per frame; (1, m) for one frame. The measurements of a frame are bitwise
    /// equal in any batch.
    fn __call__<'py>(&self, frames: &Object<'py>) -> PyResult<Matrix<'py>> {
        guarded(|| {
            let (py, sides) = (frames.py(), Some(self.shape().into()));
            let frames = self::frames("frames", frames, self.projection.n_taxels(), sides)?;
            let measured = in_pool(py, || self.projection.measure(frames.values.view()))?;
            Ok(measured.into_pyarray(py))
        })
    }

    /// Measurement matrix Φ (m, n_taxels); computed on access.
    #[getter]
    fn matrix<'py>(&self, py: Python<'py>) -> PyResult<Matrix<'py>> {
        guarded(|| Ok(py.detach(|| self.projection.matrix()).into_pyarray(py)))
    }

    /// Name of the ensemble from which the measurement matrix is drawn.
    #[getter]
    fn ensemble(&self) -> &str {
        &self.asked.0
    }

    /// Number of taxels per frame.
    #[getter]
    fn n_taxels(&self) -> usize {
        self.projection.n_taxels()
    }

    /// Number m of measurements per frame.
    #[getter]
    fn n_measurements(&self) -> usize {
        self.projection.n_measurements()
    }

    fn __repr__(&self) -> String {
        let (name, (ny, nx), m, seed) = &self.asked;
        format!("<bubbletouch.Projection: {name} of {ny} × {nx} taxels to {m}, seed {seed}>")
    }

    fn __getnewargs__(&self) -> (&str, (usize, usize), usize, u64) {
        let (name, shape, m, seed) = &self.asked;
        (name, *shape, *m, *seed)
    }
}
