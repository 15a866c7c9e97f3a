//! Sensing: compresses frames to measurements `y = Φx`, and reconstructs frames.
//!
//! A [`Projection`] converts a frame x of n taxels (ny × nx, row after row) to m measurements, 1 ≤ m ≤ n. The compression ratio is n / m.
//!
//! | ensemble | row of Φ | a row's norm | stored |
//! |---|---|---|---|
//! | [`Gaussian`](Ensemble::Gaussian) | independent N(0, 1/n) | 1 on average | m × n numbers |
//! | [`Bernoulli`](Ensemble::Bernoulli) | independent ±1/√n | 1 | m × n numbers |
//! | [`Circulant`](Ensemble::Circulant) | a cyclic shift of one row of ±1/√n | 1 | n + m numbers |
//! | [`Sparse`](Ensemble::Sparse) | independent ±√(s/n) at a density of 1/s, s = √n, else 0 | 1 on average | m√n indices |
//! | [`Sbhe`](Ensemble::Sbhe) | ±1/√B on the B taxels of a scrambled block \[SBHE\] | 1 | n + m indices |
//! | [`BlockAverage`](Ensemble::BlockAverage) | 1/area on a rectangle of taxels | 1/√area | m rectangles |
//! | [`Subsample`](Ensemble::Subsample) | one taxel | 1 | m indices |
//! | [`Selected`](Ensemble::Selected) | one taxel that a [`Selection`] selects on training frames | 1 | m indices |
//! | [`Adaptive`](Ensemble::Adaptive) | none: m readings of blocks that depend on the frame | at most 1 | nothing |
//! | [`AdaptiveLearned`](Ensemble::AdaptiveLearned) | none: the readings of `Adaptive`, and an estimate that is learned from training frames | at most 1 | 2 k × n numbers, k components |
//! | [`Fourier`](Ensemble::Fourier) | a cosine or sine of a low frequency, ±√2/√n at most | 1 | m × n numbers |
//! | [`PrincipalComponents`](Ensemble::PrincipalComponents) | a principal component of training frames | 1 | m × n numbers |
//! | [`Identity`](Ensemble::Identity) | one taxel, all n in order | 1 | nothing |
//!
//! **Scale.** No entry depends on m. For the random ensembles √(n/m)·Φ therefore preserves norms on average (Johnson and Lindenstrauss);
//! a study that scales its features is not affected.
//!
//! **Nesting.** For one seed, the first m measurements of a larger projection are bit by bit the measurements of the smaller one
//! ([`Ensemble::is_prefix_nested`]). A sweep over ratios projects once, at its largest m, and takes leading columns. Plain block averages cannot be nested in
//! this way: the mean of the whole array is the mean of neither of its halves. The documentation of [`Ensemble::BlockAverage`] describes how block averages are
//! nested.
//!
//! **Repeatability.** A row of measurements has equal bits in any batch.
//!
//! # Back to frames
//!
//! A [`Dictionary`] Ψ of orthonormal atoms represents frames as x = x₀ + Ψα. The projected dictionary is A = ΦΨ, a
//! [`SensedDictionary`], and a [`Reconstructor`] computes α from y − Φx₀ = Aα + Φ·noise.
//!
//! | solver | α | cost of a frame |
//! |---|---|---|
//! | [`Omp`] | s atoms, greedily, until the residual is noise | mk + ks² |
//! | [`Lasso`] (FISTA) | argmin ½‖y − Aα‖² + λ‖α‖₁ | steps × 2 min(k², 2mk) |
//! | [`Lmmse`] | E Aᵀ(A E Aᵀ + (τ + σ²)ΦΦᵀ)⁻¹ y, E and τ from training frames | min(mn, k(m + n)) |
//!
//! **Noise.** Noise is added on the taxels, before Φ: y = Φ(x + noise). For any number of measurements, the noise of a measurement is therefore σ times the
//! norm of its row. Full sampling gives the noisy frame itself.
//!
//! The possible accuracy for a pair of Φ and Ψ is bounded by its [`Coherence`] and restricted isometry
//! ([`SensedDictionary::isometry`]).
//!
//! # Stages
//!
//! | stage | input → output |
//! |---|---|
//! | `ensembles` | a name and a seed → the map Φ ([`Ensemble`], [`Operator`]) |
//! | `selection` | training frames and labels → taxels to read ([`Selection`]) |
//! | `projection`, `several_images`, `columns` | frames → measurements ([`Projection`]) |
//! | `dictionary`, `wavelet`, `pca`, `cosine` | training frames → atoms Ψ ([`Dictionary`]) |
//! | `sensed`, `coherence` | Φ and Ψ → A = ΦΨ, and its coherence |
//! | `reconstruction` | measurements → frames ([`Reconstructor`]) |
//! | `image_prior`, `image_estimate` | measurements → linear estimates of images ([`ImageEstimate`]) |

mod coherence;
mod columns;
mod cosine;
mod dictionary;
mod ensembles;
mod image_estimate;
mod image_prior;
mod pca;
mod projection;
mod reconstruction;
mod selection;
mod sensed;
mod several_images;
mod wavelet;

pub use coherence::{Coherence, Extremes};
pub use columns::Columns;
pub use dictionary::{Basis, Dictionary, Energy, PCA_ATOMS};
pub use ensembles::{Draw, Ensemble, EnsembleAbout, Learn, Operator, Source, TrainingFrames};
pub use image_estimate::{ImageEstimate, N_STEPS};
pub use image_prior::{ImagePrior, N_COMPONENTS, Readings};
pub use projection::Projection;
pub use reconstruction::{
    Effort, Lasso, Lmmse, Omp, Reconstruction, Reconstructor, Solved, Solver,
};
pub use selection::Selection;
pub use sensed::SensedDictionary;
