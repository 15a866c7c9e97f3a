//! Faults: taxels whose standard deviation over touched frames is below a tenth of the usual one of the 5 × 5 taxels around.
//!
//! One that stays at its zero is dead, one at another level stuck; of levels drawn evenly from all that a taxel can read, 1 % are taken for
//! dead. Where nothing ever moved nobody can tell.

use super::robust::median;
use super::{Estimate, RecordedSkin};
use crate::statistics::interval::Interval;
use ndarray::Axis;

/// Share of its neighbours' standard deviation that a taxel moves at least. Larger takes taxels of low gain for faults; smaller misses those with noise.
const MOVES: f64 = 0.1;
/// Level up to which a taxel that stays is dead, of the full scale.
const DEAD: f64 = 0.01;

/// A taxel that stays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// Which.
    pub taxel: usize,
    /// Whether it stays at its zero.
    pub is_dead: bool,
}

/// What is known of the taxels of a skin.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundFaults {
    /// Those at fault.
    pub faults: Vec<Fault>,
    /// Whether each taxel reads what it feels, as far as is known.
    pub is_sound: Vec<bool>,
    /// Taxels of which it is known.
    n_known: usize,
}

/// Finds them.
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
    /// The share of taxels that have one kind of fault, with Wilson's interval of other skins of the make.
    pub fn share(&self, is_counted: impl Fn(&Fault) -> bool) -> Estimate {
        let n_taxels = self.is_sound.len();
        if 2 * self.n_known < n_taxels {
            let n_still = n_taxels - self.n_known;
            return Estimate::unknown(format!(
                "{n_still} of {n_taxels} taxels read the same in all frames, as if nothing had touched them"
            ));
        }
        let n = self.faults.iter().filter(|fault| is_counted(fault)).count();
        match Interval::wilson(n, self.n_known, 0.95) {
            Ok(Interval { low, high }) => Estimate::Found {
                value: n as f64 / self.n_known as f64,
                interval: [low, high],
            },
            Err(error) => Estimate::unknown(error.to_string()),
        }
    }
}
