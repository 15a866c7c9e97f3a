//! Correction of p-values for multiple tests.

/// Corrects the p-values of several tests, in input order (Holm, *A simple sequentially rejective multiple test procedure*, 1979). With the corrected values,
/// the probability of any false positive among all tests is at most the significance level.
pub fn holm(p_values: &[f64]) -> Vec<f64> {
    let n = p_values.len();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| p_values[a].total_cmp(&p_values[b]));
    let mut corrected = vec![0.0; n];
    let mut highest: f64 = 0.0;
    for (rank, &test) in order.iter().enumerate() {
        // A corrected p-value is at least the corrected p-value of every test with a smaller p-value.
        highest = highest.max(((n - rank) as f64 * p_values[test]).min(1.0));
        corrected[test] = highest;
    }
    corrected
}

/// Corrects the p-values of several tests with [`holm`]; missing p-values are ignored and stay `None`.
pub fn holm_of_some(p_values: &[Option<f64>]) -> Vec<Option<f64>> {
    let known: Vec<f64> = p_values.iter().flatten().copied().collect();
    let mut corrected = holm(&known).into_iter();
    let p_values = p_values.iter();
    p_values.map(|p| p.and_then(|_| corrected.next())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holms_correction_is_that_of_r() {
        // Expected values: p.adjust(c(0.01, 0.04, 0.03, 0.005, 0.6), "holm") in R. Each p is multiplied by the number of remaining tests, never falls, and is
        // at most 1.
        let corrected = holm(&[0.01, 0.04, 0.03, 0.005, 0.6]);
        for (value, expected) in corrected.iter().zip([0.04, 0.09, 0.09, 0.025, 0.6]) {
            assert!((value - expected).abs() < 1e-15, "{corrected:?}");
        }
        assert_eq!(holm(&[0.4, 0.9, 0.8]), [1.0, 1.0, 1.0]);
        assert!(holm(&[]).is_empty());
        let some = holm_of_some(&[None, Some(0.01), None, Some(0.03)]);
        assert_eq!(some, [None, Some(0.02), None, Some(0.03)]);
    }
}
