//! Statistics of single taxels, and taxels that are never touched.
//!
//! The readings of an untouched taxel are noise around a level, which may depend on the class if the recordings are confounded. Contact is one-sided and
//! rare or strong. A taxel counts as untouched if its readings, less the mean of their class, fulfil all of the following conditions over n rows:
//!
//! - Skewness and excess kurtosis exceed the values of a normal distribution by at most five standard errors (√(6/n), √(24/n)). If readings are clipped at
//!   zero, a clipped normal distribution with an equal fraction of clipped readings replaces the normal distribution. This fraction must be 30 to 70 %, because
//!   contact in few rows resembles strongly clipped noise. If the noise may depend on the class, the condition is also fulfilled if residuals divided by the noise
//!   of their class fulfil it.
//! - The correlation with the sum of the more active taxels is within four standard errors (1/√n).
//! - The correlation with each of the more active taxels is at most 0.5 (six standard errors for few rows). Electrodes that read contact in both directions
//!   have a sum that hardly depends on the contact. If readings are clipped, the same holds for the taxels before and after the taxel: light contact that is
//!   cut at zero resembles clipped noise, but covers several taxels.
//! - The standard deviation is at most half the 95 % quantile of the standard deviations of the active taxels; a quarter if readings are clipped.
//!
//! With contact in a fraction p of rows and of A standard deviations of the noise, the excess kurtosis is about p A⁴ / (1 + p A²)². A single touch of ten
//! standard deviations in 1,000 rows is therefore found.

use crate::statistics::quantile::{of_sorted, quantile};
use ndarray::{Array1, Array2, ArrayView1, ArrayView2, Axis};
use statrs::distribution::{Continuous, ContinuousCDF, Normal};
use std::collections::BTreeMap;

/// Bound of skewness and kurtosis in standard errors. With 4,096 taxels, noise exceeds the bound at no taxel with a probability of 99.8 %.
const MOMENT_ERRORS: f64 = 5.0;
/// Bound of the correlation with the active taxels in standard errors.
const CORRELATION_ERRORS: f64 = 4.0;
/// Bound of the correlation with a single active taxel, and this bound in standard errors for few rows.
const SINGLE_CORRELATION: f64 = 0.5;
const SINGLE_CORRELATION_ERRORS: f64 = 6.0;
/// Maximum number of active taxels with which a taxel is correlated.
const MAX_COMPARED: usize = 256;
/// Maximum standard deviation of an untouched taxel, relative to active taxels.
const MAX_STD: f64 = 0.5;
/// Minimum correlation of the class means of two taxels in contact with the same object.
const ALIKE: f64 = 0.9;
/// Minimum fraction of a taxel's readings that equal its least reading, from which its readings count as clipped.
const CLIPPED: f64 = 0.05;
/// Fractions of clipped readings between which clipped noise can be distinguished from rare contact.
const CLIPPED_NOISE: [f64; 2] = [0.3, 0.7];
/// Maximum standard deviation of an untouched taxel with clipped readings, relative to active taxels.
const MAX_CLIPPED_STD: f64 = 0.25;

/// Minimum number of rows of each class from which the noise of the classes is compared. With fewer rows, errors of the noise resemble heavy tails.
const MIN_OF_CLASS: usize = 30;

/// Mean, spread and range of the readings of a taxel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TaxelReadings {
    /// Mean of all readings.
    pub mean: f64,
    /// Standard deviation of all readings.
    pub std: f64,
    /// Smallest reading.
    pub least: f64,
    /// Median of all readings.
    pub median: f64,
    /// Largest reading.
    pub largest: f64,
}

impl TaxelReadings {
    /// Returns whether all readings are equal.
    pub fn is_constant(&self) -> bool {
        self.least == self.largest
    }
}

/// Returns mean, spread and range of the readings of each taxel; frames are rows.
pub fn taxel_readings(frames: ArrayView2<f64>) -> Vec<TaxelReadings> {
    let n = frames.nrows().max(1) as f64;
    let empty = TaxelReadings {
        least: f64::INFINITY,
        largest: f64::NEG_INFINITY,
        ..TaxelReadings::default()
    };
    let mut all = vec![empty; frames.ncols()];
    for frame in frames.rows() {
        for (taxel, &reading) in all.iter_mut().zip(frame) {
            taxel.mean += reading / n;
            taxel.least = taxel.least.min(reading);
            taxel.largest = taxel.largest.max(reading);
        }
    }
    for frame in frames.rows() {
        for (taxel, &reading) in all.iter_mut().zip(frame) {
            taxel.std += (reading - taxel.mean).powi(2) / n;
        }
    }
    for (taxel, readings) in all.iter_mut().zip(frames.columns()) {
        taxel.std = match taxel.is_constant() {
            true => 0.0,
            false => taxel.std.sqrt(),
        };
        taxel.median = quantile(&mut readings.to_vec(), 0.5);
    }
    all
}

/// Returns readings with contact removed. Each reading is clipped at the taxel's median plus the distance from its 10 % quantile to its median. If fewer than
/// half of the rows have contact, readings of contact are clipped, while noise and changes of the level remain.
pub fn rest_readings(rows: ArrayView2<f64>) -> Array2<f64> {
    let mut rest = rows.to_owned();
    for mut readings in rest.columns_mut() {
        let mut sorted = readings.to_vec();
        let median = quantile(&mut sorted, 0.5);
        let most = 2.0 * median - of_sorted(&sorted, 0.1);
        readings.mapv_inplace(|reading| reading.min(most));
    }
    rest
}

/// Subtracts from each row the mean of the rows of its class.
pub fn without_class_means(rows: ArrayView2<f64>, labels: &[usize]) -> Array2<f64> {
    let n_classes = labels.iter().max().map_or(0, |largest| largest + 1);
    let mut means = Array2::<f64>::zeros((n_classes, rows.ncols()));
    let mut counts = vec![0.0; n_classes];
    for (row, &label) in rows.rows().into_iter().zip(labels) {
        let mut mean = means.row_mut(label);
        mean += &row;
        counts[label] += 1.0;
    }
    for (mut mean, count) in means.rows_mut().into_iter().zip(counts) {
        mean /= f64::max(count, 1.0);
    }
    let mut rest = rows.to_owned();
    for (mut row, &label) in rest.rows_mut().into_iter().zip(labels) {
        row -= &means.row(label);
    }
    rest
}

/// Returns for each taxel whether it is never touched.
///
/// `rows` are the readings, one row per touch, and the readings without the means of their classes ([`without_class_means`]). If the class
/// of each row is given in `labels`, the noise may depend on the class. This is for rows most of whose taxels are untouched: frequent light contact with one class
/// can resemble noise of this class. `contact` is a number per row that grows with the contact, such as the sum of the readings of the active taxels in this row. `active_std` is the standard deviation of active
/// taxels.
pub fn untouched_taxels(
    (rows, residuals): (ArrayView2<f64>, ArrayView2<f64>),
    labels: Option<&[usize]>,
    contact: &[f64],
    active_std: f64,
) -> Vec<bool> {
    let n = rows.nrows();
    let classes = labels.map_or_else(Vec::new, rows_of_large_classes);
    let contact = standardised(contact);
    let taxels = 0..rows.ncols();
    let mut is_untouched: Vec<bool> = taxels
        .map(|taxel| {
            let residuals = residuals.column(taxel);
            let std = (residuals.dot(&residuals) / n as f64).sqrt();
            if n < 8 || std > MAX_STD * active_std {
                return false;
            }
            if std == 0.0 {
                return true;
            }
            let readings = rows.column(taxel);
            let clipped = clipped_share(readings);
            let [least, most] = CLIPPED_NOISE;
            let is_clipped = clipped > CLIPPED;
            if is_clipped
                && (clipped < least || clipped > most || std > MAX_CLIPPED_STD * active_std)
            {
                return false;
            }
            let correlation = residuals.dot(&contact) / (n as f64 * std);
            let has_light_tails = || match is_clipped {
                true => has_light_tails(residuals, std, clipped),
                false => {
                    has_light_tails(residuals, std, 0.0)
                        || (with_equal_noise(residuals, &classes))
                            .is_some_and(|equal| has_light_tails(equal.view(), 1.0, 0.0))
                }
            };
            correlation.abs() * (n as f64).sqrt() <= CORRELATION_ERRORS && has_light_tails()
        })
        .collect();
    let found = (0..rows.ncols()).filter(|&taxel| is_untouched[taxel]);
    let found: Vec<usize> = found.collect();
    let bound = SINGLE_CORRELATION.max(SINGLE_CORRELATION_ERRORS / (n as f64).sqrt());
    let correlations = largest_correlations(residuals, &found, active_std);
    for (&taxel, correlation) in found.iter().zip(correlations) {
        let beside = |other: usize| {
            let [own, other] = [taxel, other].map(|taxel| residuals.column(taxel));
            let norm = (own.dot(&own) * other.dot(&other)).sqrt();
            norm == 0.0 || own.dot(&other).abs() <= bound * norm
        };
        is_untouched[taxel] = correlation <= bound
            && (clipped_share(rows.column(taxel)) <= CLIPPED
                || (taxel == 0 || beside(taxel - 1))
                    && (taxel + 1 == rows.ncols() || beside(taxel + 1)));
    }
    is_untouched
}

/// Returns for each taxel whether it is in constant contact with some classes, as below a flat object at equal depths. The class means of its readings differ
/// by more than half of the standard deviation of active taxels, and are correlated with the class means of a taxel beside it: contact covers several taxels,
/// while offsets of single taxels are independent.
pub fn constant_contact(
    rows: ArrayView2<f64>,
    labels: &[usize],
    grid: Option<(usize, usize)>,
    active_std: f64,
) -> Vec<bool> {
    let means = &rows - &without_class_means(rows, labels);
    let std = means.std_axis(Axis(0), 0.0);
    let centred = &means
        - &means
            .mean_axis(Axis(0))
            .unwrap_or_else(|| Array1::zeros(rows.ncols()));
    let range = |taxel: usize| {
        let ends = (f64::INFINITY, f64::NEG_INFINITY);
        let (least, largest) = means
            .column(taxel)
            .iter()
            .fold(ends, |(low, high), &x| (low.min(x), high.max(x)));
        largest - least
    };
    let columns = grid.map_or(rows.ncols(), |(_, columns)| columns);
    let is_alike = |taxel: usize, other: usize| {
        let covariance = centred.column(taxel).dot(&centred.column(other)) / rows.nrows() as f64;
        covariance > ALIKE * std[taxel] * std[other]
    };
    let taxels = 0..rows.ncols();
    taxels
        .map(|taxel| {
            let (y, x) = (taxel / columns, taxel % columns);
            let beside = [
                (x > 0).then(|| taxel - 1),
                (x + 1 < columns).then(|| taxel + 1),
                (y > 0).then(|| taxel - columns),
                (taxel + columns < rows.ncols()).then(|| taxel + columns),
            ];
            range(taxel) > MAX_STD * active_std
                && beside
                    .into_iter()
                    .flatten()
                    .any(|other| is_alike(taxel, other))
        })
        .collect()
}

/// Returns the largest absolute correlation of each of `taxels` with an active taxel.
fn largest_correlations(residuals: ArrayView2<f64>, taxels: &[usize], active_std: f64) -> Vec<f64> {
    let stds = residuals.std_axis(Axis(0), 0.0);
    let active = (0..residuals.ncols()).filter(|&taxel| stds[taxel] > MAX_STD * active_std);
    let active: Vec<usize> = active.collect();
    let step = active.len().div_ceil(MAX_COMPARED).max(1);
    let active: Vec<usize> = active.into_iter().step_by(step).collect();
    let of = |taxels: &[usize]| {
        let mut columns = residuals.select(Axis(1), taxels);
        for (mut column, &taxel) in columns.columns_mut().into_iter().zip(taxels) {
            column -= column.mean().unwrap_or(0.0);
            column /= f64::max(stds[taxel], f64::MIN_POSITIVE) * (residuals.nrows() as f64).sqrt();
        }
        columns
    };
    let correlations = of(taxels).t().dot(&of(&active));
    let largest = |row: ArrayView1<f64>| row.iter().fold(0.0, |most, x| f64::max(most, x.abs()));
    correlations.rows().into_iter().map(largest).collect()
}

/// Returns the 95 % quantile over taxels of the standard deviations of their readings.
pub fn active_std(residuals: ArrayView2<f64>) -> f64 {
    let mut stds = residuals.std_axis(Axis(0), 0.0).to_vec();
    quantile(&mut stds, 0.95)
}

/// Returns the sum of the readings of the active taxels of each row: taxels with at least half of the standard deviation `active_std`.
pub fn contact_sums(residuals: ArrayView2<f64>, active_std: f64) -> Vec<f64> {
    let stds = residuals.std_axis(Axis(0), 0.0);
    let is_active = stds.mapv(|std| if std > MAX_STD * active_std { 1.0 } else { 0.0 });
    residuals.dot(&is_active).to_vec()
}

fn standardised(values: &[f64]) -> Array1<f64> {
    let values = Array1::from_iter(values.iter().copied());
    let mean = values.mean().unwrap_or(0.0);
    let std = values.std(0.0);
    values.mapv(|x| if std > 0.0 { (x - mean) / std } else { 0.0 })
}

/// Returns the rows of each class, if each class has [`MIN_OF_CLASS`] rows; otherwise nothing.
fn rows_of_large_classes(labels: &[usize]) -> Vec<Vec<usize>> {
    let mut classes = BTreeMap::<usize, Vec<usize>>::new();
    for (row, &label) in labels.iter().enumerate() {
        classes.entry(label).or_default().push(row);
    }
    match classes.values().all(|rows| rows.len() >= MIN_OF_CLASS) {
        true => classes.into_values().collect(),
        false => Vec::new(),
    }
}

/// Returns residuals divided by the noise of their class, with standard deviation 1. The noise is the median of the absolute residuals, which contact in fewer
/// than half of the rows hardly changes. Returns `None` without classes, or if a class has no noise.
fn with_equal_noise(residuals: ArrayView1<f64>, classes: &[Vec<usize>]) -> Option<Array1<f64>> {
    let mut equal = residuals.to_owned();
    for rows in classes {
        let mut sizes: Vec<f64> = rows.iter().map(|&row| residuals[row].abs()).collect();
        let noise = quantile(&mut sizes, 0.5);
        if noise <= 0.0 {
            return None;
        }
        rows.iter().for_each(|&row| equal[row] /= noise);
    }
    let std = equal.std(0.0);
    (!classes.is_empty()).then(|| equal / std)
}

/// Returns the fraction of readings that equal the least reading.
fn clipped_share(readings: ArrayView1<f64>) -> f64 {
    let least = readings.iter().copied().fold(f64::INFINITY, f64::min);
    let n_clipped = readings.iter().filter(|&&x| x == least).count();
    n_clipped as f64 / readings.len() as f64
}

/// Returns whether skewness and kurtosis of residuals agree with a normal distribution of which the fraction `clipped` is clipped.
fn has_light_tails(residuals: ArrayView1<f64>, std: f64, clipped: f64) -> bool {
    let n = residuals.len() as f64;
    let moment = |power: i32| residuals.iter().map(|x| (x / std).powi(power)).sum::<f64>() / n;
    let [skewness, kurtosis] = match clipped > 0.0 {
        true => clipped_moments(clipped),
        false => [0.0, 0.0],
    };
    // The standard errors of the moments of a clipped normal distribution grow with its kurtosis.
    let errors = MOMENT_ERRORS * (1.0 + kurtosis.max(0.0));
    moment(3) <= skewness + errors * (6.0 / n).sqrt()
        && moment(4) - 3.0 <= kurtosis + errors * (24.0 / n).sqrt()
}

/// Returns skewness and excess kurtosis of max(t, Z) for a standard normal Z, where the fraction `clipped` of values equals t.
fn clipped_moments(clipped: f64) -> [f64; 2] {
    let normal = Normal::standard();
    let t = normal.inverse_cdf(clipped);
    let density = normal.pdf(t);
    // Moments of Z above t: E[Zᵏ; Z > t] = tᵏ⁻¹ φ(t) + (k − 1) E[Zᵏ⁻²; Z > t].
    let mut above = [1.0 - clipped, density, 0.0, 0.0, 0.0];
    for k in 2..5 {
        above[k] = t.powi(k as i32 - 1) * density + (k as f64 - 1.0) * above[k - 2];
    }
    let raw: Vec<f64> = (0..5)
        .map(|k| above[k] + clipped * t.powi(k as i32))
        .collect();
    let mean = raw[1];
    let variance = raw[2] - mean * mean;
    let third = raw[3] - 3.0 * mean * raw[2] + 2.0 * mean.powi(3);
    let fourth = raw[4] - 4.0 * mean * raw[3] + 6.0 * mean * mean * raw[2] - 3.0 * mean.powi(4);
    [
        third / variance.powf(1.5),
        fourth / (variance * variance) - 3.0,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use rand::Rng;
    use rand_distr::StandardNormal;

    #[test]
    fn clipped_moments_are_those_of_half_a_normal_distribution() {
        // max(0, Z): mean 1/√(2π), variance 1/2 − 1/(2π), third and fourth central moments by integration.
        let [skewness, kurtosis] = clipped_moments(0.5);
        assert!((skewness - 1.6406).abs() < 1e-3, "{skewness}");
        assert!((kurtosis - 2.4076).abs() < 1e-3, "{kurtosis}");
    }

    #[test]
    fn noise_offsets_and_clipping_are_untouched_and_rare_contact_is_not() {
        let mut rng = Seed::new(4).named("taxels").rng();
        let n = 400;
        let labels: Vec<usize> = (0..n).map(|row| row % 4).collect();
        let mut rows =
            Array2::from_shape_simple_fn((n, 6), || rng.sample::<f64, _>(StandardNormal));
        let touch: Vec<f64> = (0..n).map(|_| rng.r#gen()).collect();
        for (row, mut readings) in rows.rows_mut().into_iter().enumerate() {
            // The taxels contain noise, an offset of the class, clipped noise, three contacts, contact in each row, and strong contact, in this order.
            readings[1] += labels[row] as f64;
            readings[2] = readings[2].max(0.0);
            readings[3] += if row % 130 == 5 { 12.0 } else { 0.0 };
            readings[4] += 2.0 * touch[row];
            readings[5] = 20.0 * touch[row];
        }
        let residuals = without_class_means(rows.view(), &labels);
        let active = active_std(residuals.view());
        let contact = contact_sums(residuals.view(), active);
        let found = untouched_taxels(
            (rows.view(), residuals.view()),
            Some(&labels),
            &contact,
            active,
        );
        assert_eq!(found, [true, true, true, false, false, false]);
    }

    /// Electrodes whose readings rise with the contact and others whose readings fall: their sum does not depend on the contact.
    #[test]
    fn electrodes_that_read_contact_in_both_directions_are_touched() {
        let mut rng = Seed::new(6).named("electrodes").rng();
        let n = 500;
        let force: Vec<f64> = (0..n)
            .map(|_| rng.sample::<f64, _>(StandardNormal))
            .collect();
        let rows = Array2::from_shape_fn((n, 8), |(row, taxel)| {
            let gain = [3.0, -3.0, 2.0, -2.0, 0.5, -0.4, 0.0, 0.0][taxel];
            gain * force[row] + 0.3 * rng.sample::<f64, _>(StandardNormal)
        });
        let labels: Vec<usize> = (0..n).map(|row| row % 2).collect();
        let residuals = without_class_means(rows.view(), &labels);
        let active = active_std(residuals.view());
        let contact = contact_sums(residuals.view(), active);
        let found = untouched_taxels(
            (rows.view(), residuals.view()),
            Some(&labels),
            &contact,
            active,
        );
        let expected = [false, false, false, false, false, false, true, true];
        assert_eq!(found, expected);
    }
}
