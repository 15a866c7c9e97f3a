//! A dictionary seen through a projection: the matrix A = ΦΨ that every reconstruction solves with.

use super::{Dictionary, Projection};
use crate::error::{Error, Result};
use ndarray::{Array1, Array2, ArrayView2, Axis, s};
use std::sync::OnceLock;

/// Atoms synthesised and measured at a time, to bound memory.
const BLOCK: usize = 256;

/// A = ΦΨ, m × k, kept as its columns, and what is computed from it once.
#[derive(Clone, Debug)]
pub struct SensedDictionary<'a> {
    projection: &'a Projection,
    dictionary: &'a Dictionary,
    /// Φψⱼ, one a row: k × m.
    atoms: Array2<f64>,
    /// Φx₀, m.
    origin: Array1<f64>,
    /// AᵀA, k × k, when first asked for.
    gram: OnceLock<Array2<f64>>,
}

impl<'a> SensedDictionary<'a> {
    /// Measures every atom.
    ///
    /// # Errors
    /// A projection and a dictionary of different arrays; a dictionary without atoms.
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

    /// What measures.
    pub fn projection(&self) -> &'a Projection {
        self.projection
    }

    /// What frames are made of.
    pub fn dictionary(&self) -> &'a Dictionary {
        self.dictionary
    }

    /// Aᵀ: Φψⱼ, one a row, k × m.
    pub fn atoms(&self) -> ArrayView2<'_, f64> {
        self.atoms.view()
    }

    /// AᵀA, k × k: computed when first asked for, then kept.
    pub fn gram(&self) -> &Array2<f64> {
        self.gram.get_or_init(|| self.atoms.dot(&self.atoms.t()))
    }

    /// ‖aⱼ‖ of each column, k.
    pub fn norms(&self) -> Array1<f64> {
        self.atoms.map_axis(Axis(1), |atom| atom.dot(&atom).sqrt())
    }

    /// y − Φx₀ of each row of measurements (n_frames × m).
    ///
    /// # Panics
    /// When a row does not have m values.
    pub(super) fn centred(&self, measurements: ArrayView2<f64>) -> Array2<f64> {
        &measurements - &self.origin
    }
}
