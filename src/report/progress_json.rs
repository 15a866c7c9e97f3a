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
use std::sync::{Arc, Mutex, Once, Weak};
use std::thread;
use std::time::{Duration, Instant};

/// How often progress within a stage is told, whether there is any or not: a program that waits sees that the run lives.
const INTERVAL: Duration = Duration::from_millis(200);

/// One line an event, each written whole.
pub struct JsonLines<W: Write + Send> {
    told: Arc<Told<W>>,
}

/// What the threads of a run say, for one that passes it on.
struct Told<W> {
    state: Mutex<State<W>>,
    clock: RunClock,
    /// Once somebody passes it on.
    passed_on: Once,
}

struct State<W> {
    writer: W,
    stage: Option<Stage>,
}

struct Stage {
    total: u64,
    done: u64,
    start: Instant,
}

impl<W: Write + Send + 'static> JsonLines<W> {
    /// Lines go to this writer; that it fails does not stop the run.
    pub fn to(writer: W) -> Self {
        let state = State {
            writer,
            stage: None,
        };
        Self {
            told: Arc::new(Told {
                state: Mutex::new(state),
                clock: RunClock::default(),
                passed_on: Once::new(),
            }),
        }
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
}

/// Tells how far a run is, until it is over.
fn tell_now_and_then<W: Write>(told: &Weak<Told<W>>) {
    loop {
        thread::sleep(INTERVAL);
        let Some(told) = told.upgrade() else {
            return;
        };
        if let Ok(mut state) = told.state.lock() {
            state.tell_progress(&told.clock);
        }
    }
}

impl<W: Write + Send + 'static> Progress for JsonLines<W> {
    fn stage(&self, name: &str, total: u64) {
        if let Ok(mut state) = self.told.state.lock() {
            state.tell_progress(&self.told.clock);
            state.stage = Some(Stage {
                total,
                done: 0,
                start: Instant::now(),
            });
            state.write(&json!({ "event": "stage", "name": name, "total": total }));
        }
        self.told.passed_on.call_once(|| {
            let told = Arc::downgrade(&self.told);
            thread::spawn(move || tell_now_and_then(&told));
        });
    }

    fn advance(&self, n: u64) {
        if let Ok(mut state) = self.told.state.lock()
            && let Some(stage) = state.stage.as_mut()
        {
            stage.done += n;
        }
    }

    fn expect(&self, work: &[Piece]) {
        self.told.clock.expect(work);
    }

    fn worked(&self, piece: &Piece, took_s: f64) {
        self.told.clock.worked(piece, took_s);
    }

    fn finish(&self, message: &str) {
        if let Ok(mut state) = self.told.state.lock() {
            state.tell_progress(&self.told.clock);
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

    /// What was written, for whoever kept a copy.
    #[derive(Clone, Default)]
    struct Written(Arc<Mutex<Vec<u8>>>);

    impl Write for Written {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0.lock().unwrap().write(bytes)
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    impl Written {
        fn events(&self) -> Vec<Value> {
            let text = String::from_utf8(self.0.lock().unwrap().clone()).unwrap();
            let lines = text.lines();
            lines
                .map(|line| serde_json::from_str(line).unwrap())
                .collect()
        }
    }

    #[test]
    fn every_line_is_an_event_and_the_last_of_a_stage_says_all_of_it() {
        let written = Written::default();
        let lines = JsonLines::to(written.clone());
        lines.stage("simulate \"it\"", 10);
        lines.advance(4);
        lines.advance(6);
        lines.stage("learn", 3);
        lines.finish("done");
        let events = written.events();
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
        let written = Written::default();
        let lines = JsonLines::to(written.clone());
        let half = Piece::of_stage(0, 1.0);
        lines.expect(&[half, half]);
        lines.stage("learn", 1);
        lines.worked(&half, 1.0);
        lines.worked(&half, 1.0);
        thread::sleep(2 * INTERVAL);
        let events = written.events();
        let last = events.last().unwrap();
        assert!(events.len() >= 2, "{events:?}");
        assert_eq!(
            (&last["done"], &last["run_left_s"]),
            (&json!(0), &json!(0.0))
        );
    }

    #[test]
    fn a_stage_is_told_of_all_the_while_until_nobody_listens() {
        let written = Written::default();
        let lines = JsonLines::to(written.clone());
        let half = Piece::one_by_one(0, 100.0);
        lines.expect(&[half, half]);
        lines.stage("pack", 2);
        thread::sleep(5 * INTERVAL / 2);
        let silent = written.events();
        lines.worked(&half, half.spent_s(100.0));
        lines.advance(1);
        thread::sleep(2 * INTERVAL);
        drop(lines);
        thread::sleep(INTERVAL);
        let all = written.events();
        thread::sleep(2 * INTERVAL);
        assert_eq!(written.events().len(), all.len());

        assert!(silent.len() > 1 && all.len() > silent.len(), "{all:?}");
        let said = |events: &[Value], key: &str| events.last().unwrap()[key].as_f64().unwrap();
        assert_eq!(said(&silent, "done"), 0.0);
        let left_s = said(&silent, "run_left_s");
        assert!((190.0..200.0).contains(&left_s), "{left_s}");
        assert_eq!(said(&all, "done"), 1.0);
    }
}
