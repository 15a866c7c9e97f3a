//! Detection of faults: taxels whose standard deviation over touched frames is below a tenth of the typical value among the 5 × 5 taxels around them.
//!
//! A faulty taxel that stays at its zero is dead; one that stays at another level is stuck. If stuck levels are uniform over the full scale, 1 % of the stuck
//! taxels are classified as dead. If none of the surrounding taxels changed, the state is unknown.

use super::robust::median;
use super::{Estimate, Measured, NotIdentifiable, RecordedSkin};
use crate::statistics::interval::Interval;
use ndarray::Axis;

/// Minimum standard deviation of a working taxel's readings relative to its neighbours. If larger, taxels of low gain count as faulty; if smaller, noisy
/// faulty taxels are missed.
const MOVES: f64 = 0.1;
/// Largest constant reading of a dead taxel, as a fraction of the full scale.
const DEAD: f64 = 0.01;

/// Faulty taxel, whose reading stays constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// Index of the taxel.
    pub taxel: usize,
    /// Whether the constant reading is zero (dead taxel) instead of another level (stuck taxel).
    pub is_dead: bool,
}

/// State of each taxel of a skin: working, faulty or unknown.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundFaults {
    /// List of the faulty taxels.
    pub faults: Vec<Fault>,
    /// Whether each taxel works; also true if its state is unknown.
    pub is_sound: Vec<bool>,
    /// Number of taxels with a known state.
    n_known: usize,
}

/// Finds the faulty taxels of a recorded skin.
pub fn find(skin: &RecordedSkin) -> FoundFaults {
    let (rows, columns) = skin.shape;
    let stds = match skin.touched.nrows() {
        0 => vec![0.0; skin.n_taxels()],
        _ => skin.touched.std_axis(Axis(0), 0.0).to_vec(),
    };
    let mut found = FoundFaults {
        faults: Vec::new(),
        is_sound: vec![true; stds.len()],
        n_known: 0,
    };
    for (taxel, std) in stds.iter().enumerate() {
        let (y, x) = (taxel / columns, taxel % columns);
        let around = |at: usize, n: usize| at.saturating_sub(2)..(at + 3).min(n);
        let mut near: Vec<f64> = around(y, rows)
            .flat_map(|y| around(x, columns).map(move |x| y * columns + x))
            .map(|other| stds[other])
            .collect();
        let usual = median(&mut near);
        if usual == 0.0 {
            continue;
        }
        found.n_known += 1;
        if *std < MOVES * usual {
            let level = median(&mut skin.touched.column(taxel).to_vec());
            found.is_sound[taxel] = false;
            found.faults.push(Fault {
                taxel,
                is_dead: level.abs() <= DEAD,
            });
        }
    }
    found
}

impl FoundFaults {
    /// Estimates the fraction of taxels with faults for which `is_counted` returns true. The Wilson interval refers to other skins of this type.
    ///
    /// # Errors
    /// If the state of half of the taxels is unknown.
    pub fn share(&self, is_counted: impl Fn(&Fault) -> bool) -> Estimate {
        let n_taxels = self.is_sound.len();
        if 2 * self.n_known < n_taxels {
            let n_still = n_taxels - self.n_known;
            return Err(NotIdentifiable(format!(
                "{n_still} of {n_taxels} taxels read the same in all frames, as if nothing had touched them"
            )));
        }
        let n = self.faults.iter().filter(|fault| is_counted(fault)).count();
        match Interval::wilson(n, self.n_known, 0.95) {
            Ok(Interval { low, high }) => Ok(Measured {
                value: n as f64 / self.n_known as f64,
                interval: [low, high],
            }),
            Err(error) => Err(NotIdentifiable(error.to_string())),
        }
    }
}
