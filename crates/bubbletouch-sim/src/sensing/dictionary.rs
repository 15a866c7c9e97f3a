//! Dictionaries: bases in which frames are sparse or approximately sparse.

use super::cosine::Cosine;
use super::pca::Pca;
use super::wavelet::Wavelet;
use crate::error::{Error, Result};
use crate::random::Seed;
use crate::world::ImageShape;
use ndarray::{Array1, Array2, ArrayView2, ArrayViewMut2, Axis, s};
use serde::{Deserialize, Serialize};
use std::fmt::Debug;
use std::sync::Arc;

/// Default number of components of a PCA dictionary.
pub const PCA_ATOMS: usize = 256;

/// Basis from which the atoms of a dictionary are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Basis {
    /// Products of cosines (DCT-II), for any array size.
    Dct,
    /// Pyramid of Haar wavelets; the sides of the array must be powers of two.
    Haar,
    /// Pyramid of Daubechies' wavelets with two vanishing moments, periodic at the edges; the sides of the array must be powers of two.
    Daubechies4,
    /// Principal components of training frames after subtraction of the mean frame.
    Pca,
}

/// Dictionary of k orthonormal atoms ψⱼ of n taxels with an origin x₀: a frame is approximately x = x₀ + Σⱼ αⱼ ψⱼ with coefficients αⱼ.
///
/// ```
/// use bubbletouch_sim::sensing::{Basis, Dictionary};
/// use bubbletouch_sim::world::ImageShape;
/// use ndarray::Array2;
///
/// let dictionary = Dictionary::complete(Basis::Dct, ImageShape { ny: 8, nx: 8 })?;
/// let frames = Array2::from_shape_fn((3, 64), |(i, j)| ((i + 1) * j) as f64);
/// let coefficients = dictionary.analyse(frames.view());
/// let again = dictionary.synthesise(coefficients.view());
/// assert!((&again - &frames).iter().all(|error| error.abs() < 1e-9));
/// # Ok::<(), bubbletouch_sim::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Dictionary {
    basis: Basis,
    grid: ImageShape,
    form: Form,
    /// Origin of the dictionary: the mean training frame for PCA, otherwise zero.
    origin: Array1<f64>,
    energy: Option<Energy>,
}

/// Energy of training frames in a dictionary: mean squares of their coefficients and of their residual.
#[derive(Clone, Debug, PartialEq)]
pub struct Energy {
    /// Mean square of the coefficient of each of the k atoms over the training frames, shape (k,).
    pub of_atoms: Array1<f64>,
    /// Mean square, per taxel, of the residual that remains when the atoms approximate the training frames.
    pub rest: f64,
}

/// Method that computes the coefficients of frames in a dictionary.
#[derive(Clone, Debug)]
enum Form {
    /// Fast transform, and the indices of the coefficients that belong to the dictionary.
    Fast(Arc<dyn Transform>, Vec<usize>),
    /// Stored atoms, one per row, shape (number of atoms, number of taxels).
    Stored(Array2<f64>),
}

/// Orthonormal transform of ny × nx arrays to as many coefficients, in place.
pub(super) trait Transform: Debug + Send + Sync {
    /// Replaces a frame by its coefficients.
    fn analyse(&self, frame: ArrayViewMut2<f64>);

    /// Replaces coefficients by their frame; the function inverts `analyse`.
    fn synthesise(&self, frame: ArrayViewMut2<f64>);
}

impl Dictionary {
    /// Returns the dictionary of all atoms of a fixed basis for an ny × nx array. The origin is zero.
    ///
    /// # Errors
    /// If the basis is PCA (which needs training frames), a wavelet basis has sides that are not powers of two, or there are no taxels.
    pub fn complete(basis: Basis, grid: ImageShape) -> Result<Self> {
        let n = grid.n_values();
        if n == 0 {
            return Err(Error::input("dictionary", "no taxels", "at least one"));
        }
        let transform: Arc<dyn Transform> = match basis {
            Basis::Dct => Arc::new(Cosine::new(grid)),
            Basis::Haar => Arc::new(Wavelet::haar(grid)?),
            Basis::Daubechies4 => Arc::new(Wavelet::daubechies4(grid)?),
            Basis::Pca => {
                let allowed = "a fixed basis, or a dictionary learned from frames";
                return Err(Error::input(
                    "dictionary",
                    "pca without training frames",
                    allowed,
                ));
            }
        };
        Ok(Self {
            basis,
            grid,
            form: Form::Fast(transform, (0..n).collect()),
            origin: Array1::zeros(n),
            energy: None,
        })
    }

    /// Returns the atoms with the largest energy in the training frames (n_frames × n_taxels), at most `n_atoms`, in the order of the basis. For PCA they are
    /// the first components. `None` selects all atoms (for PCA at most 256).
    ///
    /// # Errors
    /// If `complete` fails, if there are no frames, if frames have another length, if a value is not finite, or if `n_atoms` is 0.
    pub fn learned(
        basis: Basis,
        grid: ImageShape,
        frames: ArrayView2<f64>,
        n_atoms: Option<usize>,
        seed: &Seed,
    ) -> Result<Self> {
        check_training(grid, frames, n_atoms)?;
        if basis == Basis::Pca {
            let pca = Pca::new(frames.to_owned(), n_atoms.unwrap_or(PCA_ATOMS), seed);
            return Ok(Self::of_components(grid, pca));
        }
        let mut dictionary = Self::complete(basis, grid)?;
        let coefficients = dictionary.analyse(frames);
        let n_frames = frames.nrows() as f64;
        let energy = coefficients.mapv(|c| c * c).sum_axis(Axis(0)) / n_frames;
        let mut order: Vec<usize> = (0..energy.len()).collect();
        order.sort_by(|&i, &j| energy[j].total_cmp(&energy[i]).then(i.cmp(&j)));
        order.truncate(n_atoms.unwrap_or(usize::MAX));
        order.sort_unstable();
        let of_atoms = energy.select(Axis(0), &order);
        let n = energy.len();
        let rest = ((energy.sum() - of_atoms.sum()) / n as f64).max(0.0);
        dictionary.energy = Some(Energy {
            of_atoms,
            rest: if order.len() == n { 0.0 } else { rest },
        });
        if let Form::Fast(_, chosen) = &mut dictionary.form {
            *chosen = order;
        }
        Ok(dictionary)
    }

    pub(super) fn of_components(grid: ImageShape, pca: Pca) -> Self {
        let rest = pca.rest();
        Self {
            basis: Basis::Pca,
            grid,
            form: Form::Stored(pca.components),
            origin: pca.mean,
            energy: Some(Energy {
                of_atoms: pca.variance,
                rest,
            }),
        }
    }

    /// Returns the basis that contains the atoms.
    pub fn basis(&self) -> Basis {
        self.basis
    }

    /// Returns the number of taxels n.
    pub fn n_taxels(&self) -> usize {
        self.origin.len()
    }

    /// Returns the number k of atoms, at most the number of taxels.
    pub fn n_atoms(&self) -> usize {
        match &self.form {
            Form::Fast(_, chosen) => chosen.len(),
            Form::Stored(atoms) => atoms.nrows(),
        }
    }

    /// Returns the origin of the dictionary: the frame whose coefficients are all zero, shape (n_taxels,).
    pub fn origin(&self) -> &Array1<f64> {
        &self.origin
    }

    /// Returns the energy of the training frames in the atoms; `None` for a dictionary without training frames.
    pub fn energy(&self) -> Option<&Energy> {
        self.energy.as_ref()
    }

    /// Returns the coefficients of frames (n_frames × n), shape (n_frames, k). Each coefficient is the dot product of an atom with the frame minus the
    /// origin.
    ///
    /// # Panics
    /// If a frame does not have n values.
    pub fn analyse(&self, frames: ArrayView2<f64>) -> Array2<f64> {
        assert_eq!(frames.ncols(), self.n_taxels(), "taxels in a frame");
        let (transform, chosen) = match &self.form {
            Form::Stored(atoms) => return (&frames - &self.origin).dot(&atoms.t()),
            Form::Fast(transform, chosen) => (transform, chosen),
        };
        let mut coefficients = Array2::zeros((frames.nrows(), self.n_atoms()));
        let mut all = Array2::zeros((self.grid.ny, self.grid.nx));
        for (frame, mut row) in frames.outer_iter().zip(coefficients.outer_iter_mut()) {
            all.iter_mut().zip(frame).for_each(|(to, from)| *to = *from);
            transform.analyse(all.view_mut());
            let all = all.as_slice().expect("rows in order");
            for (to, &place) in row.iter_mut().zip(chosen) {
                *to = all[place];
            }
        }
        coefficients
    }

    /// Returns the frames for rows of coefficients (n_frames × k), shape (n_frames, n). Each frame is the origin plus the sum of the atoms, weighted with the
    /// coefficients.
    ///
    /// # Panics
    /// If a row does not have k values.
    pub fn synthesise(&self, coefficients: ArrayView2<f64>) -> Array2<f64> {
        let mut frames = self.combine(coefficients);
        if self.basis == Basis::Pca {
            frames += &self.origin;
        }
        frames
    }

    /// Returns the linear combinations of the atoms for rows of coefficients, without the origin of the dictionary.
    pub(super) fn combine(&self, coefficients: ArrayView2<f64>) -> Array2<f64> {
        assert_eq!(coefficients.ncols(), self.n_atoms(), "atoms in a row");
        let (transform, chosen) = match &self.form {
            Form::Stored(atoms) => return coefficients.dot(atoms),
            Form::Fast(transform, chosen) => (transform, chosen),
        };
        let mut frames = Array2::zeros((coefficients.nrows(), self.n_taxels()));
        for (row, mut frame) in coefficients.outer_iter().zip(frames.outer_iter_mut()) {
            for (&place, &value) in chosen.iter().zip(row) {
                frame[place] = value;
            }
            let grid = frame.into_shape_with_order((self.grid.ny, self.grid.nx));
            transform.synthesise(grid.expect("a row of n values"));
        }
        frames
    }

    /// Returns the atoms with indices in `range` as frames, one per row.
    pub(super) fn atoms(&self, range: std::ops::Range<usize>) -> Array2<f64> {
        if let Form::Stored(atoms) = &self.form {
            return atoms.slice(s![range, ..]).to_owned();
        }
        let mut units = Array2::zeros((range.len(), self.n_atoms()));
        units.slice_mut(s![.., range]).diag_mut().fill(1.0);
        self.combine(units.view())
    }
}

pub(super) fn check_training(
    grid: ImageShape,
    frames: ArrayView2<f64>,
    n_atoms: Option<usize>,
) -> Result<()> {
    let n = grid.n_values();
    if frames.nrows() == 0 || frames.ncols() != n || n == 0 {
        return Err(Error::input(
            "training frames",
            format!("{} of {} taxels", frames.nrows(), frames.ncols()),
            format!("at least one, of {n} taxels"),
        ));
    }
    if let Some(((row, column), value)) = frames.indexed_iter().find(|(_, v)| !v.is_finite()) {
        return Err(Error::input(
            format!("training frame {row}, taxel {column}"),
            value,
            "a finite number",
        ));
    }
    if n_atoms == Some(0) {
        return Err(Error::input("number of atoms", 0, "at least 1"));
    }
    Ok(())
}
