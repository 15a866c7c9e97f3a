//! Sensed dictionary: the matrix A = ΦΨ that every reconstruction solver uses.

use super::{Dictionary, Projection};
use crate::error::{Error, Result};
use ndarray::{Array1, Array2, ArrayView2, Axis, s};
use std::sync::OnceLock;

/// Number of atoms synthesised and measured at a time. A larger number needs more memory.
const BLOCK: usize = 256;

/// Measured atoms of a dictionary: the matrix ΦΨ of a projection Φ and a dictionary Ψ, stored by columns, with derived quantities.
#[derive(Clone, Debug)]
pub struct SensedDictionary<'a> {
    projection: &'a Projection,
    dictionary: &'a Dictionary,
    /// Measured atoms, one per row, shape (number of atoms, number of measurements).
    atoms: Array2<f64>,
    /// Measured origin of the dictionary, shape (n_measurements,).
    origin: Array1<f64>,
    /// Gram matrix of the measured atoms, shape (k, k) for k atoms, computed on first use.
    gram: OnceLock<Array2<f64>>,
}

impl<'a> SensedDictionary<'a> {
    /// Measures every atom of the dictionary with the projection.
    ///
    /// # Errors
    /// If projection and dictionary belong to different arrays, or if the dictionary has no atoms.
    pub fn new(projection: &'a Projection, dictionary: &'a Dictionary) -> Result<Self> {
        let (n, k) = (dictionary.n_taxels(), dictionary.n_atoms());
        if projection.n_taxels() != n || k == 0 {
            return Err(Error::input(
                "dictionary",
                format!("{k} atoms of {n} taxels"),
                format!("at least one atom, of {} taxels", projection.n_taxels()),
            ));
        }
        let mut atoms = Array2::zeros((k, projection.n_measurements()));
        for start in (0..k).step_by(BLOCK) {
            let range = start..(start + BLOCK).min(k);
            let block = dictionary.atoms(range.clone());
            projection.measure_into(block.view(), atoms.slice_mut(s![range, ..]));
        }
        let origin = dictionary.origin().view().insert_axis(Axis(0));
        Ok(Self {
            origin: projection.measure(origin).row(0).to_owned(),
            projection,
            dictionary,
            atoms,
            gram: OnceLock::new(),
        })
    }

    /// Returns the projection that measures the atoms.
    pub fn projection(&self) -> &'a Projection {
        self.projection
    }

    /// Returns the dictionary of the atoms before measurement.
    pub fn dictionary(&self) -> &'a Dictionary {
        self.dictionary
    }

    /// Returns the measured atoms, one per row, shape (number of atoms, number of measurements).
    pub fn atoms(&self) -> ArrayView2<'_, f64> {
        self.atoms.view()
    }

    /// Returns the Gram matrix of the measured atoms, shape (k, k) for k atoms, computed on first use and then stored.
    pub fn gram(&self) -> &Array2<f64> {
        self.gram.get_or_init(|| self.atoms.dot(&self.atoms.t()))
    }

    /// Returns the norms of the measured atoms, shape (number of atoms,).
    pub fn norms(&self) -> Array1<f64> {
        self.atoms.map_axis(Axis(1), |atom| atom.dot(&atom).sqrt())
    }

    /// Returns the centred measurements: each row of measurements (n_frames × m) minus the measured origin of the dictionary.
    ///
    /// # Panics
    /// If a row does not have m values.
    pub(super) fn centred(&self, measurements: ArrayView2<f64>) -> Array2<f64> {
        &measurements - &self.origin
    }
}
