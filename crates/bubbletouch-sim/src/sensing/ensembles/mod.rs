//! Ensembles of measurements: one module, and one line below, for each ensemble.

mod dense;
#[macro_use]
mod ensemble;

// The properties of an ensemble follow from its line here and from the module that the line names.
ensembles! {
    Gaussian gaussian "Independent Gaussian entries.";
    Bernoulli bernoulli "Independent entries ±1/√n, either sign as likely.";
    Sparse sparse "Independent entries +√(s/n), 0, −√(s/n) with probabilities 1/2s, 1 − 1/s, 1/2s, where s = √n: the very sparse projections of Li, Hastie and Church (2006). A measurement reads √n taxels on average.";
    Circulant circulant "Some rows of a random circulant matrix: cyclic shifts of one row of signs ±1/√n.";
    Sbhe sbhe "Scrambled block Hadamard \\[SBHE\\]: taxels permuted, Walsh–Hadamard transforms of blocks, coefficients in random order.";
    BlockAverage block_average "Averages over blocks of neighbouring taxels: equal squares where the array allows them (64 × 64 at m = 1,024 is 2 × 2 taxels each), else the cells of recursive splitting, largest first, along its longer side. A cell of a smaller m is a union of cells of a larger m, so the smaller measurements follow from the larger, among all m of splitting and among squares whose sides divide each other (ratios 4, 16, 64 …).";
    Subsample subsample "Some taxels, drawn without replacement.";
    Selected selected "Some taxels, selected on frames of training touches by the method `selection`.";
    Adaptive adaptive "Averages over blocks of taxels, chosen anew in each frame: coarse blocks first, then halves of the block with the largest sum, m readings in all. The values of a frame are an estimate of the whole frame.";
    AdaptiveLearned adaptive_learned "The readings of `adaptive`; the frame is estimated by the mean and the principal components of training frames instead of block means.";
    Fourier fourier "The lowest Fourier coefficients: products of cosines and sines, the lowest frequencies first.";
    PrincipalComponents principal_components "The first principal components of frames that training touches read: directions in which they differ most.";
    Identity identity "The frame itself, whatever m.";
}

pub use ensemble::{Draw, EnsembleAbout, Learn, Operator, Source, TrainingFrames};
pub(super) use sbhe::ScrambledHadamard;

use serde::{Deserialize, Serialize};
