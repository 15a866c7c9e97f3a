//! Measurement of median computing times.

use crate::quantile::quantile;
use std::time::Instant;

/// Calls `act` for each of `things` in sequence; returns the median wall-clock time of a call, seconds, or 0 without any call.
pub(super) fn median_s<T>(things: impl IntoIterator<Item = T>, mut act: impl FnMut(T)) -> f64 {
    let seconds = things.into_iter().map(|thing| {
        let start = Instant::now();
        act(thing);
        start.elapsed().as_secs_f64()
    });
    quantile(&mut seconds.collect::<Vec<_>>(), 0.5)
}
