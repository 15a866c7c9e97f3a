//! Readings of taxels: constant ones, ones that are stuck for some time, ones that repeat another, and numbers that stand for missing readings.

use crate::audit::dependence::without_class_means;
use crate::statistics::quantile::quantile;
use ndarray::{Array1, ArrayView2, Axis};
use std::collections::{BTreeMap, BTreeSet};

/// Minimum number of readings of a level, or of frames in which a taxel leaves its median. With fewer, chance explains the finding.
const MIN_READINGS: usize = 20;

/// Statistics of the readings of a taxel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TaxelReadings {
    /// Mean reading.
    pub mean: f64,
    /// Standard deviation.
    pub std: f64,
    /// Smallest reading.
    pub least: f64,
    /// Largest reading.
    pub largest: f64,
    /// Median reading.
    pub median: f64,
}

impl TaxelReadings {
    /// Returns whether all readings are equal.
    pub fn is_constant(&self) -> bool {
        self.least >= self.largest
    }
}

/// Computes the statistics of each taxel over frames, shape (n, n_taxels), without missing readings.
pub fn taxel_readings(frames: ArrayView2<f64>) -> Vec<TaxelReadings> {
    let of_column = |column: ndarray::ArrayView1<f64>| {
        let mut readings = column.to_vec();
        let median = quantile(&mut readings, 0.5);
        TaxelReadings {
            mean: column.mean().unwrap_or(f64::NAN),
            std: column.std(0.0),
            least: readings.iter().copied().fold(f64::INFINITY, f64::min),
            largest: readings.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            median,
        }
    };
    frames.columns().into_iter().map(of_column).collect()
}

/// Returns the smallest difference of two different readings; 0 if all are equal.
pub fn smallest_step(frames: ArrayView2<f64>) -> f64 {
    let mut readings: Vec<f64> = frames.iter().copied().collect();
    readings.sort_unstable_by(f64::total_cmp);
    let gaps = readings.windows(2).map(|pair| pair[1] - pair[0]);
    let least = gaps.filter(|&gap| gap > 0.0).fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

/// Returns the distance of each row from the medians of the columns: the size of a touch.
pub fn sizes(rows: ArrayView2<f64>) -> Vec<f64> {
    let medians: Vec<f64> = rows
        .columns()
        .into_iter()
        .map(|column| quantile(&mut column.to_vec(), 0.5))
        .collect();
    let size = |row: ndarray::ArrayView1<f64>| {
        let squares = row
            .iter()
            .zip(&medians)
            .map(|(x, rest)| (x - rest) * (x - rest));
        squares.sum::<f64>().sqrt()
    };
    rows.rows().into_iter().map(size).collect()
}

/// Returns two numbers of each touch: its level, the median deviation of its taxels from their means over the class; and its contact, the logarithm of its size
/// less the mean over the class. `means` contains the mean frame of each touch.
pub fn levels(means: ArrayView2<f64>, labels: &[usize]) -> [Vec<f64>; 2] {
    let residuals = without_class_means(means, labels);
    let rows = residuals.rows().into_iter();
    let level = rows.map(|row| quantile(&mut row.to_vec(), 0.5)).collect();
    let sizes = sizes(means)
        .into_iter()
        .map(|size| (size + f64::MIN_POSITIVE).ln());
    let sizes = Array1::from_iter(sizes).insert_axis(Axis(1));
    let contact = without_class_means(sizes.view(), labels)
        .into_iter()
        .collect();
    [level, contact]
}

/// Returns the taxels whose readings are equal to those of a taxel before, or proportional after subtraction of a constant, in all frames. The taxels vary in at
/// least 20 frames.
pub fn equal_taxels(frames: ArrayView2<f64>, taxels: &[TaxelReadings]) -> Vec<usize> {
    let mut columns = Vec::new();
    for (taxel, readings) in taxels.iter().enumerate() {
        let column = frames.column(taxel);
        let is_away = |x: &&f64| **x != readings.median;
        if readings.std <= 0.0 || column.iter().filter(is_away).count() < MIN_READINGS {
            continue;
        }
        let own = column.mapv(|x| (x - readings.mean) / readings.std);
        // The first reading far from the mean is positive, so that a negative factor is found too.
        let sign = own
            .iter()
            .find(|x| x.abs() > 0.5)
            .map_or(1.0, |x| x.signum());
        columns.push((taxel, own * sign));
    }
    columns.sort_by(|a, b| a.1[0].total_cmp(&b.1[0]).then(a.0.cmp(&b.0)));
    let is_equal = |pair: &&[(usize, Array1<f64>)]| {
        let both = pair[0].1.iter().zip(&pair[1].1);
        both.into_iter().all(|(x, y)| (x - y).abs() < 1e-6)
    };
    let pairs = columns.windows(2).filter(is_equal);
    let repeated: BTreeSet<usize> = pairs.map(|pair| pair[0].0.max(pair[1].0)).collect();
    repeated.into_iter().collect()
}

/// Returns the taxels that keep one reading in all frames of a part of the recording, and rarely have this reading in the others. `parts` contains the part of
/// each frame, such as its session.
pub fn stuck_taxels(frames: ArrayView2<f64>, parts: &[usize]) -> Vec<usize> {
    let mut rows = BTreeMap::<usize, Vec<usize>>::new();
    (0..parts.len()).for_each(|row| rows.entry(parts[row]).or_default().push(row));
    rows.retain(|_, rows| rows.len() >= MIN_READINGS);
    let is_stuck = |taxel: &usize| {
        let column = frames.column(*taxel);
        rows.values().any(|rows| {
            let level = column[rows[0]];
            let n_others = column.len() - rows.len();
            let n_equal = || column.iter().filter(|&&x| x == level).count() - rows.len();
            rows.iter().all(|&row| column[row] == level)
                && n_others >= MIN_READINGS
                && 10 * n_equal() <= n_others
        })
    };
    (0..frames.ncols()).filter(is_stuck).collect()
}

/// Returns the value that stands for a missing reading, and its number of readings: the smallest or largest reading, if it is frequent, no taxel has it as its
/// median, and it is farther from all others than they are from each other.
pub fn placeholder(frames: ArrayView2<f64>, taxels: &[TaxelReadings]) -> Option<(f64, usize)> {
    let lowest = |from: f64| {
        frames
            .iter()
            .filter(|&&x| x > from)
            .fold(f64::INFINITY, |a, &x| a.min(x))
    };
    let highest = |to: f64| {
        frames
            .iter()
            .filter(|&&x| x < to)
            .fold(f64::NEG_INFINITY, |a, &x| a.max(x))
    };
    let count = |value: f64| frames.iter().filter(|&&x| x == value).count();
    let (first, last) = (lowest(f64::NEG_INFINITY), highest(f64::INFINITY));
    let (second, previous) = (lowest(first), highest(last));
    let of_ends = [
        (first, count(first), second - first, last - second),
        (last, count(last), last - previous, previous - first),
    ];
    let is_rest = |value: f64| taxels.iter().any(|taxel| taxel.median == value);
    let found = of_ends.into_iter().find(|&(value, n, gap, range)| {
        n >= MIN_READINGS / 4 && gap > 0.5 * range && range > 0.0 && !is_rest(value)
    });
    found.map(|(value, n, ..)| (value, n))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use ndarray::Array2;
    use rand::Rng;
    use rand_distr::StandardNormal;

    fn noise(n: usize, n_taxels: usize) -> Array2<f64> {
        let mut rng = Seed::new(9).named("taxels").rng();
        Array2::from_shape_simple_fn((n, n_taxels), || rng.sample(StandardNormal))
    }

    #[test]
    fn taxels_that_repeat_another_or_are_stuck_are_found_and_others_are_not() {
        let mut frames = noise(200, 8);
        let parts: Vec<usize> = (0..200).map(|row| row / 50).collect();
        let of = |frames: &Array2<f64>| equal_taxels(frames.view(), &taxel_readings(frames.view()));
        assert!(of(&frames).is_empty() && stuck_taxels(frames.view(), &parts).is_empty());
        let other = frames.column(2).mapv(|x| 5.0 - 3.0 * x);
        frames.column_mut(6).assign(&other);
        (50..100).for_each(|row| frames[(row, 4)] = 0.7);
        assert_eq!(of(&frames), [6]);
        assert_eq!(stuck_taxels(frames.view(), &parts), [4]);
    }

    #[test]
    fn a_placeholder_is_far_from_all_readings_and_a_reading_at_rest_is_none() {
        let mut frames = noise(100, 3).mapv(|x| 100.0 + 3.0 * x);
        let of = |frames: &Array2<f64>| placeholder(frames.view(), &taxel_readings(frames.view()));
        assert_eq!(of(&frames), None);
        (0..9).for_each(|row| frames[(11 * row, 1)] = -1.0);
        assert_eq!(of(&frames), Some((-1.0, 9)));
        let subtracted = Array2::from_shape_fn((100, 3), |(row, taxel)| {
            if row % 4 == 3 {
                50.0 + taxel as f64
            } else {
                0.0
            }
        });
        assert_eq!(of(&subtracted), None);
    }
}
