//! Class `Reconstructor`: reconstruction of frames from measurements.

use crate::arrays::{Object, array, frames, to_column, whole_number};
use crate::errors::{check_number, exception, guarded, named};
use crate::projection::Projection;
use crate::threads::in_pool;
use bubbletouch::random::Seed;
use bubbletouch::sensing::{self, Dictionary, Effort, SensedDictionary};
use bubbletouch::world::ImageShape;
use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use self_cell::self_cell;

type Prepared<'a> = sensing::Reconstructor<'a>;

self_cell!(
    /// Dictionary whose atoms are multiplied by the measurement matrix, stored together with its projection and dictionary.
    struct Sensed {
        owner: (sensing::Projection, Dictionary),
        #[covariant]
        dependent: SensedDictionary,
    }
);

self_cell!(
    /// Solver for the coefficients of a frame, stored together with the data that it borrows.
    struct Solving {
        owner: Box<Sensed>,
        #[not_covariant]
        dependent: Prepared,
    }
);

/// Reconstructor of frames from the measurements of one projection, with a basis fitted to training frames.
///
/// Example: Reconstructor(projection, training, basis="pca", solver="lmmse", noise=1e-4).
///
/// training: frames (n, ny, nx), metres.
/// basis: dct, haar, daubechies4 (both for sides that are powers of two) or pca.
/// n_atoms: number of atoms, for pca the components of largest variance. Default: all atoms, or 256 of pca.
/// solver: omp (orthogonal matching pursuit), l1 (basis pursuit by FISTA) or lmmse (linear minimum mean square error estimate).
/// noise: standard deviation on each taxel, in the unit of the frames.
///
/// Raises ValueError if an argument is invalid.
#[pyclass(frozen, module = "bubbletouch")]
pub struct Reconstructor {
    solving: Solving,
    shape: (usize, usize),
    n_measurements: usize,
}

#[pymethods]
impl Reconstructor {
    #[new]
    #[pyo3(signature = (projection, training, *, basis="pca", solver="lmmse", n_atoms=None, noise=0.0, seed=0))]
    fn new(
        py: Python,
        projection: &Bound<Projection>,
        training: &Object,
        basis: &str,
        solver: &str,
        n_atoms: Option<i128>,
        noise: f64,
        seed: i128,
    ) -> PyResult<Self> {
        guarded(|| {
            let n_atoms = n_atoms.map(|n| whole_number("n_atoms", n)).transpose()?;
            let seed = whole_number("seed", seed)?;
            let (projection, shape) = (projection.get().inner(), projection.get().shape());
            let (basis, solver) = (named("basis", basis)?, named("solver", solver)?);
            let is_noise = |noise: f64| noise.is_finite() && noise >= 0.0;
            check_number("noise", Some(noise), "zero or a positive number", is_noise)?;
            let training = frames(
                "training",
                training,
                projection.n_taxels(),
                Some(shape.into()),
            )?;
            let made = in_pool(py, || {
                let (ny, nx) = shape;
                let image = ImageShape { ny, nx };
                let training = training.values.view();
                let dictionary =
                    Dictionary::learned(basis, image, training, n_atoms, &Seed::new(seed))?;
                let sensed = Sensed::try_new((projection.clone(), dictionary), |owner| {
                    SensedDictionary::new(&owner.0, &owner.1)
                })?;
                Solving::try_new(Box::new(sensed), |sensed| {
                    let sensed = sensed.borrow_dependent();
                    sensing::Reconstructor::new(solver, sensed, &Effort::default(), noise)
                })
            })?;
            Ok(Self {
                solving: made.map_err(exception)?,
                shape,
                n_measurements: projection.n_measurements(),
            })
        })
    }

    /// Reconstructs frames from measurements (n, m).
    ///
    /// Returns a dict: frames (n, ny, nx); the numbers of atoms used, n_atoms (n,); is_capped (n,), whether the solver stopped at a limit.
    fn __call__<'py>(
        &self,
        py: Python<'py>,
        measurements: &Object<'py>,
    ) -> PyResult<Bound<'py, PyDict>> {
        guarded(|| {
            let m = self.n_measurements;
            let is_shape = |shape: &[usize]| matches!(shape, [_, wide] if *wide == m);
            let allowed = format!("(n, {m})");
            let rows = array("measurements", measurements, &allowed, is_shape)?;
            let rows = rows.finite("measurements", "only finite numbers")?.matrix();
            let solve = |solver: &Prepared| solver.reconstruct(rows.view());
            let found = in_pool(py, || {
                self.solving.with_dependent(|_, solver| solve(solver))
            })?;
            let found = found.map_err(exception)?;
            let (n, (ny, nx)) = (found.frames.nrows(), self.shape);
            let said = PyDict::new(py);
            said.set_item(
                "frames",
                found.frames.into_pyarray(py).reshape([n, ny, nx])?,
            )?;
            let atoms = found.n_atoms.into_iter().map(|n| n as i64);
            said.set_item("n_atoms", to_column(py, atoms))?;
            said.set_item("is_capped", to_column(py, found.capped))?;
            Ok(said)
        })
    }

    fn __repr__(&self) -> String {
        let (m, (ny, nx)) = (self.n_measurements, self.shape);
        format!("<bubbletouch.Reconstructor: {m} measurements to {ny} × {nx} taxels>")
    }
}
