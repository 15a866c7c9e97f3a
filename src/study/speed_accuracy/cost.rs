//! What pieces of each part take, about: for the time left. Seconds measured on a 2-core x86-64 server.

use super::engines::StepMethod;
use super::table::Touched;
use crate::recognition::ClassifierKind;
use crate::sensing::Ensemble;
use crate::study::time_left::Piece;

/// Stages.
const MODELS: u8 = 0;
const TOUCHES: u8 = 1;
const STEPS: u8 = 2;
const CHAINS: u8 = 3;
const STUDIES: u8 = 4;
const BENCHES: u8 = 5;
const FRONTS: u8 = 6;

/// Seconds to read one taxel and its noise.
const READ_S: f64 = 8e-9;
/// Seconds for one multiply-add of a stored matrix with one frame alone.
const DENSE_ALONE_S: f64 = 1.05e-9;

/// To make the models of an object or a scan, which is packed unless its packing was kept.
pub(super) fn models(touched: Touched) -> Piece {
    let planned_s = match touched {
        Touched::Object => 0.1,
        Touched::Scan => 30.0,
    };
    Piece::of_stage(MODELS, planned_s)
}

/// To time its touches.
pub(super) fn touches() -> Piece {
    Piece::one_by_one(TOUCHES, 0.065)
}

/// To step through time, `dt` seconds at once: ours in milliseconds, an engine of rigid bodies in seconds.
pub(super) fn steps(method: StepMethod, dt: f64) -> Piece {
    let per_step_s = match method {
        #[cfg(feature = "rapier")]
        StepMethod::Rapier => 3e-3,
        _ => 3e-5,
    };
    Piece::one_by_one(STEPS, per_step_s / dt)
}

/// To make the touches of an array and a detail.
pub(super) fn bench() -> Piece {
    Piece::one_by_one(BENCHES, 0.1)
}

/// To bring touches of a detail and as many of the exact objects down to measurements, and to time some of them alone, twice.
pub(super) fn front(
    (ensemble, n_measurements): (Ensemble, f64),
    n_taxels: usize,
    (n_touches, n_timed): (usize, usize),
) -> Piece {
    let frame_s = |project_s: f64| n_taxels as f64 * (READ_S + project_s);
    let together_s = frame_s(match ensemble {
        Ensemble::Gaussian | Ensemble::Bernoulli => 6e-11 * n_measurements,
        _ => 1e-9,
    });
    let alone_s = match ensemble {
        // The matrix is read from memory for each.
        Ensemble::Gaussian | Ensemble::Bernoulli => frame_s(DENSE_ALONE_S * n_measurements),
        _ => together_s,
    };
    let n_threads = rayon::current_num_threads() as f64;
    let planned_s = 2.0 * (n_touches as f64 * together_s / n_threads + n_timed as f64 * alone_s);
    Piece::one_by_one(FRONTS, planned_s)
}

/// To learn from so many measurements a touch, and to decide.
pub(super) fn chain(classifier: ClassifierKind, n_measurements: f64) -> Piece {
    let planned_s = match classifier {
        ClassifierKind::RandomForest => 0.03 + 0.022 * n_measurements.sqrt(),
        _ => 0.025 + 2e-4 * n_measurements,
    };
    Piece::one_by_one(CHAINS, planned_s)
}

/// For a study of so many touches an object: what is learned grows with their square.
pub(super) fn study(n_touches: usize) -> Piece {
    let n = n_touches as f64;
    Piece::one_by_one(STUDIES, 0.9 + 8.6e-4 * n * n)
}
