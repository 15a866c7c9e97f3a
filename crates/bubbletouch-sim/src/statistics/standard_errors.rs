//! Bars of what is drawn: an estimate is held to so many of its standard errors, not to a number that somebody chose.

/// Standard errors that a drawn quantity may be off: one normal estimate in 1.7 million is off by more. Fewer: a test of thousands of estimates fails when
/// nothing is wrong; more: it finds less.
pub const STANDARD_ERRORS: f64 = 5.0;

/// An estimate is within [`STANDARD_ERRORS`] of what is expected.
#[track_caller]
pub fn assert_expected(what: &str, estimate: f64, expected: f64, standard_error: f64) {
    let off = (estimate - expected) / standard_error;
    assert!(
        off.abs() <= STANDARD_ERRORS,
        "{what}: {estimate} in place of {expected}, {off:.1} standard errors of {standard_error} off"
    );
}

/// An estimate is no lower than what is promised, or by no more than [`STANDARD_ERRORS`].
#[track_caller]
pub fn assert_at_least(what: &str, estimate: f64, promised: f64, standard_error: f64) {
    let below = (promised - estimate) / standard_error;
    assert!(
        below <= STANDARD_ERRORS,
        "{what}: {estimate}, {below:.1} standard errors of {standard_error} below {promised}"
    );
}

/// An estimate is no higher than what is promised, or by no more than [`STANDARD_ERRORS`].
#[track_caller]
pub fn assert_at_most(what: &str, estimate: f64, promised: f64, standard_error: f64) {
    assert_at_least(what, -estimate, -promised, standard_error);
}

/// The standard error of a share p of n independent draws: √(p(1 − p)/n).
pub fn of_share(p: f64, n: usize) -> f64 {
    (p * (1.0 - p) / n as f64).sqrt()
}

/// The standard error of the mean of n independent draws.
pub fn of_mean(std: f64, n: usize) -> f64 {
    std / (n as f64).sqrt()
}

/// The standard error of the standard deviation of n independent normal draws: σ/√(2(n − 1)).
pub fn of_std(std: f64, n: usize) -> f64 {
    std / (2.0 * (n as f64 - 1.0)).sqrt()
}

/// The standard error of the variance of n independent normal draws: σ²√(2/(n − 1)).
pub fn of_variance(variance: f64, n: usize) -> f64 {
    variance * (2.0 / (n as f64 - 1.0)).sqrt()
}

/// The mean and the standard deviation (by n − 1) of some numbers.
pub fn mean_and_std(of: &[f64]) -> (f64, f64) {
    let n = of.len() as f64;
    let mean = of.iter().sum::<f64>() / n;
    let squares: f64 = of.iter().map(|x| (x - mean).powi(2)).sum();
    (mean, (squares / (n - 1.0)).sqrt())
}
