//! Signals and sensing: noise, sensor errors, projections and reconstruction.

mod body_readout;
mod sensing_dictionaries;
mod sensing_projection;
mod sensing_reconstruction;
mod signal_allocation;
mod signal_chain;
mod signal_imperfections;
mod signal_layouts;

use bubbletouch_sim::random::Seed;
use bubbletouch_sim::sensing::{Basis, Dictionary, Ensemble, Projection};
use bubbletouch_sim::signal::{Chain, Noise, NoiseUnit, SignalStep, SignalWorkspace};
use bubbletouch_sim::world::{Grid, ImageShape, Patch, Taxel};
use ndarray::{Array1, Array2};

const PITCH: f64 = 2e-3;
const TAXEL: Taxel = Taxel {
    radius: 1e-3,
    stiffness: 200.0,
    damping: 0.4,
    stroke: 5e-3,
};

/// Ensembles whose rows mix taxels randomly.
const RANDOM: [Ensemble; 4] = [
    Ensemble::Gaussian,
    Ensemble::Bernoulli,
    Ensemble::Sparse,
    Ensemble::Sbhe,
];

fn shape(ny: usize, nx: usize) -> ImageShape {
    ImageShape { ny, nx }
}

fn drawn(ensemble: Ensemble, grid: ImageShape, m: usize, seed: u64) -> Projection {
    Projection::new(ensemble, grid, m, &Seed::new(seed)).unwrap()
}

fn complete(basis: Basis, grid: ImageShape) -> Dictionary {
    Dictionary::complete(basis, grid).unwrap()
}

/// Returns all ensembles that are drawn, and therefore linear.
fn linear() -> impl Iterator<Item = Ensemble> {
    Ensemble::ALL.iter().copied().filter(|one| one.is_drawn())
}

fn grid(nx: usize, ny: usize) -> Patch {
    let pitch = PITCH;
    Patch::grid(Grid { nx, ny, pitch }, TAXEL).unwrap()
}

/// Solves a linear system by Gaussian elimination with pivoting.
fn gauss(mut a: Array2<f64>, mut b: Array1<f64>) -> Array1<f64> {
    let n = b.len();
    for i in 0..n {
        let pivot = (i..n)
            .max_by(|&p, &q| a[[p, i]].abs().total_cmp(&a[[q, i]].abs()))
            .unwrap();
        for j in 0..n {
            a.swap([i, j], [pivot, j]);
        }
        b.swap(i, pivot);
        for row in i + 1..n {
            let factor = a[[row, i]] / a[[i, i]];
            for j in i..n {
                a[[row, j]] -= factor * a[[i, j]];
            }
            b[row] -= factor * b[i];
        }
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|j| a[[i, j]] * b[j]).sum();
        b[i] = (b[i] - known) / a[[i, i]];
    }
    b
}

/// Returns noise with a standard deviation relative to the full scale.
fn noise(std: f64) -> SignalStep {
    let unit = NoiseUnit::FullScale;
    SignalStep::Noise(Noise { std, unit })
}

fn smoothing(width_pitches: f64) -> SignalStep {
    let width = width_pitches * PITCH;
    SignalStep::Smoothing { width }
}

/// Returns the readings of a touch with a single frame.
fn read(steps: &[SignalStep], skin: &Patch, frame: &[f64], touch: u64) -> Vec<f64> {
    let chain = Chain::new(steps, skin).unwrap();
    let mut out = frame.to_vec();
    let touch = Seed::new(2018).numbered(touch);
    chain.apply(&mut out, None, &touch, &mut SignalWorkspace::default());
    out
}
