//! Hot taxels: taxels that read a pressure, or strong noise, while the taxels around them are at rest.
//!
//! A taxel is compared with its neighbours in the tenth of the frames in which the sum of its neighbours is least. If the neighbours are at rest in these
//! frames, a working taxel is at rest too, because contact areas are connected. One neighbour may be hot itself.

use crate::statistics::quantile::{of_sorted, quantile};
use ndarray::ArrayView2;
use statrs::distribution::{ContinuousCDF, Normal};

/// Fraction of frames in which the neighbours are at rest.
const REST: f64 = 0.1;
/// Minimum excess of a hot taxel over the zero, as a fraction of the range of all readings. A smaller excess is an error of the zero, not a hot taxel.
const MIN_EXCESS: f64 = 0.05;
/// Median of the absolute value of a standard normal number.
const MEDIAN_OF_NORMAL: f64 = 0.6745;
/// Minimum ratio between the noise of a hot taxel and the median noise of all taxels.
const MIN_NOISE: f64 = 4.0;

/// Taxel that reads a pressure or strong noise while its neighbours are at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HotTaxel {
    /// Index of the taxel.
    pub taxel: usize,
    /// Reading above the neighbours' level in the frames in which they are at rest (median), in the unit of the frames.
    pub excess: f64,
    /// Interquartile range of the taxel in these frames, relative to the median over all taxels.
    pub noise_ratio: f64,
}

/// Finds hot taxels. `grid` is the shape of the skin; without it, neighbours are the adjacent taxels in the list. Taxels for which `is_sound` is false are
/// omitted.
pub fn hot_taxels(
    frames: ArrayView2<f64>,
    grid: Option<(usize, usize)>,
    is_sound: &[bool],
) -> Vec<HotTaxel> {
    let n_taxels = frames.ncols();
    let n_rest = ((REST * frames.nrows() as f64) as usize).max(5);
    if frames.nrows() < 4 * n_rest {
        return Vec::new();
    }
    let sound = (0..n_taxels).filter(|&taxel| is_sound[taxel]);
    let rested = sound.filter_map(|taxel| {
        let near = neighbours(taxel, n_taxels, grid);
        let near: Vec<usize> = near.into_iter().filter(|&near| is_sound[near]).collect();
        Rest::new(frames, taxel, &near, n_rest)
    });
    let rested: Vec<Rest> = rested.collect();
    // Zero of the skin: at least a quarter of the neighbourhoods is at rest in some frames.
    let zero = quantile(
        &mut rested
            .iter()
            .map(|rest| rest.near_level)
            .collect::<Vec<_>>(),
        0.25,
    );
    let spread = quantile(
        &mut rested.iter().map(|rest| rest.spread).collect::<Vec<_>>(),
        0.5,
    );
    let (least, largest) = frames.iter().fold(
        (f64::INFINITY, f64::NEG_INFINITY),
        |(least, largest), &x| (least.min(x), largest.max(x)),
    );
    let range = largest - least;
    let errors = Normal::standard().inverse_cdf(1.0 - 0.01 / n_taxels.max(1) as f64);
    // Levels at rest that differ from taxel to taxel are errors of the zero: the excess of a hot taxel exceeds the excesses of the others.
    let excess = rested.iter().map(|rest| rest.excess.abs());
    let scale = quantile(&mut excess.collect::<Vec<_>>(), 0.5) / MEDIAN_OF_NORMAL;
    let floor = (errors * spread.max(scale)).max(MIN_EXCESS * range);
    let hot = rested.into_iter().filter_map(|rest| {
        let noise_ratio = match spread > 0.0 {
            true => rest.spread / spread,
            false => f64::INFINITY,
        };
        // If most taxels at rest always read the same (events, coarse steps), the noise of the others has no common scale.
        let min_spread = if spread > 0.0 {
            0.2 * MIN_EXCESS
        } else {
            MIN_EXCESS
        };
        let is_noisy = noise_ratio > MIN_NOISE && rest.spread > min_spread * range;
        let is_hot = rest.near_level - zero <= 0.5 * floor && (rest.excess > floor || is_noisy);
        is_hot.then_some(HotTaxel {
            taxel: rest.taxel,
            excess: rest.excess,
            noise_ratio,
        })
    });
    hot.collect()
}

/// Readings of a taxel and of its neighbours in the frames in which the neighbours are at rest.
struct Rest {
    taxel: usize,
    excess: f64,
    /// Interquartile range of the taxel's readings.
    spread: f64,
    /// Second largest level of a neighbour. One neighbour may be hot, too.
    near_level: f64,
}

impl Rest {
    fn new(frames: ArrayView2<f64>, taxel: usize, near: &[usize], n_rest: usize) -> Option<Self> {
        if near.len() < 2 {
            return None;
        }
        let sums = frames.rows().into_iter();
        let sums = sums.map(|f| near.iter().map(|&near| f[near]).sum());
        let sums: Vec<f64> = sums.collect();
        let mut order: Vec<usize> = (0..sums.len()).collect();
        order.select_nth_unstable_by(n_rest - 1, |&a, &b| {
            sums[a].total_cmp(&sums[b]).then(a.cmp(&b))
        });
        order.truncate(n_rest);
        let of = |taxel: usize| -> Vec<f64> {
            order.iter().map(|&frame| frames[(frame, taxel)]).collect()
        };
        let mut own = of(taxel);
        let level = quantile(&mut own, 0.5);
        let spread = of_sorted(&own, 0.75) - of_sorted(&own, 0.25);
        let mut levels: Vec<f64> = near
            .iter()
            .map(|&near| quantile(&mut of(near), 0.5))
            .collect();
        let middle = quantile(&mut levels, 0.5);
        Some(Self {
            taxel,
            excess: level - middle,
            spread,
            near_level: levels[levels.len().saturating_sub(2)],
        })
    }
}

/// Returns the taxels beside a taxel: up to eight on a grid, up to two in a list.
fn neighbours(taxel: usize, n_taxels: usize, grid: Option<(usize, usize)>) -> Vec<usize> {
    let (rows, columns) = grid.unwrap_or((1, n_taxels));
    let (y, x) = (taxel / columns, taxel % columns);
    let around = |at: usize, n: usize| at.saturating_sub(1)..(at + 2).min(n);
    let near = around(y, rows).flat_map(|y| around(x, columns).map(move |x| y * columns + x));
    near.filter(|&near| near != taxel).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use ndarray::Array2;
    use rand::Rng;
    use rand_distr::StandardNormal;

    #[test]
    fn hot_and_noisy_taxels_are_found_among_touched_ones() {
        let mut rng = Seed::new(5).named("hot").rng();
        // A round contact of radius 2.5 at random places of a 10 × 10 skin.
        let mut frames = Array2::zeros((200, 100));
        for mut frame in frames.rows_mut() {
            let (y, x) = (rng.gen_range(0.0..9.0), rng.gen_range(0.0..9.0));
            for (taxel, reading) in frame.iter_mut().enumerate() {
                let away: f64 = ((taxel / 10) as f64 - y).hypot((taxel % 10) as f64 - x);
                let noise: f64 = rng.sample(StandardNormal);
                *reading = (1.0 - 0.4 * away).max(0.0) + 0.02 * noise;
            }
        }
        let sound = vec![true; 100];
        assert!(hot_taxels(frames.view(), Some((10, 10)), &sound).is_empty());
        frames.column_mut(34).mapv_inplace(|x| x + 0.3);
        frames
            .column_mut(77)
            .mapv_inplace(|x| x + 0.2 * rng.sample::<f64, _>(StandardNormal));
        let found = hot_taxels(frames.view(), Some((10, 10)), &sound);
        let found: Vec<usize> = found.iter().map(|hot| hot.taxel).collect();
        assert_eq!(found, [34, 77]);
    }
}
