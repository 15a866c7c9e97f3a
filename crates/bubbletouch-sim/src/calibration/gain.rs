//! Gain: what a taxel reads of what its four neighbours read.
//!
//! dᵢ is the median over frames in which all five are well pressed of ln xᵢ − ¼ Σⱼ ln xⱼ. The pressure under a contact does the same to every taxel
//! on average, so what differs from taxel to taxel is ln gᵢ − ¼ Σⱼ ln gⱼ: the variance of ln g is that of d over ‖L S‖², the squared norm of this
//! operator L after the smoothing S (5/4 without). Medians of even and of odd frames err independently, so their covariance over taxels is the variance of
//! d without what touches and noise add. Gains are log-normal: std² = exp(Var ln g) − 1.

use super::robust::{jackknife, mean, median};
use super::{Estimate, RecordedSkin};
use crate::signal::Smoothing;
use crate::world::Grid;
use ndarray::{Array1, Array2};

/// What a taxel that is well pressed reads, of the full scale: less is noise and edges, more is clipped.
const PRESSED: [f64; 2] = [0.05, 0.97];
/// The same in standard deviations of the noise, at least.
const ABOVE_NOISE: f64 = 10.0;
/// Frames of either half in which a taxel and its neighbours are well pressed, at least.
const MIN_FRAMES: usize = 3;
/// Taxels of which gains are known, at least: their spread errs by a tenth with 50.
const MIN_TAXELS: usize = 50;
/// Sweeps of Gauss and Seidel. Fewer leave gains that differ over the array.
const N_SWEEPS: usize = 200;

/// Gains of the taxels of a skin.
#[derive(Clone, Debug)]
pub struct Gains {
    /// Standard deviation of gains of mean 1.
    pub spread: Estimate,
    /// One for each taxel; 1 where nothing is known.
    pub of_taxels: Array1<f64>,
}

impl Gains {
    /// From touched frames without their zeros; of noise of a standard deviation, smoothed by a width in pitches.
    pub(super) fn of(
        skin: &RecordedSkin,
        touched: &Array2<f64>,
        (noise, width): (f64, f64),
    ) -> Self {
        let pressed = [PRESSED[0].max(ABOVE_NOISE * noise), PRESSED[1]];
        let halves: Vec<Option<[f64; 2]>> = (0..skin.n_taxels())
            .map(|taxel| halves(skin, touched, taxel, pressed))
            .collect();
        let known = halves.iter().flatten().count();
        if known < MIN_TAXELS {
            return Self {
                spread: Estimate::unknown(format!(
                    "only {known} taxels are well pressed together with all of their neighbours in {} frames or more",
                    2 * MIN_FRAMES
                )),
                of_taxels: Array1::ones(halves.len()),
            };
        }
        let share = operator_norm(skin.shape, width);
        let spread = jackknife(halves.len(), |keep| {
            let kept = halves.iter().enumerate().filter(|(taxel, _)| keep(*taxel));
            let kept: Vec<[f64; 2]> = kept.filter_map(|(_, halves)| *halves).collect();
            Some(covariance(&kept) / share)
        });
        let std = |variance: f64| variance.max(0.0).exp_m1().sqrt();
        Self {
            spread: spread.map_or_else(|| Estimate::unknown("too few taxels"), |v| v.map(std)),
            of_taxels: gains(skin, &halves),
        }
    }
}

/// d of even and of odd frames.
fn halves(
    skin: &RecordedSkin,
    touched: &Array2<f64>,
    taxel: usize,
    [least, most]: [f64; 2],
) -> Option<[f64; 2]> {
    let near = skin.neighbours(taxel)?;
    let five = [taxel, near[0], near[1], near[2], near[3]];
    let mut halves = [Vec::new(), Vec::new()];
    for (frame, readings) in touched.outer_iter().enumerate() {
        let five = five.map(|taxel| readings[taxel]);
        if five.iter().all(|reading| (least..most).contains(reading)) {
            let around = five[1..].iter().map(|reading| reading.ln());
            halves[frame % 2].push(five[0].ln() - 0.25 * around.sum::<f64>());
        }
    }
    let is_known = halves.iter().all(|half| half.len() >= MIN_FRAMES);
    is_known.then(|| halves.map(|mut half| median(&mut half)))
}

/// Of two numbers a taxel, without those that are furthest out.
fn covariance(pairs: &[[f64; 2]]) -> f64 {
    let means = [0, 1].map(|half| mean(pairs.iter().map(|pair| pair[half])));
    let products = pairs.iter().map(|[a, b]| (a - means[0]) * (b - means[1]));
    mean(products)
}

/// ‖L S‖² in the middle of the array.
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
    if let Ok(smoothing) = Smoothing::new(width, &grid) {
        smoothing.apply(&mut response, &mut vec![0.0; smoothing.scratch_len()]);
    }
    response.iter().map(|r| r * r).sum()
}

/// Gains whose d is the one found: ln gᵢ = dᵢ + ¼ Σⱼ ln gⱼ, of mean 1.
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
