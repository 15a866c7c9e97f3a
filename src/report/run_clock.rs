//! How long a run has gone on, and how long it still takes.

use crate::study::time_left::{Piece, TimeLeft};
use std::sync::Mutex;
use std::time::Instant;

/// Starts when a run says what it will do; runs that never say have no time left to tell.
#[derive(Debug, Default)]
pub struct RunClock {
    state: Mutex<Option<(Instant, TimeLeft)>>,
}

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
            let left = TimeLeft::new(work, rayon::current_num_threads());
            *state = Some((Instant::now(), left));
        }
    }

    /// See [`Progress::worked`](crate::study::progress::Progress::worked).
    pub fn worked(&self, piece: &Piece, took_s: f64) {
        if let Ok(mut state) = self.state.lock()
            && let Some((_, left)) = state.as_mut()
        {
            left.worked(piece, took_s);
        }
    }

    /// What it shows now.
    pub fn times(&self) -> Option<RunTimes> {
        let state = self.state.lock().ok()?;
        let (start, left) = state.as_ref()?;
        let elapsed_s = start.elapsed().as_secs_f64();
        Some(RunTimes {
            elapsed_s,
            left_s: left.left_s(elapsed_s),
        })
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
    use crate::study::time_left::Work;

    #[test]
    fn a_clock_knows_nothing_until_it_is_told_what_to_expect() {
        let clock = RunClock::default();
        let report = Piece {
            kind: Work::Report,
            place: 0,
            planned_s: 5.0,
        };
        clock.worked(&report, 1.0);
        assert_eq!(clock.times(), None);
        clock.expect(&[report]);
        assert_eq!(clock.times().map(|times| times.left_s), Some(5.0));
        clock.worked(&report, 3.0);
        assert_eq!(clock.times().map(|times| times.left_s), Some(0.0));
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
