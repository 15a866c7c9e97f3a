//! Levels of the readings, and counts of events.
//!
//! The number of levels of a taxel is its range of readings divided by the smallest difference of two readings, plus one. It does not depend on offsets and
//! factors of single taxels. Readings without a converter step differ by arbitrarily little, so that the number of levels is large.
//!
//! Counts of events have a variance of at least their mean (Poisson distribution; more if the rate varies). Rounding of a pressure adds a variance of 1/12
//! only. Three estimates of the variance exclude the differences between touches: half the mean squared difference between a touch and its nearest touch, which
//! is found by the other half of the taxels, the second difference of adjacent taxels of a row or column, and the median of the squared differences between a taxel
//! and the taxels that enclose it. Edges of contacts increase the first two, but not the median, because most taxels in contact are inside.

use crate::audit::surroundings::Surroundings;
use crate::statistics::quantile::quantile;
use ndarray::{Array2, ArrayView1, ArrayView2, Axis};

/// Largest difference between equal readings due to single precision, relative to the range.
const ROUNDING: f64 = 4e-7;
/// Maximum number of frames whose nearest frame is found.
const MAX_FRAMES: usize = 500;
/// Quantile of the taxels' means above which taxels count as active.
const ACTIVE: f64 = 0.7;
/// Minimum mean of counts inside a contact. The median of smaller counts depends on their steps and on the omission of taxels without events.
const MIN_MEAN: f64 = 6.0;
/// Minimum number of counts inside contacts.
const MIN_INSIDE: usize = 100;
/// Median of the square of a standard normal number.
const MEDIAN_OF_SQUARE: f64 = 0.455;

/// Returns the number of levels of a taxel's readings below `saturation`; infinite if readings have no common step within single precision.
pub fn n_levels(readings: ArrayView1<f64>, saturation: f64) -> f64 {
    let below = readings.iter().copied().filter(|&x| x < saturation);
    let mut sorted: Vec<f64> = below.collect();
    sorted.sort_by(f64::total_cmp);
    let (Some(first), Some(last)) = (sorted.first(), sorted.last()) else {
        return 1.0;
    };
    let range = last - first;
    let gaps = sorted.windows(2).map(|pair| pair[1] - pair[0]);
    let least = gaps.filter(|&gap| gap > ROUNDING * range);
    let least = least.fold(f64::INFINITY, f64::min);
    let n_repeats = sorted
        .windows(2)
        .filter(|pair| pair[1] - pair[0] <= ROUNDING * range)
        .count();
    match n_repeats {
        0 if range > 0.0 => f64::INFINITY,
        _ => 1.0 + (range / least).round(),
    }
}

/// Returns the ratio of variance and mean of counts: the smallest one of three estimates over active taxels. The ratio is at least 1 for counts
/// of events. Returns `None` if there are fewer than 20 frames, or no active taxels.
pub fn variance_to_mean(counts: ArrayView2<f64>, grid: Option<(usize, usize)>) -> Option<f64> {
    let step = counts.nrows().div_ceil(MAX_FRAMES).max(1);
    let rows: Vec<usize> = (0..counts.nrows()).step_by(step).collect();
    let counts = counts.select(Axis(0), &rows);
    let n = counts.nrows();
    if n < 20 {
        return None;
    }
    let means = counts.mean_axis(Axis(0))?;
    let least = quantile(&mut means.to_vec(), ACTIVE);
    let is_active = |taxel: usize| means[taxel] > 0.0 && means[taxel] >= least;
    let (even, odd): (Vec<usize>, Vec<usize>) =
        (0..counts.ncols()).partition(|taxel| taxel % 2 == 0);
    let mut ratios = Vec::new();
    for (seen, measured) in [(&even, &odd), (&odd, &even)] {
        let seen = counts.select(Axis(1), seen);
        let products: Array2<f64> = seen.dot(&seen.t());
        let nearest = (0..n).map(|row| {
            let distance =
                |other: &usize| products[(*other, *other)] - 2.0 * products[(row, *other)];
            let others = (0..n).filter(|&other| other != row);
            others.min_by(|a, b| distance(a).total_cmp(&distance(b)))
        });
        let nearest: Vec<usize> = nearest.map(|near| near.unwrap_or(0)).collect();
        for &taxel in measured.iter().filter(|&&taxel| is_active(taxel)) {
            let column = counts.column(taxel);
            let differences = nearest.iter().zip(column);
            let squares: f64 = differences
                .map(|(&near, own)| (column[near] - own).powi(2))
                .sum();
            ratios.push(squares / 2.0 / n as f64 / means[taxel]);
        }
    }
    if ratios.is_empty() {
        return None;
    }
    let between_touches = quantile(&mut ratios, 0.5);
    let of_grid = grid.and_then(|grid| second_differences(&counts, grid, is_active));
    let around = match grid {
        Some(grid) => Surroundings::of_grid(grid),
        None => Surroundings::of_list(counts.view()),
    };
    let inside = inside_contacts(&counts, &around.enclosing);
    let others = [of_grid, inside].into_iter().flatten();
    Some(others.fold(between_touches, f64::min))
}

/// Returns the ratio of variance and mean by the median squared difference between a taxel and the taxels that enclose it, where all of them count events. The
/// difference from the mean of k taxels has the variance (1 + 1/k) m for counts of mean m. Returns `None` for few such taxels.
fn inside_contacts(counts: &Array2<f64>, enclosing: &[Vec<Vec<usize>>]) -> Option<f64> {
    let mut ratios = Vec::new();
    for frame in counts.rows() {
        for (own, set) in frame
            .iter()
            .zip(enclosing)
            .flat_map(|(own, sets)| sets.iter().map(move |set| (own, set)))
        {
            let k = set.len() as f64;
            let mean = set.iter().map(|&other| frame[other]).sum::<f64>() / k;
            let is_inside = *own > 0.0 && set.iter().all(|&other| frame[other] > 0.0);
            if is_inside && mean >= MIN_MEAN {
                ratios.push((own - mean).powi(2) / ((1.0 + 1.0 / k) * mean));
            }
        }
    }
    (ratios.len() >= MIN_INSIDE).then(|| quantile(&mut ratios, 0.5) / MEDIAN_OF_SQUARE)
}

/// Returns the median over active taxels of the variance by second differences, relative to the mean of the taxel.
fn second_differences(
    counts: &Array2<f64>,
    (rows, columns): (usize, usize),
    is_active: impl Fn(usize) -> bool,
) -> Option<f64> {
    let mut ratios = Vec::new();
    for taxel in (0..rows * columns).filter(|&taxel| is_active(taxel)) {
        let (y, x) = (taxel / columns, taxel % columns);
        let pairs = [
            (x > 0 && x + 1 < columns).then(|| [taxel - 1, taxel + 1]),
            (y > 0 && y + 1 < rows).then(|| [taxel - columns, taxel + columns]),
        ];
        let own = counts.column(taxel);
        let variances = pairs.iter().flatten().map(|&[before, after]| {
            let (before, after) = (counts.column(before), counts.column(after));
            let squares = (0..own.len()).map(|frame| {
                let difference: f64 = 0.5 * (before[frame] + after[frame]) - own[frame];
                difference * difference
            });
            // The mean of two counts has half of their variance.
            squares.sum::<f64>() / own.len() as f64 / 1.5
        });
        let variance = variances.fold(f64::INFINITY, f64::min);
        if variance.is_finite() {
            ratios.push(variance / own.mean().unwrap_or(1.0));
        }
    }
    (!ratios.is_empty()).then(|| quantile(&mut ratios, 0.5))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use rand::Rng;
    use rand_distr::{Distribution, Poisson};

    /// Returns smooth contacts of at most `most` at random places of a 12 × 12 skin.
    fn contacts(most: f64) -> Array2<f64> {
        let mut rng = Seed::new(2).named("contacts").rng();
        let mut frames = Array2::zeros((300, 144));
        for mut frame in frames.rows_mut() {
            let (y, x) = (rng.gen_range(3.0..9.0), rng.gen_range(3.0..9.0));
            for (taxel, reading) in frame.iter_mut().enumerate() {
                let away: f64 = ((taxel / 12) as f64 - y).hypot((taxel % 12) as f64 - x);
                *reading = most * (1.0 - away / 4.0).max(0.0);
            }
        }
        frames
    }

    #[test]
    fn counts_vary_by_their_mean_and_rounded_pressures_do_not() {
        let mut rng = Seed::new(3).named("events").rng();
        for most in [2.0, 6.0, 20.0] {
            let rates = contacts(most);
            let counts = rates.mapv(|rate| Poisson::new(rate + 0.05).unwrap().sample(&mut rng));
            let ratio = variance_to_mean(counts.view(), Some((12, 12))).unwrap();
            assert!(ratio > 0.8, "{most}: {ratio}");
            let rounded = rates.mapv(f64::round);
            let ratio = variance_to_mean(rounded.view(), Some((12, 12))).unwrap();
            assert!(ratio < 0.6, "{most}: {ratio}");
        }
    }

    #[test]
    fn levels_do_not_depend_on_offset_and_factor() {
        let readings: ndarray::Array1<f64> =
            (0..200).map(|k| ((7 * k) % 16) as f64 / 15.0).collect();
        assert_eq!(n_levels(readings.view(), f64::INFINITY), 16.0);
        let scaled = readings.mapv(|x| 0.37 * x - 4.2);
        assert_eq!(n_levels(scaled.view(), f64::INFINITY), 16.0);
        let continuous: ndarray::Array1<f64> =
            (0..200).map(|k| (f64::from(k) * 0.7).sin()).collect();
        assert!(n_levels(continuous.view(), f64::INFINITY) > 1000.0);
    }
}
