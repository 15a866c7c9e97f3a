//! Tolerances for tests of random quantities, in standard errors of the estimate.

/// Allowed deviation of a random quantity in tests, in standard errors: one normal estimate in 1.7 million deviates more. If smaller, tests of thousands of
/// estimates fail by chance; if larger, tests detect fewer errors.
pub const STANDARD_ERRORS: f64 = 5.0;

/// Asserts that an estimate is within [`STANDARD_ERRORS`] standard errors of its expected value.
#[track_caller]
pub fn assert_expected(what: &str, estimate: f64, expected: f64, standard_error: f64) {
    let off = (estimate - expected) / standard_error;
    assert!(
        off.abs() <= STANDARD_ERRORS,
        "{what}: {estimate} in place of {expected}, {off:.1} standard errors of {standard_error} off"
    );
}

/// Asserts that an estimate is not below its bound by more than [`STANDARD_ERRORS`] standard errors.
#[track_caller]
pub fn assert_at_least(what: &str, estimate: f64, promised: f64, standard_error: f64) {
    let below = (promised - estimate) / standard_error;
    assert!(
        below <= STANDARD_ERRORS,
        "{what}: {estimate}, {below:.1} standard errors of {standard_error} below {promised}"
    );
}

/// Asserts that an estimate is not above its bound by more than [`STANDARD_ERRORS`] standard errors.
#[track_caller]
pub fn assert_at_most(what: &str, estimate: f64, promised: f64, standard_error: f64) {
    assert_at_least(what, -estimate, -promised, standard_error);
}

/// Returns the standard error of a proportion p of n independent draws: √(p(1 − p)/n).
pub fn of_share(p: f64, n: usize) -> f64 {
    (p * (1.0 - p) / n as f64).sqrt()
}

/// Returns the standard error of the mean of n independent draws.
pub fn of_mean(std: f64, n: usize) -> f64 {
    std / (n as f64).sqrt()
}

/// Returns the standard error of the standard deviation of n independent normal draws: σ/√(2(n − 1)).
pub fn of_std(std: f64, n: usize) -> f64 {
    std / (2.0 * (n as f64 - 1.0)).sqrt()
}

/// Returns the standard error of the variance of n independent normal draws: σ²√(2/(n − 1)).
pub fn of_variance(variance: f64, n: usize) -> f64 {
    variance * (2.0 / (n as f64 - 1.0)).sqrt()
}

/// Returns the mean and the standard deviation (divisor n − 1) of the numbers.
pub fn mean_and_std(of: &[f64]) -> (f64, f64) {
    let n = of.len() as f64;
    let mean = of.iter().sum::<f64>() / n;
    let squares: f64 = of.iter().map(|x| (x - mean).powi(2)).sum();
    (mean, (squares / (n - 1.0)).sqrt())
}
