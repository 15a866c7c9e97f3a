//! Frozen and quiet taxels: taxels that keep exactly one reading, or remain at rest apart from noise, for some time while the taxels on both sides are touched.
//!
//! A taxel between two touched taxels is usually touched, too, with a frequency q that depends on the class of the touch.
//!
//! - If a taxel works, it keeps exactly one reading during a run of m such frames with the probability (1 − q)ᵐ. The other frames give q. Readings at the upper
//!   end of the taxel's range are saturated, not frozen.
//! - Suppose that a taxel is at rest in k of n touches of a class, of which r form a run. If the taxel works, the order of the touches is random. The probability
//!   that a given run of r touches is at rest then equals C(n − r, k − r) / C(n, k). The product over the classes is multiplied by the number of places of the run.
//!   Successive touches of a class that belong to one unit, such as a grasp, count as one.

use crate::audit::surroundings::Surroundings;
use crate::statistics::quantile::quantile;
use ndarray::{ArrayView1, ArrayView2};
use statrs::function::factorial::ln_binomial;
use std::collections::BTreeMap;

/// Minimum number of frames of a run.
const MIN_RUN: usize = 10;
/// Minimum number of frames of a run in which the taxel lies between two touched taxels.
const MIN_BETWEEN: usize = 3;

/// Time during which a taxel keeps its reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrozenTaxel {
    /// Index of the taxel.
    pub taxel: usize,
    /// First frame of the run.
    pub first: usize,
    /// Number of frames of the run.
    pub n_frames: usize,
}

/// Frames in which taxels are searched that do not follow the contact.
#[derive(Clone, Copy)]
pub struct Searched<'a> {
    /// Frames as rows, in the order of recording.
    pub frames: ArrayView2<'a, f64>,
    /// Taxels that enclose each taxel.
    pub around: &'a Surroundings,
    /// Class of each frame.
    pub labels: &'a [usize],
    /// Number of the unit of each frame. Frames of one unit, such as a grasp, count as one observation, because their contacts are alike.
    pub units: &'a [usize],
    /// Reading above which a taxel is touched.
    pub touched: f64,
    /// Whether each taxel is searched; false for taxels that are constant in all frames.
    pub is_counted: &'a [bool],
    /// Probability of reporting any taxel that works.
    pub significance: f64,
}

impl Searched<'_> {
    /// Returns the frames in which a taxel is enclosed by touched taxels.
    fn enclosed(&self, taxel: usize) -> Vec<usize> {
        let sets = &self.around.enclosing[taxel];
        let is_enclosed = |&row: &usize| {
            let is_touched = |&other: &usize| self.frames[(row, other)] > self.touched;
            sets.iter().any(|set| set.iter().all(is_touched))
        };
        (0..self.frames.nrows()).filter(is_enclosed).collect()
    }

    fn taxels(&self) -> impl Iterator<Item = usize> {
        (0..self.frames.ncols()).filter(|&taxel| self.is_counted[taxel])
    }

    /// Returns the significant runs; each run has its log-probability.
    fn significant(&self, mut runs: Vec<(f64, FrozenTaxel)>, n_runs: usize) -> Vec<FrozenTaxel> {
        let bound = (self.significance / n_runs.max(1) as f64).ln();
        runs.retain(|(log_p, _)| *log_p <= bound);
        runs.into_iter().map(|(_, run)| run).collect()
    }
}

/// Finds taxels that keep exactly one reading for some time.
pub fn frozen_taxels(searched: &Searched) -> Vec<FrozenTaxel> {
    let mut runs = Vec::new();
    let mut n_runs = 0;
    for taxel in searched.taxels() {
        let enclosed = searched.enclosed(taxel);
        let readings = searched.frames.column(taxel);
        let largest = readings.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mut first = 0;
        for row in 1..=readings.len() {
            if row < readings.len() && readings[row] == readings[row - 1] {
                continue;
            }
            let run = std::mem::replace(&mut first, row)..row;
            if run.len() < MIN_RUN {
                continue;
            }
            n_runs += 1;
            let own = readings[run.start];
            let is_saturated = own == largest && own > searched.touched;
            let inside = [run.start, run.end].map(|end| enclosed.partition_point(|&row| row < end));
            if !is_saturated && inside[1] - inside[0] >= MIN_BETWEEN {
                let log_p = log_probability_frozen(readings, &enclosed, inside, searched.labels);
                let found = FrozenTaxel {
                    taxel,
                    first: run.start,
                    n_frames: run.len(),
                };
                runs.push((log_p, found));
            }
        }
    }
    searched.significant(runs, n_runs)
}

/// Finds taxels that remain at rest for some time, apart from noise, although the taxels around them are touched. At rest, a reading differs
/// by less than half of `touched` from the taxel's level in the tenth of the frames in which the taxels around it read least.
pub fn quiet_taxels(searched: &Searched) -> Vec<FrozenTaxel> {
    let mut runs = Vec::new();
    let mut n_runs = 0;
    for taxel in searched.taxels() {
        let enclosed = searched.enclosed(taxel);
        if enclosed.len() < 2 * MIN_BETWEEN {
            continue;
        }
        let readings = searched.frames.column(taxel);
        let level = level_at_rest(searched.frames, taxel, &searched.around.around[taxel]);
        let is_quiet = |&row: &usize| (readings[row] - level).abs() <= 0.5 * searched.touched;
        let is_quiet: Vec<bool> = enclosed.iter().map(is_quiet).collect();
        let mut first = 0;
        for place in 0..=enclosed.len() {
            if place < enclosed.len() && is_quiet[place] {
                continue;
            }
            let inside = [std::mem::replace(&mut first, place + 1), place];
            if inside[1] - inside[0] >= MIN_BETWEEN {
                n_runs += 1;
                let log_p = log_probability_quiet(searched, &enclosed, &is_quiet, inside);
                let found = FrozenTaxel {
                    taxel,
                    first: enclosed[inside[0]],
                    n_frames: enclosed[inside[1] - 1] + 1 - enclosed[inside[0]],
                };
                runs.push((log_p, found));
            }
        }
    }
    searched.significant(runs, n_runs)
}

/// Returns the median reading of a taxel in the tenth of the frames in which the sum of the taxels around it is least.
fn level_at_rest(frames: ArrayView2<f64>, taxel: usize, around: &[usize]) -> f64 {
    let sums = frames.rows().into_iter();
    let sums = sums.map(|frame| around.iter().map(|&near| frame[near]).sum());
    let sums: Vec<f64> = sums.collect();
    let n_rest = (sums.len() / 10).max(1);
    let mut order: Vec<usize> = (0..sums.len()).collect();
    order.select_nth_unstable_by(n_rest - 1, |&a, &b| {
        sums[a].total_cmp(&sums[b]).then(a.cmp(&b))
    });
    let own = order[..n_rest].iter().map(|&row| frames[(row, taxel)]);
    quantile(&mut own.collect::<Vec<_>>(), 0.5)
}

/// Returns the logarithm of the probability that a working taxel keeps its reading in the frames `enclosed[inside[0]..inside[1]]`. The frequency of this reading
/// follows from the other frames of each class; frames of a class without other frames do not count.
fn log_probability_frozen(
    readings: ArrayView1<f64>,
    enclosed: &[usize],
    inside: [usize; 2],
    labels: &[usize],
) -> f64 {
    let own = readings[enclosed[inside[0]]];
    let mut outside = BTreeMap::<usize, [f64; 2]>::new();
    for &row in enclosed[..inside[0]].iter().chain(&enclosed[inside[1]..]) {
        let [n, n_equal] = outside.entry(labels[row]).or_default();
        *n += 1.0;
        *n_equal += f64::from(u8::from(readings[row] == own));
    }
    let rows = enclosed[inside[0]..inside[1]].iter();
    let known = rows.filter_map(|&row| outside.get(&labels[row]));
    // Laplace's rule: the frequency as if there were one more frame of either kind.
    known
        .map(|[n, n_equal]| ((n_equal + 1.0) / (n + 2.0)).ln())
        .sum()
}

/// Returns the logarithm of the probability that all units at rest of a working taxel that lie in some run of this length do so by chance. `is_quiet` contains for
/// each enclosed frame whether the taxel is at rest. The run has the frames `enclosed[inside[0]..inside[1]]`.
fn log_probability_quiet(
    searched: &Searched,
    enclosed: &[usize],
    is_quiet: &[bool],
    inside: [usize; 2],
) -> f64 {
    // Successive frames of a class that belong to one unit: number of frames, how many of them are at rest, and how many lie in the run.
    let mut units = BTreeMap::<usize, Vec<(usize, [usize; 3])>>::new();
    for (place, &row) in enclosed.iter().enumerate() {
        let of_class = units.entry(searched.labels[row]).or_default();
        if of_class.last().map(|(unit, _)| *unit) != Some(searched.units[row]) {
            of_class.push((searched.units[row], [0; 3]));
        }
        if let Some((_, [n, n_quiet, n_inside])) = of_class.last_mut() {
            *n += 1;
            *n_quiet += usize::from(is_quiet[place]);
            *n_inside += usize::from((inside[0]..inside[1]).contains(&place));
        }
    }
    let mut n_places = 1;
    let mut log_p = 0.0;
    for of_class in units.into_values() {
        let n = of_class.len() as u64;
        let count = |index: usize| {
            let is_most = |(_, counts): &&(usize, [usize; 3])| 2 * counts[index] >= counts[0];
            of_class.iter().filter(is_most).count() as u64
        };
        let n_quiet = count(1);
        let n_inside = count(2).min(n_quiet);
        n_places += n - n_inside;
        log_p += ln_binomial(n - n_inside, n_quiet - n_inside) - ln_binomial(n, n_quiet);
    }
    (n_places as f64).ln() + log_p
}

/// Minimum fraction of its enclosed units in which a dead taxel is still, and maximum of this fraction over the other taxels.
const MIN_STILL: f64 = 0.9;
const MAX_STILL: f64 = 0.1;

/// Finds taxels that remain at rest, apart from noise, in all frames in which the taxels around them are touched. The frequency of rest in the units of each class
/// follows from the other taxels. Hollow objects have a taxel at rest between touched ones; therefore the taxel must be at rest in at least half of the classes
/// that enclose it, and in two of them.
pub fn always_quiet_taxels(searched: &Searched) -> Vec<usize> {
    // Number of enclosed units of each taxel by class, and how many of them are still.
    let counts = (0..searched.frames.ncols()).map(|taxel| match searched.is_counted[taxel] {
        true => still_units(searched, taxel),
        false => BTreeMap::new(),
    });
    let counts: Vec<BTreeMap<usize, [f64; 2]>> = counts.collect();
    let mut all = BTreeMap::<usize, [f64; 2]>::new();
    for (label, [n, n_still]) in counts.iter().flatten() {
        let of_class = all.entry(*label).or_default();
        of_class[0] += n;
        of_class[1] += n_still;
    }
    let bound = (searched.significance / counts.len().max(1) as f64).ln();
    let is_quiet = |own: &BTreeMap<usize, [f64; 2]>| {
        let of_class = own.iter().filter(|(_, [n, _])| *n >= MIN_BETWEEN as f64);
        let is_still = |(label, [n, n_still]): &(&usize, &[f64; 2])| {
            let [n_all, n_all_still] = all[label];
            let others = (n_all_still - n_still) / (n_all - n).max(1.0);
            *n_still >= MIN_STILL * n && others <= MAX_STILL && n_all > *n
        };
        let n_classes = of_class.clone().count();
        let still: Vec<_> = of_class.filter(is_still).collect();
        let log_p = still.iter().map(|(label, [n, n_still])| {
            let [n_all, n_all_still] = all[label];
            n_still * ((n_all_still - n_still + 1.0) / (n_all - n + 2.0)).ln()
        });
        still.len() > 1 && 2 * still.len() >= n_classes && log_p.sum::<f64>() <= bound
    };
    (0..counts.len())
        .filter(|&taxel| is_quiet(&counts[taxel]))
        .collect()
}

/// Returns for each class the number of units in which a taxel is enclosed by touched taxels, and the number of those in which it is at rest.
fn still_units(searched: &Searched, taxel: usize) -> BTreeMap<usize, [f64; 2]> {
    let enclosed = searched.enclosed(taxel);
    let readings = searched.frames.column(taxel);
    let mut units = BTreeMap::<(usize, usize), [usize; 2]>::new();
    if !enclosed.is_empty() {
        let level = level_at_rest(searched.frames, taxel, &searched.around.around[taxel]);
        for row in enclosed {
            let unit = (searched.labels[row], searched.units[row]);
            let [n, n_still] = units.entry(unit).or_default();
            *n += 1;
            *n_still += usize::from((readings[row] - level).abs() <= 0.5 * searched.touched);
        }
    }
    let mut classes = BTreeMap::<usize, [f64; 2]>::new();
    for ((label, _), [n, n_still]) in units {
        let of_class = classes.entry(label).or_default();
        of_class[0] += 1.0;
        of_class[1] += f64::from(u8::from(2 * n_still >= n));
    }
    classes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use ndarray::Array2;
    use rand::Rng;

    #[test]
    fn a_taxel_that_freezes_is_found_and_hollow_objects_are_no_fault() {
        let mut rng = Seed::new(5).named("frozen").rng();
        // Discs and rings without noise, sorted by class.
        let labels: Vec<usize> = (0..200).map(|row| row / 100).collect();
        let mut frames = Array2::zeros((200, 144));
        for (mut frame, label) in frames.rows_mut().into_iter().zip(&labels) {
            let (y, x) = (rng.gen_range(5.0..7.0), rng.gen_range(5.0..7.0));
            for (taxel, reading) in frame.iter_mut().enumerate() {
                let away: f64 = ((taxel / 12) as f64 - y).hypot((taxel % 12) as f64 - x);
                let is_touched = away < 3.5 && (*label == 0 || away > 1.5);
                *reading = if is_touched {
                    1.0 - 0.2 * (away - 2.0).abs()
                } else {
                    0.0
                };
            }
        }
        let around = Surroundings::of_grid((12, 12));
        let units: Vec<usize> = (0..200).collect();
        let searched = |frames: &Array2<f64>, search: fn(&Searched) -> Vec<FrozenTaxel>| {
            search(&Searched {
                frames: frames.view(),
                around: &around,
                labels: &labels,
                units: &units,
                touched: 0.1,
                is_counted: &[true; 144],
                significance: 0.01,
            })
        };
        let of = |frames: &Array2<f64>| searched(frames, frozen_taxels);
        assert!(searched(&frames, quiet_taxels).is_empty());
        let mut noisy = frames.clone();
        for row in 30..60 {
            noisy[(row, 78)] = 0.01 * rng.gen_range(-1.0..1.0);
        }
        assert!(of(&noisy).is_empty());
        let found = searched(&noisy, quiet_taxels);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].taxel, 78);
        assert!(found[0].first >= 30 && found[0].first + found[0].n_frames <= 60);
        // Discs of a third class: the taxel is at rest in two classes without holes.
        let (mut dead, mut classes) = (frames.clone(), labels.clone());
        (0..100).for_each(|row| classes[row] = row % 2);
        (100..200).for_each(|row| classes[row] = 2);
        for row in 0..200 {
            dead[(row, 78)] = 0.01 * rng.gen_range(-1.0..1.0);
        }
        let always = |frames: &Array2<f64>| {
            always_quiet_taxels(&Searched {
                frames: frames.view(),
                around: &around,
                labels: &classes,
                units: &units,
                touched: 0.1,
                is_counted: &[true; 144],
                significance: 0.01,
            })
        };
        assert_eq!(always(&dead), [78]);
        assert!(always(&frames).is_empty());
        assert!(of(&frames).is_empty(), "{:?}", of(&frames));
        for row in 30..60 {
            frames[(row, 78)] = 0.31;
        }
        let found = of(&frames);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(
            (found[0].taxel, found[0].first, found[0].n_frames),
            (78, 30, 30)
        );
    }
}
