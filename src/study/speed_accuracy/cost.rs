//! What pieces of each part take, about: for the time left. Seconds measured on a 2-core x86-64 server.

use super::engines::StepMethod;
use super::table::Touched;
use crate::recognition::ClassifierKind;
use crate::study::time_left::Piece;

/// Stages.
const MODELS: u8 = 0;
const TOUCHES: u8 = 1;
const STEPS: u8 = 2;
const CHAINS: u8 = 3;
const STUDIES: u8 = 4;

/// To make the models of an object or a scan, which is packed unless its packing was kept.
pub(super) fn models(touched: Touched) -> Piece {
    let planned_s = match touched {
        Touched::Object => 0.1,
        Touched::Scan => 30.0,
    };
    Piece::of_stage(MODELS, touched as usize, planned_s)
}

/// To time its touches.
pub(super) fn touches(touched: Touched) -> Piece {
    Piece::one_by_one(TOUCHES, touched as usize, 0.065)
}

/// To step through time, `dt` seconds at once: ours in milliseconds, an engine of rigid bodies in seconds.
pub(super) fn steps(method: StepMethod, dt: f64) -> Piece {
    let per_step_s = match method {
        #[cfg(feature = "rapier")]
        StepMethod::Rapier => 3e-3,
        _ => 3e-5,
    };
    Piece::one_by_one(STEPS, method as usize, per_step_s / dt)
}

/// To learn from so many measurements a touch, and to decide.
pub(super) fn chain(classifier: ClassifierKind, n_measurements: f64) -> Piece {
    Piece::one_by_one(CHAINS, classifier as usize, 0.04 + 4e-4 * n_measurements)
}

/// For a study of so many touches an object: what is learned grows with their square.
pub(super) fn study(n_touches: usize) -> Piece {
    let n = n_touches as f64;
    Piece::one_by_one(STUDIES, 0, 0.9 + 8.6e-4 * n * n)
}
