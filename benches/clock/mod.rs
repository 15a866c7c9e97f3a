//! Timing of calls that are too short to be timed once.

use std::time::{Duration, Instant};

/// Number of runs; each time is the median over them.
const REPEATS: usize = 15;

/// Returns the seconds per call: the median over runs of at least the duration `least`. In a test, one call is timed.
pub fn seconds(mut call: impl FnMut(), least: Duration, is_test: bool) -> f64 {
    let mut time = |n: u32| {
        let start = Instant::now();
        (0..n).for_each(|_| call());
        start.elapsed()
    };
    let mut n = 1;
    while time(n) < least && !is_test {
        n *= 2;
    }
    let repeats = if is_test { 1 } else { REPEATS };
    let mut times: Vec<f64> = (0..repeats)
        .map(|_| time(n).as_secs_f64() / f64::from(n))
        .collect();
    times.sort_by(f64::total_cmp);
    times[repeats / 2]
}
