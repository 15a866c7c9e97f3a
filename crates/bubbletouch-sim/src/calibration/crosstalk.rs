//! Estimation of crosstalk from the readings of untouched taxels beside an edge of contact.
//!
//! Readings are x = A δ, where the operator A leaks a fraction κ of the deflections δ. An untouched taxel reads κ/4 Σⱼ δⱼ of its four neighbours; a touched
//! taxel reads more because of its own deflection. The estimate uses taxels with a pressed neighbour on one side and a quiet one opposite. Their ratios xᵢ / Σⱼ
//! δⱼ are densest at κ/4. Since δ = A⁻¹ x depends on κ, the estimate starts at κ = 0 and is iterated until it converges.
//!
//! The estimate refers to leakage before gains and noise. An elastic cover that rounds all edges cannot be distinguished from leakage.

use super::gain::Gains;
use super::robust::{jackknife, mode};
use super::saturation::CLIPPED;
use super::{Estimate, NotIdentifiable, RecordedSkin};
use crate::signal::{Crosstalk, Effect};
use crate::world::Grid;
use ndarray::{Array1, Array2};

/// Maximum number of frames that the estimate uses, evenly spaced among all frames. A larger number takes longer.
const N_FRAMES: usize = 1000;
/// Minimum sum of the readings of a taxel's pressed neighbours: as a fraction of the full scale, and in standard deviations of the noise.
const PRESSED: [f64; 2] = [0.15, 60.0];
/// Maximum reading of an unpressed taxel: as a fraction of the full scale, and in standard deviations of the noise.
const QUIET: [f64; 2] = [0.01, 3.0];
/// Minimum number of taxels beside an edge of contact that an estimate needs.
const FEWEST: usize = 200;
/// Number of fixed-point iterations that estimate the leaked fraction.
const N_ROUNDS: usize = 8;
/// Largest change of the leaked fraction in the last iteration: absolute, and relative to the fraction. If larger, a fraction counts that the readings beside
/// edges do not confirm; if smaller, slow convergence counts as none.
const CONVERGED: [f64; 2] = [0.002, 0.02];
/// Number of iterations that invert the crosstalk. The remaining fraction of an error is at most (2κ)²⁵ for the leaked fraction κ.
const N_STEPS: usize = 25;
/// Largest leaked fraction for which the iteration that inverts the crosstalk converges fast enough.
const LARGEST: f64 = 0.45;

/// Estimates the fraction of a taxel's value that leaks to its neighbours. `noise` is the standard deviation of a reading, which includes errors of the zero
/// offsets; `width` is the width of the smoothing in pitches.
pub(super) fn estimate(
    skin: &RecordedSkin,
    touched: &Array2<f64>,
    gains: &Gains,
    (noise, width): (f64, f64),
) -> Estimate {
    if width > 0.0 {
        return Err("smoothing hides how sharp the edges of a contact are".into());
    }
    let stride = touched.nrows().div_ceil(N_FRAMES).max(1);
    let frames = touched.outer_iter().step_by(stride);
    let frames: Vec<Array1<f64>> = frames.map(|frame| &frame / &gains.of_taxels).collect();
    let (mut leak, mut before) = (0.0, 0.0);
    let mut shares = Vec::new();
    for _ in 0..N_ROUNDS {
        before = leak;
        shares = frames
            .iter()
            .map(|frame| shares_of(skin, frame, leak, noise))
            .collect();
        let mut all = shares.concat();
        if all.len() < FEWEST {
            let n = all.len();
            let why = format!("only {n} taxels are beside an edge of a contact");
            return Err(NotIdentifiable(why));
        }
        leak = (4.0 * mode(&mut all)).clamp(0.0, LARGEST);
    }
    if leak == LARGEST {
        let why = format!("more than {LARGEST} seems to leak: edges are not sharp");
        return Err(NotIdentifiable(why));
    }
    if (leak - before).abs() > CONVERGED[0].max(CONVERGED[1] * leak) {
        return Err("noise or drifting zeros hide the edges of contacts".into());
    }
    let found = jackknife(shares.len(), |keep| {
        let kept = (0..shares.len()).filter(|&frame| keep(frame));
        let mut kept: Vec<f64> = kept
            .flat_map(|frame| shares[frame].iter().copied())
            .collect();
        Some(4.0 * mode(&mut kept))
    });
    Ok(found.ok_or("there are too few frames")?)
}

/// Returns, for each taxel beside an edge of contact, the ratio of its reading to the sum of its neighbours' deflections.
fn shares_of(skin: &RecordedSkin, frame: &Array1<f64>, leak: f64, noise: f64) -> Vec<f64> {
    let pressed = PRESSED[0].max(PRESSED[1] * noise);
    let quiet = QUIET[0].max(QUIET[1] * noise);
    let felt = sharpened(skin, &skin.filled(frame.view()), leak);
    let mut shares = Vec::new();
    for taxel in 0..frame.len() {
        let Some(near) = skin.neighbours(taxel) else {
            continue;
        };
        // The comparison is false for unknown readings (NaN).
        let is_usable = |&taxel: &usize| frame[taxel] < CLIPPED;
        let sum: f64 = near.iter().map(|&near| felt[near]).sum();
        let [left, right, above, below] = near.map(|near| frame[near]);
        let is_edge = |a: f64, b: f64| a.min(b).abs() < quiet && a.max(b) > 0.25 * pressed;
        if sum > pressed
            && (is_edge(left, right) || is_edge(above, below))
            && is_usable(&taxel)
            && near.iter().all(is_usable)
        {
            shares.push(frame[taxel] / sum);
        }
    }
    shares
}

/// Returns the deflections δ before crosstalk, for a frame x of readings. The function solves A δ = x for the crosstalk matrix A by the iteration δ ← δ + x −
/// A δ.
fn sharpened(skin: &RecordedSkin, frame: &[f64], leak: f64) -> Vec<f64> {
    let (ny, nx) = skin.shape;
    let grid = Grid { nx, ny, pitch: 1.0 };
    let crosstalk = Crosstalk::new(leak, &grid);
    let mut felt = frame.to_vec();
    let (mut read, mut scratch) = (felt.clone(), felt.clone());
    for _ in 0..N_STEPS {
        read.copy_from_slice(&felt);
        crosstalk.apply_to_frame(&mut read, &mut scratch);
        for ((felt, x), read) in felt.iter_mut().zip(frame).zip(&read) {
            *felt += x - read;
        }
    }
    felt
}
