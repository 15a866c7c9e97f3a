//! Class `ShearState`: shear springs with friction of all taxels of a skin, from one read to the next.

use crate::arrays::{Object, to_rows, whole_number};
use crate::errors::{bad_input, guarded};
use bubbletouch::contact::ContactMode;
use bubbletouch::skin;
use bubbletouch::world::Shear;
use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::prelude::*;

/// Shear springs with friction of all taxels of a skin. Skin.shear_state() creates the state, and each Skin.read advances it by one step.
///
/// Between two reads, a body in contact drags the taxels sideways until they slip. The shear force is at most the friction coefficient times the normal
/// force.
#[pyclass(module = "bubbletouch")]
#[derive(Clone)]
pub struct ShearState {
    inner: skin::ShearState,
    /// Number of sets of poses, or `None` for one set without an axis of sets.
    n_sets: Option<usize>,
}

impl ShearState {
    /// Creates the state of untouched patches for `n_sets` sets of poses.
    ///
    /// # Errors
    /// If the shear springs do not fit a patch.
    pub fn new(
        skin: &skin::Skin,
        shear_of: impl Fn(usize) -> Shear,
        n_sets: Option<usize>,
    ) -> bubbletouch::Result<Self> {
        let inner = skin::ShearState::new(skin, shear_of, n_sets.unwrap_or(1))?;
        Ok(Self { inner, n_sets })
    }

    /// Returns the state that a read advances.
    pub fn inner_mut(&mut self) -> &mut skin::ShearState {
        &mut self.inner
    }

    /// Checks that the state has been created for the same number of sets.
    ///
    /// # Errors
    /// If the numbers of sets differ.
    pub fn check(&self, n_sets: Option<usize>) -> PyResult<()> {
        if self.n_sets != n_sets {
            let words = |n: Option<usize>| n.map_or("one set".to_owned(), |n| format!("n = {n}"));
            let allowed = format!("a state of {}", words(n_sets));
            return Err(bad_input("shear", words(self.n_sets), allowed));
        }
        Ok(())
    }
}

#[pymethods]
impl ShearState {
    /// Force of the bodies on each taxel after the last read, newtons, (n_taxels, 3) or (n, n_taxels, 3), in the frame of the taxel's patch. It is the sum
    /// of the normal force, the friction, and the lateral force of an inclined contact.
    #[getter]
    fn forces<'py>(&self, py: Python<'py>) -> PyResult<Object<'py>> {
        let rows = to_rows(py, self.inner.forces().iter().copied());
        match self.n_sets {
            None => Ok(rows.into_any()),
            Some(n) => Ok(rows.reshape([n, self.inner.n_taxels(), 3])?.into_any()),
        }
    }

    /// Whether each taxel slipped during the last step, (n_taxels,) or (n, n_taxels).
    #[getter]
    fn slipping<'py>(&self, py: Python<'py>) -> PyResult<Object<'py>> {
        let modes = self.inner.contact_modes();
        let slipping: Vec<bool> = modes.map(|mode| mode == ContactMode::Slip).collect();
        let slipping = slipping.into_pyarray(py);
        match self.n_sets {
            None => Ok(slipping.into_any()),
            Some(n) => Ok(slipping.reshape([n, self.inner.n_taxels()])?.into_any()),
        }
    }

    /// Sets the shear forces to zero, as before the first read. `sets` contains the indices of the sets of poses; None selects all sets.
    #[pyo3(signature = (sets=None))]
    fn reset(&mut self, sets: Option<Vec<i128>>) -> PyResult<()> {
        guarded(|| {
            let n = self.n_sets.unwrap_or(1);
            let sets: Vec<usize> = match sets {
                None => (0..n).collect(),
                Some(sets) => {
                    let read = sets.into_iter().map(|set| match whole_number("sets", set) {
                        Ok(set) if set < n => Ok(set),
                        _ => Err(bad_input("sets", set, format!("0 to {}", n - 1))),
                    });
                    read.collect::<PyResult<_>>()?
                }
            };
            sets.into_iter().for_each(|set| self.inner.reset(set));
            Ok(())
        })
    }

    fn __copy__(&self) -> Self {
        self.clone()
    }

    fn __deepcopy__(&self, _memo: &Object) -> Self {
        self.clone()
    }

    fn __repr__(&self) -> String {
        let n_taxels = self.inner.n_taxels();
        match self.n_sets {
            None => format!("<bubbletouch.ShearState: {n_taxels} taxels>"),
            Some(n) => format!("<bubbletouch.ShearState: {n} × {n_taxels} taxels>"),
        }
    }
}
