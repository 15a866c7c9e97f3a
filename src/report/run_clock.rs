//! How long a run has gone on, and how long it still takes.

use crate::study::time_left::{Piece, TimeLeft};
use std::sync::Mutex;
use std::time::Instant;

/// Starts when a run says what it will do; runs that never say have no time left to tell.
#[derive(Debug, Default)]
pub struct RunClock {
    state: Mutex<Option<Running>>,
}

#[derive(Debug)]
struct Running {
    start: Instant,
    /// When work was last told of.
    told: Instant,
    left: TimeLeft,
}

/// Of the time in which nothing was told, the share that is left at least: what takes longer than planned is not over yet.
const OVERDUE: f64 = 0.2;

/// What the clock shows, seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunTimes {
    /// Since the run said what it will do.
    pub elapsed_s: f64,
    /// Until it ends.
    pub left_s: f64,
}

impl RunClock {
    /// See [`Progress::expect`](crate::study::progress::Progress::expect).
    pub fn expect(&self, work: &[Piece]) {
        if let Ok(mut state) = self.state.lock() {
            let now = Instant::now();
            *state = Some(Running {
                start: now,
                told: now,
                left: TimeLeft::new(work, rayon::current_num_threads()),
            });
        }
    }

    /// See [`Progress::worked`](crate::study::progress::Progress::worked).
    pub fn worked(&self, piece: &Piece, took_s: f64) {
        if let Ok(mut state) = self.state.lock()
            && let Some(running) = state.as_mut()
        {
            running.told = Instant::now();
            running.left.worked(piece, took_s);
        }
    }

    /// What it shows now.
    pub fn times(&self) -> Option<RunTimes> {
        let state = self.state.lock().ok()?;
        state.as_ref().map(|running| running.at(Instant::now()))
    }
}

impl Running {
    /// What was left when work was last told of runs down from then on.
    fn at(&self, now: Instant) -> RunTimes {
        let silent_s = now.duration_since(self.told).as_secs_f64();
        let elapsed_s = now.duration_since(self.start).as_secs_f64();
        let left_s = self.left.left_s();
        let runs_down_s = (left_s - silent_s).max(OVERDUE * silent_s);
        RunTimes {
            elapsed_s,
            left_s: runs_down_s.min(left_s),
        }
    }
}

/// `about 3 min`: no more digits than an estimate has.
pub fn in_words(seconds: f64) -> String {
    match seconds {
        s if s < 1.0 => "under 1 s".to_owned(),
        s if s < 99.5 => format!("{s:.0} s"),
        s if s < 5970.0 => format!("{:.0} min", s / 60.0),
        s if s < 172_800.0 => format!("{:.1} h", s / 3600.0),
        s => format!("{:.1} days", s / 86_400.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn a_clock_knows_nothing_until_it_is_told_what_to_expect() {
        let clock = RunClock::default();
        let report = Piece::one_by_one(0, 5.0);
        clock.worked(&report, 1.0);
        assert_eq!(clock.times(), None);
        clock.expect(&[report]);
        let left_s = clock.times().unwrap().left_s;
        assert!((4.0..=5.0).contains(&left_s), "{left_s}");
        clock.worked(&report, report.spent_s(3.0));
        assert_eq!(clock.times().map(|times| times.left_s), Some(0.0));
    }

    #[test]
    fn what_is_left_runs_down_while_nothing_is_told_but_not_to_nothing() {
        let half = Piece::one_by_one(0, 10.0);
        let start = Instant::now();
        let after = |seconds: u64| start + Duration::from_secs(seconds);
        let mut running = Running {
            start,
            told: start,
            left: TimeLeft::new(&[half, half], rayon::current_num_threads()),
        };
        let left_s = |running: &Running, seconds| running.at(after(seconds)).left_s;
        assert_eq!(left_s(&running, 0), 20.0);
        assert_eq!(left_s(&running, 8), 12.0);
        assert_eq!(left_s(&running, 30), 30.0 * OVERDUE);
        running.told = after(30);
        running.left.worked(&half, half.spent_s(30.0));
        let told_s = left_s(&running, 30);
        assert!(told_s > 20.0, "{told_s}");
        assert_eq!(left_s(&running, 35), told_s - 5.0);
        assert_eq!(running.at(after(35)).elapsed_s, 35.0);
    }

    #[test]
    fn times_are_written_with_as_many_digits_as_they_deserve() {
        let words = [0.2, 1.0, 42.4, 99.6, 600.0, 7200.0, 259_200.0].map(in_words);
        let expected = [
            "under 1 s",
            "1 s",
            "42 s",
            "2 min",
            "10 min",
            "2.0 h",
            "3.0 days",
        ];
        assert_eq!(words, expected);
    }
}
