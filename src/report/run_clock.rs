//! Estimation of the elapsed and remaining time of a run from its number of finished work items.

use std::time::Instant;

/// Clock that measures the duration of a run and the number of its finished work items.
#[derive(Clone, Debug)]
pub struct RunClock {
    start: Instant,
    n_items: usize,
    n_finished: usize,
}

impl RunClock {
    /// Creates the clock of a run with `n_items` work items, and starts it.
    pub fn start(n_items: usize) -> Self {
        Self {
            start: Instant::now(),
            n_items,
            n_finished: 0,
        }
    }

    /// Adds one to the number of finished work items.
    pub fn item_finished(&mut self) {
        self.n_finished += 1;
    }

    /// Returns the number of finished work items and the number of all work items.
    pub fn counts(&self) -> (usize, usize) {
        (self.n_finished, self.n_items)
    }

    /// Returns the time from the start of the run to the instant `now`, s.
    pub fn elapsed_s(&self, now: Instant) -> f64 {
        now.duration_since(self.start).as_secs_f64()
    }

    /// Returns the estimated time until all work items are finished, s: mean time per finished item times number of pending items. Returns `None` if no item is
    /// finished.
    pub fn left_s(&self, now: Instant) -> Option<f64> {
        let n_pending = self.n_items.saturating_sub(self.n_finished);
        match (n_pending, self.n_finished) {
            (0, _) => Some(0.0),
            (_, 0) => None,
            (n_pending, n_finished) => {
                Some(self.elapsed_s(now) * n_pending as f64 / n_finished as f64)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn pending_items_are_assumed_to_take_as_long_as_finished_ones() {
        let mut clock = RunClock::start(4);
        let after = |clock: &RunClock, seconds| clock.start + Duration::from_secs(seconds);
        assert_eq!(clock.left_s(after(&clock, 3)), None);
        clock.item_finished();
        assert_eq!(clock.left_s(after(&clock, 5)), Some(15.0));
        (0..3).for_each(|_| clock.item_finished());
        assert_eq!(clock.left_s(after(&clock, 7)), Some(0.0));
        assert_eq!(clock.elapsed_s(after(&clock, 7)), 7.0);
        assert_eq!(RunClock::start(0).left_s(clock.start), Some(0.0));
    }
}
