//! Estimation of gains from the readings of taxels relative to the readings of their four neighbours.
//!
//! Let dᵢ be the median of ln xᵢ − ¼ Σⱼ ln xⱼ over frames in which all five taxels are well pressed. The pressure under a contact has an equal effect on
//! every taxel on average, so the differences between taxels are ln gᵢ − ¼ Σⱼ ln gⱼ. Let L be this operator and S the smoothing. The variance of ln g is
//! the variance of d divided by ‖L S‖² (5/4 without smoothing). Medians of even and of odd frames have independent errors. Their covariance over taxels is
//! therefore the variance of d without the effects of contacts and noise. Gains are log-normal: std² = exp(Var ln g) − 1.
//!
//! An error z of a taxel's zero offset acts like a gain of ln g = z / x. Both halves of the frames have its mean z̄ over time, so the interval of Var ln g is
//! extended downwards by the effect of this mean, Var z̄ E[1/x]².

use super::robust::{jackknife, mean, median};
use super::saturation::CLIPPED;
use super::touched::Errors;
use super::{Estimate, NotIdentifiable, RecordedSkin};
use crate::signal::{Effect, Smoothing};
use crate::world::Grid;
use ndarray::{Array1, Array2};
use std::ops::Range;

/// Smallest reading of a well-pressed taxel, relative to the full scale. Noise and edges of contacts affect lower readings.
const PRESSED: f64 = 0.05;
/// Minimum reading of a well-pressed taxel, in standard deviations of the noise.
const ABOVE_NOISE: f64 = 10.0;
/// Minimum number of even frames, and of odd frames, in which a taxel and its neighbours are well pressed.
const MIN_FRAMES: usize = 3;
/// Minimum number of taxels with known gains; with 50 taxels, the standard deviation of the gains has an error of a tenth.
const MIN_TAXELS: usize = 50;
/// Number of Gauss–Seidel iterations that compute the gains. If smaller, errors that vary slowly over the array remain.
const N_SWEEPS: usize = 200;

/// Estimated gains of the taxels of a skin.
#[derive(Clone, Debug)]
pub struct Gains {
    /// Standard deviation of the gains, relative to their mean 1.
    pub spread: Estimate,
    /// Gain of each taxel; 1 if it is unknown.
    pub of_taxels: Array1<f64>,
}

impl Gains {
    /// Estimates the gains from frames with contact after subtraction of the zero offsets. `errors` are the errors of these frames; `width` is
    /// the width of the smoothing in pitches.
    pub(super) fn new(
        skin: &RecordedSkin,
        touched: &Array2<f64>,
        (errors, width): (&Errors, f64),
    ) -> Self {
        let pressed = PRESSED.max(ABOVE_NOISE * errors.total())..CLIPPED;
        let found: Vec<Option<Halves>> = (0..skin.n_taxels())
            .map(|taxel| halves(skin, touched, taxel, &pressed))
            .collect();
        let inverse = mean(found.iter().flatten().map(|halves| halves.inverse));
        let halves: Vec<Option<[f64; 2]>> = found
            .into_iter()
            .map(|halves| halves.map(|halves| halves.log_ratios))
            .collect();
        let known = halves.iter().flatten().count();
        if known < MIN_TAXELS {
            return Self {
                spread: Err(NotIdentifiable(format!(
                    "only {known} taxels are well pressed together with all of their neighbours in {} frames or more",
                    2 * MIN_FRAMES
                ))),
                of_taxels: Array1::ones(halves.len()),
            };
        }
        let share = operator_norm(skin.shape, width);
        let spread = jackknife(halves.len(), |keep| {
            let kept = halves.iter().enumerate().filter(|(taxel, _)| keep(*taxel));
            let kept: Vec<[f64; 2]> = kept.filter_map(|(_, halves)| *halves).collect();
            Some(covariance(&kept) / share)
        });
        let of_zeros = (errors.of_mean_zeros * inverse).powi(2);
        let std = |variance: f64| variance.max(0.0).exp_m1().sqrt();
        Self {
            spread: spread
                .map(|spread| spread.lowered_by(of_zeros).map(std))
                .ok_or("too few taxels".into()),
            of_taxels: gains(skin, &halves),
        }
    }
}

/// Readings of a taxel relative to its neighbours, in frames in which all of them are well pressed.
struct Halves {
    /// Median logarithm of the ratio between the readings of the taxel and of its neighbours, in even frames and in odd frames.
    log_ratios: [f64; 2],
    /// Mean of the inverse readings of the taxel.
    inverse: f64,
}

/// Returns the readings of a taxel relative to its neighbours; `None` if they are well pressed together in too few frames.
fn halves(
    skin: &RecordedSkin,
    touched: &Array2<f64>,
    taxel: usize,
    pressed: &Range<f64>,
) -> Option<Halves> {
    let near = skin.neighbours(taxel)?;
    let five = [taxel, near[0], near[1], near[2], near[3]];
    let (mut halves, mut inverses) = ([Vec::new(), Vec::new()], Vec::new());
    for (frame, readings) in touched.outer_iter().enumerate() {
        let five = five.map(|taxel| readings[taxel]);
        if five.iter().all(|reading| pressed.contains(reading)) {
            let around = five[1..].iter().map(|reading| reading.ln());
            halves[frame % 2].push(five[0].ln() - 0.25 * around.sum::<f64>());
            inverses.push(1.0 / five[0]);
        }
    }
    let is_known = halves.iter().all(|half| half.len() >= MIN_FRAMES);
    is_known.then(|| Halves {
        log_ratios: halves.map(|mut half| median(&mut half)),
        inverse: mean(inverses.into_iter()),
    })
}

/// Returns the covariance of pairs of numbers, computed without outliers.
fn covariance(pairs: &[[f64; 2]]) -> f64 {
    let means = [0, 1].map(|half| mean(pairs.iter().map(|pair| pair[half])));
    let products = pairs.iter().map(|[a, b]| (a - means[0]) * (b - means[1]));
    mean(products)
}

/// Returns the squared norm of an operator at a taxel in the middle of the array. The operator smooths a frame and then subtracts the neighbours' mean from
/// the taxel.
fn operator_norm((rows, columns): (usize, usize), width: f64) -> f64 {
    let grid = Grid {
        nx: columns,
        ny: rows,
        pitch: 1.0,
    };
    let mut response = vec![0.0; rows * columns];
    let middle = rows / 2 * columns + columns / 2;
    response[middle] = 1.0;
    for near in [middle - 1, middle + 1, middle - columns, middle + columns] {
        response[near] = -0.25;
    }
    let smoothing = Smoothing::new(width, &grid).expect("the width is an estimate");
    smoothing.apply_to_frame(&mut response, &mut vec![0.0; smoothing.scratch_len()]);
    response.iter().map(|r| r * r).sum()
}

/// Returns the gains g of all taxels, scaled to mean 1. The function solves ln gᵢ = dᵢ + ¼ Σⱼ ln gⱼ over the four neighbours j of taxel i, with the mean log
/// ratios d of `halves`.
fn gains(skin: &RecordedSkin, halves: &[Option<[f64; 2]>]) -> Array1<f64> {
    let both = |halves: &[f64; 2]| 0.5 * (halves[0] + halves[1]);
    let middle = mean(halves.iter().flatten().map(both));
    let mut logs = vec![0.0; halves.len()];
    for _ in 0..N_SWEEPS {
        for (taxel, halves) in halves.iter().enumerate() {
            if let (Some(halves), Some(near)) = (halves, skin.neighbours(taxel)) {
                let around = near.iter().map(|&near| logs[near]).sum::<f64>();
                logs[taxel] = both(halves) - middle + 0.25 * around;
            }
        }
    }
    logs.iter().map(|log: &f64| log.exp()).collect()
}
