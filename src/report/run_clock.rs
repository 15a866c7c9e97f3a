//! How long a run has gone on, and how long it still takes.

use crate::study::time_left::{Piece, TimeLeft};
use std::time::Instant;

/// Starts when a run says what it will do.
#[derive(Debug)]
pub(super) struct RunClock {
    start: Instant,
    /// When work was last told of.
    told: Instant,
    left: TimeLeft,
}

/// Of the time in which nothing was told, the share that is left at least: what takes longer than planned is not over yet.
const OVERDUE: f64 = 0.2;

impl RunClock {
    /// See [`Progress::expect`](crate::study::progress::Progress::expect).
    pub fn expect(work: &[Piece]) -> Self {
        let now = Instant::now();
        Self {
            start: now,
            told: now,
            left: TimeLeft::new(work, rayon::current_num_threads()),
        }
    }

    /// See [`Progress::worked`](crate::study::progress::Progress::worked).
    pub fn worked(&mut self, piece: &Piece, took_s: f64) {
        self.told = Instant::now();
        self.left.worked(piece, took_s);
    }

    /// Seconds since the run said what it will do.
    pub fn elapsed_s(&self, now: Instant) -> f64 {
        now.duration_since(self.start).as_secs_f64()
    }

    /// Seconds until it ends: what was left when work was last told of runs down from then on.
    pub fn left_s(&self, now: Instant) -> f64 {
        let silent_s = now.duration_since(self.told).as_secs_f64();
        let left_s = self.left.left_s();
        (left_s - silent_s).max(OVERDUE * silent_s).min(left_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn what_is_left_runs_down_while_nothing_is_told_but_not_to_nothing() {
        let half = Piece::one_by_one(0, 10.0);
        let start = Instant::now();
        let after = |seconds: u64| start + Duration::from_secs(seconds);
        let mut running = RunClock {
            start,
            told: start,
            left: TimeLeft::new(&[half, half], rayon::current_num_threads()),
        };
        let left_s = |running: &RunClock, seconds| running.left_s(after(seconds));
        assert_eq!(left_s(&running, 0), 20.0);
        assert_eq!(left_s(&running, 8), 12.0);
        assert_eq!(left_s(&running, 30), 30.0 * OVERDUE);
        running.told = after(30);
        running.left.worked(&half, half.spent_s(30.0));
        let told_s = left_s(&running, 30);
        assert!(told_s > 20.0, "{told_s}");
        assert_eq!(left_s(&running, 35), told_s - 5.0);
        assert_eq!(running.elapsed_s(after(35)), 35.0);
    }
}
