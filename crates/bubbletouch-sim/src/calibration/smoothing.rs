//! Estimation of smoothing from the correlation of the noise of neighbours along rows and columns.
//!
//! Independent noise has the covariance S Sᵀ after a smoothing S. The mean correlation of neighbours increases with
//! the width, so the measured correlation determines the width. Only smoothing that acts after the noise is identifiable, not the effect of a soft cover.

use super::estimate::NONE;
use super::robust::jackknife;
use super::untouched::{Untouched, Zero};
use super::{Estimate, Measured, RecordedSkin};
use crate::signal::{Effect, Smoothing};
use crate::world::Grid;
use std::f64::consts::FRAC_PI_2;

/// Smallest width of the smoothing kernel, in taxel pitches. Smoothing with a smaller width has no effect, because the kernel extends less than half a pitch.
const NARROWEST: f64 = 0.125;
/// Number of bisection steps, which determine the width of the kernel to a billionth of the array's size.
const N_STEPS: usize = 40;

/// Statistics, averaged over the grid, of smoothed noise. The noise before smoothing is independent, with variance 1.
pub(super) struct Smoothed {
    /// Variance of the smoothed noise.
    pub variance: f64,
    /// Correlation of neighbouring taxels: mean product of their noise divided by their mean square. Frames are mirrored at edges, so edge taxels have more
    /// noise and fewer neighbours.
    pub correlation: f64,
}

impl Smoothed {
    /// Computes the statistics for smoothing with a width in pitches, on a grid.
    pub fn new((rows, columns): (usize, usize), width: f64) -> Self {
        let (y, x) = (Line::new(rows, width), Line::new(columns, width));
        let [along_x, along_y] = [(columns - 1) * rows, (rows - 1) * columns].map(|n| n as f64);
        let (along_x, along_y) = (along_x * y.own, along_y * x.own);
        let together = along_x * x.neighbours + along_y * y.neighbours;
        let alone = along_x * x.of_pairs + along_y * y.of_pairs;
        Self {
            variance: x.own * y.own,
            correlation: together / alone,
        }
    }
}

/// Statistics of independent noise of variance 1 after smoothing along a line of taxels.
struct Line {
    /// Mean noise variance of the taxels of the line.
    own: f64,
    /// Mean noise variance of the taxels that form neighbouring pairs.
    of_pairs: f64,
    /// Mean noise covariance of neighbouring taxels.
    neighbours: f64,
}

impl Line {
    fn new(n: usize, width: f64) -> Self {
        let grid = Grid {
            nx: n,
            ny: 1,
            pitch: 1.0,
        };
        let smoothing = Smoothing::new(width, &grid).expect("the width is within the array");
        let mut scratch = vec![0.0; smoothing.scratch_len()];
        let (mut own, mut of_pairs, mut neighbours) = (0.0, 0.0, 0.0);
        for impulse in 0..n {
            let mut response = vec![0.0; n];
            response[impulse] = 1.0;
            smoothing.apply_to_frame(&mut response, &mut scratch);
            own += response.iter().map(|r| r * r).sum::<f64>();
            for pair in response.windows(2) {
                of_pairs += 0.5 * (pair[0] * pair[0] + pair[1] * pair[1]);
                neighbours += pair[0] * pair[1];
            }
        }
        let n_pairs = (n.max(2) - 1) as f64;
        Self {
            own: own / n as f64,
            of_pairs: of_pairs / n_pairs,
            neighbours: neighbours / n_pairs,
        }
    }
}

/// Estimates the width of the smoothing kernel, in pitches.
pub(super) fn estimate(skin: &RecordedSkin, untouched: Option<&Untouched>) -> Estimate {
    let (rows, columns) = skin.shape;
    let untouched =
        untouched.ok_or("there are too few untouched frames to tell how noise is alike")?;
    if rows * columns < 4 {
        return Err("there are too few taxels".into());
    }
    let n_runs = untouched.runs.nrows();
    let rows_of = |keep: &dyn Fn(usize) -> bool| {
        let mut sums = Products::default();
        for taxel in (0..skin.n_taxels()).filter(|&taxel| keep(taxel)) {
            let right = (taxel % columns + 1 < columns).then_some(taxel + 1);
            let below = Some(taxel + columns).filter(|&below| below < skin.n_taxels());
            for other in [right, below].into_iter().flatten() {
                (0..n_runs).for_each(|run| sums.add(untouched, run, [taxel, other]));
            }
        }
        sums.correlation(untouched)
    };
    let correlation = jackknife(skin.n_taxels(), rows_of);
    let correlation = correlation.ok_or("untouched readings have no noise that is seen")?;
    let width = |correlation: f64| width_of(skin.shape, correlation);
    let [low, high] = correlation.interval;
    Ok(match low <= 0.0 {
        true => Measured {
            value: 0.0,
            interval: [0.0, width(high)],
        },
        false => correlation.map(width),
    })
}

/// Returns 0 if neighbours have at most a negligible correlation ([`NONE`]) at the upper end of the interval. Otherwise returns the width if its interval is
/// narrow; a wider estimate becomes not identifiable.
pub(super) fn narrow(width: Measured) -> Estimate {
    // The correlation of neighbours is exp(−1 / 4σ²) for a Gaussian of width σ.
    let as_good_as_none = (-0.25 / NONE.ln()).sqrt();
    match width.value == 0.0 && width.interval[1] <= as_good_as_none {
        true => Ok(width),
        false => width.resolved(),
    }
}

/// Sums of products and squares of the readings of neighbouring taxels.
#[derive(Default)]
struct Products {
    of_neighbours: f64,
    of_own: f64,
    n_pairs: f64,
}

impl Products {
    fn add(&mut self, untouched: &Untouched, run: usize, [a, b]: [usize; 2]) {
        let zeros = [a, b].map(|taxel| untouched.runs[(run, taxel)]);
        let readings = [a, b].map(|taxel| untouched.readings(taxel, run));
        let [of_a, of_b] = &readings;
        match zeros {
            [Zero::Clear(_), Zero::Clear(_)] if untouched.is_clear => {
                for frame in 1..of_a.len() {
                    let [a, b] = [of_a, of_b].map(|of| of[frame] - of[frame - 1]);
                    self.of_neighbours += a * b;
                    self.of_own += 0.5 * (a * a + b * b);
                    self.n_pairs += 1.0;
                }
            }
            // For clipped readings only the signs are used; products of such signs have the correlation 2/π asin ρ.
            [Zero::Clipped { .. }, Zero::Clipped { .. }] if !untouched.is_clear => {
                let share = |of: &ndarray::ArrayView1<f64>| {
                    of.iter().filter(|&&reading| reading > 0.0).count() as f64 / of.len() as f64
                };
                let (share_a, share_b) = (share(of_a), share(of_b));
                for (&a, &b) in of_a.iter().zip(of_b) {
                    let [a, b] = [(a, share_a), (b, share_b)]
                        .map(|(reading, share)| f64::from(u8::from(reading > 0.0)) - share);
                    self.of_neighbours += a * b;
                    self.of_own += 0.5 * (a * a + b * b);
                    self.n_pairs += 1.0;
                }
            }
            _ => {}
        }
    }

    fn correlation(&self, untouched: &Untouched) -> Option<f64> {
        // Rounding errors are independent from taxel to taxel.
        let rounding = match untouched.is_clear {
            true => self.n_pairs * untouched.step.powi(2) / 6.0,
            false => 0.0,
        };
        let own = self.of_own - rounding;
        let correlation = self.of_neighbours / own;
        (own > 0.25 * rounding && own > 0.0).then(|| match untouched.is_clear {
            true => correlation,
            false => (FRAC_PI_2 * correlation).sin(),
        })
    }
}

/// Returns the smoothing width for which neighbouring taxels have the given correlation; 0 if the smallest width already has a larger correlation.
fn width_of(shape: (usize, usize), correlation: f64) -> f64 {
    if correlation <= 0.0 {
        return 0.0;
    }
    let (mut low, mut high) = (NARROWEST, shape.0.max(shape.1) as f64);
    for _ in 0..N_STEPS {
        let middle = 0.5 * (low + high);
        match Smoothed::new(shape, middle).correlation < correlation {
            true => low = middle,
            false => high = middle,
        }
    }
    low
}
