//! Hot taxels: taxels that read a pressure, or strong noise, while the taxels around them are at rest.
//!
//! A taxel is compared with its neighbours in the tenth of the frames in which the sum of its neighbours is least. If the neighbours are at rest in these
//! frames, a working taxel is at rest too, because contact areas are connected. One neighbour may be hot itself. In a list, a noisy taxel may have no neighbours,
//! because its readings are not correlated with others; its readings in all frames then count.

use crate::audit::surroundings::Surroundings;
use crate::statistics::quantile::{of_sorted, quantile};
use ndarray::{ArrayView2, Axis};
use statrs::distribution::{ContinuousCDF, Normal};

/// Fraction of frames in which the neighbours are at rest.
const REST: f64 = 0.1;
/// Minimum excess of a hot taxel over the zero, as a fraction of the range of all readings. A smaller excess is an error of the zero, not a hot taxel.
const MIN_EXCESS: f64 = 0.05;
/// Median of the absolute value of a standard normal number.
const MEDIAN_OF_NORMAL: f64 = 0.6745;
/// Minimum ratio between the noise of a hot taxel and the median noise of all taxels.
const MIN_NOISE: f64 = 4.0;
/// Number of readings at rest below which the minimum ratio grows like the error of a quartile, with the inverse root of their number.
const MIN_REST: f64 = 20.0;

/// Taxel that reads a pressure or strong noise while its neighbours are at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HotTaxel {
    /// Index of the taxel.
    pub taxel: usize,
    /// Reading above the neighbours' level in the frames in which they are at rest (median), in the unit of the frames.
    pub excess: f64,
    /// Interquartile range of the taxel in these frames, or twice its part below the median if this is less, relative to the median over all taxels.
    pub noise_ratio: f64,
}

/// Finds hot taxels. `around` contains the neighbours of each taxel. Taxels for which `is_sound` is false, and taxels with fewer than two neighbours, are
/// omitted. Contact must increase the readings.
pub fn hot_taxels(
    frames: ArrayView2<f64>,
    around: &Surroundings,
    is_sound: &[bool],
) -> Vec<HotTaxel> {
    let n_taxels = frames.ncols();
    let n_rest = ((REST * frames.nrows() as f64) as usize).max(5);
    if frames.nrows() < 4 * n_rest {
        return Vec::new();
    }
    let sound = (0..n_taxels).filter(|&taxel| is_sound[taxel]);
    let is_skin = are_neighbours_known(frames, around, is_sound);
    let rested = sound.filter_map(|taxel| {
        let near = around.around[taxel].iter().copied();
        let near: Vec<usize> = near.filter(|&near| is_sound[near]).collect();
        match near.len() {
            0 if is_skin => Some(Rest::alone(frames, taxel)),
            0 | 1 => None,
            _ => Some(Rest::new(frames, taxel, &near, n_rest)),
        }
    });
    let mut rested: Vec<Rest> = rested.collect();
    // Zero of the skin: at least a quarter of the neighbourhoods is at rest in some frames.
    let levels = rested.iter().filter_map(|rest| rest.near_level);
    let zero = quantile(&mut levels.collect::<Vec<_>>(), 0.25);
    for rest in rested.iter_mut().filter(|rest| rest.near_level.is_none()) {
        rest.excess -= zero;
    }
    let spread = quantile(
        &mut rested.iter().map(|rest| rest.spread).collect::<Vec<_>>(),
        0.5,
    );
    let steps = rested.iter().map(|rest| rest.step);
    let step = quantile(
        &mut steps.filter(|step| step.is_finite()).collect::<Vec<_>>(),
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
    // Medians and quartiles of readings with few levels are uncertain by one step.
    let floor = (errors * spread.max(scale))
        .max(MIN_EXCESS * range)
        .max(step);
    // Quartiles of few readings are uncertain.
    let min_noise = MIN_NOISE * (MIN_REST / n_rest as f64).sqrt().max(1.0);
    let hot = rested.into_iter().filter_map(|rest| {
        let scale = spread.max(step);
        let noise_ratio = match scale > 0.0 {
            true => rest.noise / scale,
            false => f64::INFINITY,
        };
        // If most taxels at rest always read the same (events, coarse steps), the noise of the others has no common scale.
        let min_spread = if spread > 0.0 {
            0.2 * MIN_EXCESS
        } else {
            MIN_EXCESS
        };
        let is_noisy = noise_ratio > min_noise && rest.noise > min_spread * range;
        let is_at_rest = rest
            .near_level
            .is_none_or(|near_level| near_level - zero <= 0.5 * floor);
        let is_hot = is_at_rest && (rest.excess > floor || is_noisy);
        is_hot.then_some(HotTaxel {
            taxel: rest.taxel,
            excess: rest.excess,
            noise_ratio,
        })
    });
    hot.collect()
}

/// Returns whether at least half of the active taxels have neighbours, as on a skin. Otherwise a taxel without neighbours may be the only one that reads some
/// contact.
fn are_neighbours_known(frames: ArrayView2<f64>, around: &Surroundings, is_sound: &[bool]) -> bool {
    let stds = frames.std_axis(Axis(0), 0.0);
    let active = 0.5 * quantile(&mut stds.to_vec(), 0.95);
    let active = (0..frames.ncols()).filter(|&taxel| is_sound[taxel] && stds[taxel] >= active);
    let has_near: Vec<bool> = active.map(|taxel| around.around[taxel].len() > 1).collect();
    2 * has_near.iter().filter(|&&has| has).count() >= has_near.len().max(1)
}

/// Readings of a taxel and of its neighbours in the frames in which the neighbours are at rest.
struct Rest {
    taxel: usize,
    /// Median reading above the neighbours' level; above 0 if the neighbours are unknown.
    excess: f64,
    /// Interquartile range of the taxel's readings.
    spread: f64,
    /// Interquartile range of the taxel's readings; twice its part below the median if this is less. Contact only increases the readings.
    noise: f64,
    /// Smallest difference of two readings of the taxel in all frames.
    step: f64,
    /// Second largest level of a neighbour. One neighbour may be hot, too. `None` if the neighbours are unknown.
    near_level: Option<f64>,
}

impl Rest {
    fn new(frames: ArrayView2<f64>, taxel: usize, near: &[usize], n_rest: usize) -> Self {
        let sums = frames.rows().into_iter();
        let sums = sums.map(|f| near.iter().map(|&near| f[near]).sum());
        let sums: Vec<f64> = sums.collect();
        let mut order: Vec<usize> = (0..sums.len()).collect();
        order.select_nth_unstable_by(n_rest - 1, |&a, &b| {
            sums[a].total_cmp(&sums[b]).then(a.cmp(&b))
        });
        order.truncate(n_rest);
        let mut levels: Vec<f64> = near
            .iter()
            .map(|&near| {
                let readings = order.iter().map(|&frame| frames[(frame, near)]);
                quantile(&mut readings.collect::<Vec<_>>(), 0.5)
            })
            .collect();
        let middle = quantile(&mut levels, 0.5);
        let near_level = Some(levels[levels.len().saturating_sub(2)]);
        Self::of_frames(frames, taxel, &order, (middle, near_level))
    }

    /// Returns the readings of a taxel without known neighbours in all frames.
    fn alone(frames: ArrayView2<f64>, taxel: usize) -> Self {
        let order: Vec<usize> = (0..frames.nrows()).collect();
        Self::of_frames(frames, taxel, &order, (0.0, None))
    }

    fn of_frames(
        frames: ArrayView2<f64>,
        taxel: usize,
        order: &[usize],
        (middle, near_level): (f64, Option<f64>),
    ) -> Self {
        let mut all = frames.column(taxel).to_vec();
        all.sort_by(f64::total_cmp);
        let gaps = all.windows(2).map(|pair| pair[1] - pair[0]);
        let step = gaps.filter(|&gap| gap > 0.0).fold(f64::INFINITY, f64::min);
        let own = order.iter().map(|&frame| frames[(frame, taxel)]);
        let mut own: Vec<f64> = own.collect();
        let level = quantile(&mut own, 0.5);
        let [low, high] = [0.25, 0.75].map(|share| of_sorted(&own, share));
        Self {
            taxel,
            excess: level - middle,
            spread: high - low,
            noise: match low == all[0] {
                // Readings are clipped below.
                true => high - low,
                false => (high - low).min(2.0 * (level - low)),
            },
            step,
            near_level,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use ndarray::Array2;
    use rand::Rng;
    use rand_distr::{Distribution, Poisson, StandardNormal};

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
        assert!(hot_taxels(frames.view(), &Surroundings::of_grid((10, 10)), &sound).is_empty());
        frames.column_mut(34).mapv_inplace(|x| x + 0.3);
        frames
            .column_mut(77)
            .mapv_inplace(|x| x + 0.2 * rng.sample::<f64, _>(StandardNormal));
        let found = hot_taxels(frames.view(), &Surroundings::of_grid((10, 10)), &sound);
        let found: Vec<usize> = found.iter().map(|hot| hot.taxel).collect();
        assert_eq!(found, [34, 77]);
        let in_list = Surroundings::of_list(frames.view());
        let found = hot_taxels(frames.view(), &in_list, &sound);
        let found: Vec<usize> = found.iter().map(|hot| hot.taxel).collect();
        assert_eq!(found, [34, 77]);
    }

    /// Counts of few events: quartiles of most taxels at rest are equal, and those of some differ by one event.
    #[test]
    fn counts_of_few_events_are_not_hot_and_a_taxel_that_counts_without_contact_is() {
        let mut rng = Seed::new(6).named("events").rng();
        let mut frames = Array2::zeros((250, 144));
        for mut frame in frames.rows_mut() {
            let (y, x) = (rng.gen_range(2.0..9.0), rng.gen_range(2.0..9.0));
            for (taxel, reading) in frame.iter_mut().enumerate() {
                let away: f64 = ((taxel / 12) as f64 - y).hypot((taxel % 12) as f64 - x);
                let rate = 8.0 * (1.0 - 0.25 * away).max(0.0) + 0.25;
                *reading = Poisson::new(rate).unwrap().sample(&mut rng);
            }
        }
        let around = Surroundings::of_grid((12, 12));
        let sound = vec![true; 144];
        assert!(hot_taxels(frames.view(), &around, &sound).is_empty());
        let more = Poisson::new(4.0).unwrap();
        frames
            .column_mut(66)
            .mapv_inplace(|x| x + more.sample(&mut rng));
        let found = hot_taxels(frames.view(), &around, &sound);
        assert_eq!(found.iter().map(|hot| hot.taxel).collect::<Vec<_>>(), [66]);
    }
}
