//! What something takes, by the clock.

use crate::quantile::quantile;
use std::time::Instant;

/// Median seconds of doing something to each of some things, one after the other; 0 of none.
pub(super) fn median_s<T>(things: impl IntoIterator<Item = T>, mut act: impl FnMut(T)) -> f64 {
    let seconds = things.into_iter().map(|thing| {
        let start = Instant::now();
        act(thing);
        start.elapsed().as_secs_f64()
    });
    quantile(&mut seconds.collect::<Vec<_>>(), 0.5)
}
