//! Quantiles with linear interpolation: type 7 of Hyndman and Fan (American Statistician 50, 1996), NumPy's default.

/// Returns the quantile of the values at `part` (0 to 1), and sorts the values; returns 0 if there are none.
pub fn quantile(values: &mut [f64], part: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    values.sort_by(f64::total_cmp);
    of_sorted(values, part)
}

/// Returns the quantile of a non-empty sorted slice at `part` (0 to 1).
pub fn of_sorted(values: &[f64], part: f64) -> f64 {
    let place = part * (values.len() - 1) as f64;
    let below = place as usize;
    let above = (below + 1).min(values.len() - 1);
    values[below] + (place - below as f64) * (values[above] - values[below])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_or_between_them() {
        assert_eq!(quantile(&mut [3.0, 1.0, 2.0], 0.5), 2.0);
        assert_eq!(quantile(&mut [3.0, 1.0, 2.0], 1.0), 3.0);
        assert_eq!(quantile(&mut [1.0, 2.0], 0.25), 1.25);
        assert_eq!(quantile(&mut [], 0.5), 0.0);
    }
}
