//! Progress as JSON lines, for programs that start a run.
//!
//! ```text
//! {"event":"stage","name":"recognise 32×32 at 2 mm","total":240}
//! {"event":"progress","done":96,"total":240,"elapsed_s":1.2,"run_elapsed_s":2.5,"run_left_s":3.1}
//! {"event":"message","text":"going on: 96 of 240 cells were finished before"}
//! ```

use crate::report::run_clock::RunClock;
use crate::study::progress::Progress;
use crate::study::time_left::Piece;
use serde_json::{Value, json};
use std::io::Write;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// How often progress within a stage is told, at most.
const INTERVAL: Duration = Duration::from_millis(200);

/// One line an event, each written whole.
pub struct JsonLines<W: Write + Send> {
    state: Mutex<State<W>>,
    clock: RunClock,
}

struct State<W> {
    writer: W,
    stage: Option<Stage>,
}

struct Stage {
    total: u64,
    done: u64,
    start: Instant,
    told: Instant,
}

impl<W: Write + Send> JsonLines<W> {
    /// Lines go to this writer; that it fails does not stop the run.
    pub fn to(writer: W) -> Self {
        let state = State {
            writer,
            stage: None,
        };
        Self {
            state: Mutex::new(state),
            clock: RunClock::default(),
        }
    }

    /// The writer, once nobody listens any more.
    pub fn into_inner(self) -> Option<W> {
        self.state.into_inner().ok().map(|state| state.writer)
    }
}

/// Seconds as they are told.
fn to_the_millisecond(s: f64) -> f64 {
    (s * 1e3).round() / 1e3
}

impl<W: Write> State<W> {
    fn write(&mut self, event: &Value) {
        let _ = writeln!(self.writer, "{event}").and_then(|()| self.writer.flush());
    }

    fn tell_progress(&mut self, clock: &RunClock) {
        if let Some(stage) = &self.stage {
            let mut event = json!({
                "event": "progress",
                "done": stage.done,
                "total": stage.total,
                "elapsed_s": to_the_millisecond(stage.start.elapsed().as_secs_f64()),
            });
            if let Some(times) = clock.times() {
                event["run_elapsed_s"] = to_the_millisecond(times.elapsed_s).into();
                event["run_left_s"] = to_the_millisecond(times.left_s).into();
            }
            self.write(&event);
        }
    }

    fn tell_progress_now_and_then(&mut self, clock: &RunClock) {
        if let Some(stage) = &mut self.stage
            && stage.told.elapsed() >= INTERVAL
        {
            stage.told = Instant::now();
            self.tell_progress(clock);
        }
    }
}

impl<W: Write + Send> Progress for JsonLines<W> {
    fn stage(&self, name: &str, total: u64) {
        if let Ok(mut state) = self.state.lock() {
            state.tell_progress(&self.clock);
            let now = Instant::now();
            state.stage = Some(Stage {
                total,
                done: 0,
                start: now,
                told: now,
            });
            state.write(&json!({ "event": "stage", "name": name, "total": total }));
        }
    }

    fn advance(&self, n: u64) {
        let Ok(mut state) = self.state.lock() else {
            return;
        };
        let Some(stage) = state.stage.as_mut() else {
            return;
        };
        stage.done += n;
        state.tell_progress_now_and_then(&self.clock);
    }

    fn expect(&self, work: &[Piece]) {
        self.clock.expect(work);
    }

    fn worked(&self, piece: &Piece, took_s: f64) {
        self.clock.worked(piece, took_s);
        if let Ok(mut state) = self.state.lock() {
            state.tell_progress_now_and_then(&self.clock);
        }
    }

    fn finish(&self, message: &str) {
        if let Ok(mut state) = self.state.lock() {
            state.tell_progress(&self.clock);
            state.stage = None;
            if !message.is_empty() {
                state.write(&json!({ "event": "message", "text": message }));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_is_an_event_and_the_last_of_a_stage_says_all_of_it() {
        let lines = JsonLines::to(Vec::new());
        lines.stage("simulate \"it\"", 10);
        lines.advance(4);
        lines.advance(6);
        lines.stage("learn", 3);
        lines.finish("done");
        let text = String::from_utf8(lines.into_inner().unwrap()).unwrap();
        let events: Vec<Value> = text
            .lines()
            .map(|line| serde_json::from_str(line).unwrap())
            .collect();
        assert_eq!(events[0]["name"], "simulate \"it\"");
        assert_eq!(
            (&events[1]["done"], &events[1]["total"]),
            (&json!(10), &json!(10))
        );
        assert_eq!(events[2]["event"], "stage");
        assert_eq!(events[3]["done"], 0);
        assert_eq!(events[4]["text"], "done");
    }

    #[test]
    fn a_long_piece_is_told_of_before_any_step_of_its_stage_is_done() {
        let lines = JsonLines::to(Vec::new());
        let half = Piece::of_stage(0, 0, 1.0);
        lines.expect(&[half, half]);
        lines.stage("learn", 1);
        lines.worked(&half, 1.0);
        std::thread::sleep(INTERVAL);
        lines.worked(&half, 1.0);
        let text = String::from_utf8(lines.into_inner().unwrap()).unwrap();
        let last: Value = serde_json::from_str(text.lines().last().unwrap()).unwrap();
        assert_eq!(text.lines().count(), 2);
        assert_eq!(
            (&last["done"], &last["run_left_s"]),
            (&json!(0), &json!(0.0))
        );
    }
}
