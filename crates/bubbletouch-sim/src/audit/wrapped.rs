//! Integers that wrap around: readings beyond the largest integer continue at the smallest one, and readings below zero continue at the largest one.
//!
//! Both need readings over the whole range of integers of b bits. Two signs follow:
//!
//! - Beyond the largest integer: readings do not become rarer toward the largest integer, and a taxel enclosed by taxels near the largest integer reads less
//!   than them by more than half of the range. Hollow objects have such taxels, too, but about equally often if the enclosing taxels are near the middle.
//! - Below zero: noise at rest continues at the largest integers, above a gap to the readings in contact.

use crate::audit::surroundings::Surroundings;
use ndarray::ArrayView2;
use std::collections::BTreeSet;

/// Numbers of bits of converters and integers.
const BITS: [u32; 6] = [8, 10, 12, 14, 16, 32];
/// Minimum range of readings beyond the largest integer, and of readings below zero, as a fraction of the range of integers.
const MIN_RANGE: f64 = 0.98;
const WHOLE_RANGE: f64 = 0.999;
/// Least readings of enclosing taxels near the largest integer, and near the middle of the range, as fractions of the range.
const HIGH: f64 = 0.85;
const MIDDLE: [f64; 2] = [0.55, 0.75];
/// Minimum ratio of the frequencies of low readings between taxels near the largest integer and near the middle.
const MIN_RATIO: f64 = 3.0;
/// Width of the intervals in which readings are counted near the largest integer, as a fraction of the range. The last interval contains at least half as many
/// readings as the last but two, if readings continue beyond it.
const EDGE: f64 = 0.04;
/// Minimum number of frames with wrapped readings, and of enclosed readings near the middle of the range.
const MIN_FRAMES: usize = 3;
const MIN_ENCLOSED: usize = 20;
/// Minimum gap below readings that continue at the largest integers, as a fraction of the range.
const MIN_GAP: f64 = 0.2;
/// Minimum fractions of readings and of taxels above the gap, and minimum number of different readings.
const MIN_READINGS: f64 = 0.005;
const MIN_TAXELS: f64 = 0.1;
const MIN_VALUES: usize = 3;

/// Readings that wrap around.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrapped {
    /// Number of bits of the integers.
    pub bits: u32,
    /// Number of frames with wrapped readings.
    pub n_frames: usize,
    /// Whether readings below zero continue at the largest integer; otherwise readings above the largest integer continue at the smallest.
    pub is_below_zero: bool,
}

/// Finds integers that wrap around. `frames` contains integers. Taxels for which `is_counted` is false are omitted. `around` contains the taxels that enclose each
/// taxel; without it, only readings below zero are found.
pub fn wrapped(
    frames: ArrayView2<f64>,
    around: Option<&Surroundings>,
    is_counted: &[bool],
) -> Option<Wrapped> {
    let counted: Vec<usize> = (0..frames.ncols())
        .filter(|&taxel| is_counted[taxel])
        .collect();
    let columns = counted.iter().map(|&taxel| frames.column(taxel));
    let (least, largest) = columns.flatten().fold(
        (f64::INFINITY, f64::NEG_INFINITY),
        |(least, largest), &x| (least.min(x), largest.max(x)),
    );
    let range = largest - least;
    let bits = BITS
        .into_iter()
        .find(|&bits| range <= 2_f64.powi(bits as i32) - 1.0)?;
    let whole = 2_f64.powi(bits as i32) - 1.0;
    let is_end = [0.0, -2_f64.powi(bits as i32 - 1)]
        .into_iter()
        .any(|end| (least - end).abs() <= (1.0 - MIN_RANGE) * whole);
    if range < MIN_RANGE * whole || !is_end {
        return None;
    }
    if range >= WHOLE_RANGE * whole
        && let Some(n_frames) = below_zero(frames, &counted, (least, largest))
    {
        return Some(Wrapped {
            bits,
            n_frames,
            is_below_zero: true,
        });
    }
    let share = |low: f64, high: f64| {
        let bounds = least + low * range..=least + high * range;
        let columns = counted.iter().map(|&taxel| frames.column(taxel));
        columns.flatten().filter(|x| bounds.contains(*x)).count()
    };
    let [last, before] = [
        share(1.0 - EDGE, 1.0),
        share(1.0 - 3.0 * EDGE, 1.0 - 2.0 * EDGE),
    ];
    if last < MIN_ENCLOSED || 2 * last < before {
        return None;
    }
    let n_frames = above_largest(frames, &around?.enclosing, &counted, (least, range))?;
    Some(Wrapped {
        bits,
        n_frames,
        is_below_zero: false,
    })
}

/// Returns the number of frames with readings above a gap; `None` without a gap.
fn below_zero(
    frames: ArrayView2<f64>,
    counted: &[usize],
    (least, largest): (f64, f64),
) -> Option<usize> {
    let range = largest - least;
    let mut values: BTreeSet<i64> = BTreeSet::new();
    for &taxel in counted {
        let column = frames.column(taxel).into_iter();
        values.extend(
            column
                .filter(|&&x| x > least + 0.5 * range)
                .map(|&x| x as i64),
        );
    }
    // The uppermost gap ends at the first of the readings that continue at the largest integers.
    let descending: Vec<f64> = values.iter().rev().map(|&x| x as f64).collect();
    let is_gap = |pair: &[f64]| pair[0] - pair[1] >= MIN_GAP * range;
    let end = descending.windows(2).position(is_gap);
    let end = match end {
        Some(end) => end,
        None => {
            let lowest = descending.last()?;
            (lowest - least >= (0.5 + MIN_GAP) * range).then(|| descending.len() - 1)?
        }
    };
    let first = descending[end];
    let is_above = |taxel: &&usize| frames.column(**taxel).iter().any(|&x| x >= first);
    let n_taxels = counted.iter().filter(is_above).count();
    let n_above = |row: usize| {
        counted
            .iter()
            .filter(|&&t| frames[(row, t)] >= first)
            .count()
    };
    let of_frames: Vec<usize> = (0..frames.nrows()).map(n_above).collect();
    let share = of_frames.iter().sum::<usize>() as f64 / (counted.len() * frames.nrows()) as f64;
    let n_frames = of_frames.iter().filter(|&&n| n > 0).count();
    let is_wrapped = end + 1 >= MIN_VALUES
        && share >= MIN_READINGS
        && n_taxels as f64 >= MIN_TAXELS * counted.len() as f64
        && n_frames >= MIN_FRAMES;
    is_wrapped.then_some(n_frames)
}

/// Returns the number of frames in which taxels between taxels near the largest integer read less by half of the range; `None` if chance or hollow objects
/// explain them.
fn above_largest(
    frames: ArrayView2<f64>,
    enclosing: &[Vec<Vec<usize>>],
    counted: &[usize],
    (least, range): (f64, f64),
) -> Option<usize> {
    let [mut high, mut middle] = [[0_usize; 2]; 2];
    let mut n_frames = 0;
    for frame in frames.rows() {
        let before = high[1];
        for (taxel, set) in counted
            .iter()
            .flat_map(|&taxel| enclosing[taxel].iter().map(move |set| (taxel, set)))
        {
            let lowest = set.iter().map(|&other| frame[other]);
            let lowest = lowest.fold(f64::INFINITY, f64::min);
            let level = (lowest - least) / range;
            let is_low = usize::from(frame[taxel] < lowest - 0.5 * range);
            if level >= HIGH {
                high = [high[0] + 1, high[1] + is_low];
            } else if (MIDDLE[0]..MIDDLE[1]).contains(&level) {
                middle = [middle[0] + 1, middle[1] + is_low];
            }
        }
        n_frames += usize::from(high[1] > before);
    }
    // Laplace's rule for the frequency near the middle.
    let of_middle = (middle[1] + 1) as f64 / (middle[0] + 2) as f64;
    let of_high = high[1] as f64 / high[0].max(1) as f64;
    let is_wrapped =
        n_frames >= MIN_FRAMES && middle[0] >= MIN_ENCLOSED && of_high > MIN_RATIO * of_middle;
    is_wrapped.then_some(n_frames)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use ndarray::Array2;
    use rand::Rng;
    use rand_distr::StandardNormal;

    /// Rings, cones and discs with noise; the largest reading is about 1.
    fn frames() -> Array2<f64> {
        let mut rng = Seed::new(5).named("wrapped").rng();
        let mut frames = Array2::zeros((200, 144));
        for (row, mut frame) in frames.rows_mut().into_iter().enumerate() {
            let (y, x) = (rng.gen_range(3.0..8.0), rng.gen_range(3.0..8.0));
            let depth: f64 = rng.gen_range(0.3..1.0);
            for (taxel, reading) in frame.iter_mut().enumerate() {
                let away: f64 = ((taxel / 12) as f64 - y).hypot((taxel % 12) as f64 - x);
                let contact = match row % 3 {
                    0 if away < 0.8 => 0.0,
                    0 | 1 if away < 3.0 => depth - 0.08 * away,
                    _ => (depth - 0.25 * away).max(0.0),
                };
                *reading = contact + 0.01 * rng.sample::<f64, _>(StandardNormal);
            }
        }
        frames
    }

    #[test]
    fn integers_that_wrap_are_found_and_full_ranges_and_saturation_are_none() {
        let around = Surroundings::of_grid((12, 12));
        let of = |frames: Array2<f64>| wrapped(frames.view(), Some(&around), &[true; 144]);
        let scaled = |factor: f64| frames().mapv(|x| (factor * x + 8.0).round());
        let found = of(scaled(300.0).mapv(|x| x.rem_euclid(256.0))).unwrap();
        assert!(!found.is_below_zero && found.bits == 8 && found.n_frames > 20);
        let found = of(scaled(42_000.0).mapv(|x| (x + 32_768.0).rem_euclid(65_536.0) - 32_768.0));
        assert!(found.is_some_and(|found| found.bits == 16 && !found.is_below_zero));
        let found = of(frames().mapv(|x| (150.0 * x).round().rem_euclid(256.0))).unwrap();
        assert!(found.is_below_zero && found.n_frames > 150);
        assert_eq!(of(scaled(300.0).mapv(|x| x.clamp(0.0, 255.0))), None);
        let largest = frames().iter().copied().fold(0.0, f64::max);
        let full = frames().mapv(|x| (255.0 * (x / largest).max(0.0)).round());
        assert_eq!(of(full), None);
    }
}
