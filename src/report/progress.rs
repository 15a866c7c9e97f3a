//! Progress: a bar on a terminal, a line a stage elsewhere, and JSON lines for programs that start a run.
//!
//! ```text
//! {"event":"stage","name":"recognise 32×32 at 2 mm","total":240}
//! {"event":"progress","done":96,"total":240,"elapsed_s":1.2,"run_elapsed_s":2.5,"run_left_s":3.1}
//! {"event":"message","text":"going on: 96 of 240 cells were finished before"}
//! ```

use crate::report::run_clock::RunClock;
use crate::spelling::duration;
use crate::study::progress::Progress;
use crate::study::time_left::Piece;
use serde_json::json;
use std::io::{IsTerminal, Write};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::thread;
use std::time::{Duration, Instant};

/// How often a stage is told of, whether it advances or not: who waits sees that the run lives.
const INTERVAL: Duration = Duration::from_millis(200);
/// Letters of a whole bar.
const BAR: usize = 32;

/// The listener that suits standard error: a bar, or plain lines if it is not a terminal.
pub fn to_stderr() -> Box<dyn Progress> {
    let is_dumb = std::env::var("TERM").is_ok_and(|term| term == "dumb");
    let form = match std::io::stderr().is_terminal() && !is_dumb {
        true => Form::Bar,
        false => Form::Lines,
    };
    Box::new(Told::to(form, std::io::stderr()))
}

/// The listener that writes an event a line; that the writer fails does not stop the run.
pub fn json_lines(writer: impl Write + Send + 'static) -> Box<dyn Progress> {
    Box::new(Told::to(Form::Json, writer))
}

/// What is made of what a run says.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    /// The stage with its rate, and the time left: of the whole run where it has said what it will do, else of the stage.
    Bar,
    /// A line when a stage ends.
    Lines,
    /// A line an event, each written whole.
    Json,
}

/// What the threads of a run say, for one that passes it on.
struct Told<W: Write>(Arc<Mutex<State<W>>>);

struct State<W: Write> {
    form: Form,
    writer: W,
    clock: Option<RunClock>,
    stage: Option<Stage>,
}

struct Stage {
    name: String,
    total: u64,
    done: u64,
    start: Instant,
}

impl<W: Write + Send + 'static> Told<W> {
    fn to(form: Form, writer: W) -> Self {
        let state = Arc::new(Mutex::new(State {
            form,
            writer,
            clock: None,
            stage: None,
        }));
        let told = Arc::downgrade(&state);
        thread::spawn(move || tell_now_and_then(&told));
        Self(state)
    }

    fn state(&self) -> MutexGuard<'_, State<W>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<W: Write + Send + 'static> Progress for Told<W> {
    fn stage(&self, name: &str, total: u64) {
        let mut state = self.state();
        state.end_stage();
        state.stage = Some(Stage {
            name: name.to_owned(),
            total,
            done: 0,
            start: Instant::now(),
        });
        if state.form == Form::Json {
            state.write(&json!({ "event": "stage", "name": name, "total": total }));
        }
    }

    fn advance(&self, n: u64) {
        if let Some(stage) = self.state().stage.as_mut() {
            stage.done += n;
        }
    }

    fn expect(&self, work: &[Piece]) {
        self.state().clock = Some(RunClock::expect(work));
    }

    fn worked(&self, piece: &Piece, took_s: f64) {
        if let Some(clock) = self.state().clock.as_mut() {
            clock.worked(piece, took_s);
        }
    }

    fn finish(&self, message: &str) {
        let mut state = self.state();
        state.end_stage();
        match (message.is_empty(), state.form) {
            (true, _) => {}
            (false, Form::Json) => state.write(&json!({ "event": "message", "text": message })),
            (false, Form::Bar | Form::Lines) => state.write(&message),
        }
    }
}

/// Tells how far a run is, until it is over.
fn tell_now_and_then<W: Write>(told: &Weak<Mutex<State<W>>>) {
    loop {
        thread::sleep(INTERVAL);
        let Some(told) = told.upgrade() else {
            return;
        };
        told.lock().unwrap_or_else(PoisonError::into_inner).tell();
    }
}

impl<W: Write> State<W> {
    fn write(&mut self, line: &impl std::fmt::Display) {
        self.write_whole(&format!("{line}\n"));
    }

    /// At once, so that nobody reads a part. A closed standard error must not end a run.
    fn write_whole(&mut self, text: &str) {
        let written = self.writer.write_all(text.as_bytes());
        let _ = written.and_then(|()| self.writer.flush());
    }

    /// Where the stage is now.
    fn tell(&mut self) {
        let Some(stage) = &self.stage else {
            return;
        };
        let now = Instant::now();
        match self.form {
            Form::Lines => {}
            Form::Json => {
                let mut event = json!({
                    "event": "progress",
                    "done": stage.done,
                    "total": stage.total,
                    "elapsed_s": to_the_millisecond(stage.seconds()),
                });
                if let Some(clock) = &self.clock {
                    event["run_elapsed_s"] = to_the_millisecond(clock.elapsed_s(now)).into();
                    event["run_left_s"] = to_the_millisecond(clock.left_s(now)).into();
                }
                self.write(&event);
            }
            Form::Bar => {
                let width = usize::from(console::Term::stderr().size().1);
                let bar = stage.bar(self.clock.as_ref().map(|clock| clock.left_s(now)));
                let shown: String = bar.chars().take(width.saturating_sub(1)).collect();
                self.write_whole(&format!("\r{shown}\x1b[K"));
            }
        }
    }

    /// Leaves the last that is to be said of a stage.
    fn end_stage(&mut self) {
        if self.form == Form::Json {
            self.tell();
        }
        self.clear();
        if let (Some(stage), Form::Bar | Form::Lines) = (self.stage.take(), self.form) {
            let Stage { name, done, .. } = &stage;
            self.write(&format!("{name:>14}: {done} in {:.1} s", stage.seconds()));
        }
    }

    /// Takes the bar away.
    fn clear(&mut self) {
        if self.form == Form::Bar && self.stage.is_some() {
            self.write_whole("\r\x1b[K");
        }
    }
}

impl<W: Write> Drop for State<W> {
    fn drop(&mut self) {
        self.clear();
    }
}

impl Stage {
    fn seconds(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    fn bar(&self, run_left_s: Option<f64>) -> String {
        let Self {
            name, total, done, ..
        } = self;
        let rate = *done as f64 / self.seconds().max(1e-9);
        let full = (BAR as u64 * done / (*total).max(1)).min(BAR as u64) as usize;
        let bar = "=".repeat(full) + if full < BAR { ">" } else { "" };
        let left = match run_left_s {
            Some(left_s) => format!("{} left", duration(left_s)),
            None if *done == 0 => "no rate yet".to_owned(),
            None => {
                let left_s = total.saturating_sub(*done) as f64 / rate;
                format!("{} left of this stage", duration(left_s))
            }
        };
        format!("{name:>14} [{bar:BAR$}] {done}/{total}, {rate:.2}/s, {left}")
    }
}

/// Seconds as they are told.
fn to_the_millisecond(s: f64) -> f64 {
    (s * 1e3).round() / 1e3
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;

    #[test]
    fn lines_name_each_stage_once_with_what_it_did() {
        let written = Written::default();
        let lines = Told::to(Form::Lines, written.clone());
        lines.stage("simulate", 10);
        lines.advance(4);
        lines.advance(6);
        lines.stage("learn", 3);
        lines.advance(3);
        lines.finish("done: results/quickstart");
        let text = written.text();
        let said: Vec<&str> = text.lines().collect();
        assert_eq!(said.len(), 3);
        assert!(said[0].contains("simulate: 10 in"), "{text}");
        assert!(said[1].contains("learn: 3 in"), "{text}");
        assert_eq!(said[2], "done: results/quickstart");
    }

    #[test]
    fn a_bar_says_how_far_a_stage_is_and_leaves_a_line_of_it() {
        let written = Written::default();
        let bar = Told::to(Form::Bar, written.clone());
        bar.stage("simulate", 4);
        bar.advance(1);
        thread::sleep(2 * INTERVAL);
        let shown = written.text();
        assert!(shown.contains("simulate [========>  "), "{shown}");
        assert!(shown.contains("] 1/4, "), "{shown}");
        assert!(shown.contains(" left o"), "{shown}");
        bar.finish("");
        let text = written.text();
        assert!(text.contains("\r\x1b[K      simulate: 1 in 0."), "{text}");
        drop(bar);
        assert_eq!(written.text(), text);
    }

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
        fn text(&self) -> String {
            String::from_utf8(self.0.lock().unwrap().clone()).unwrap()
        }

        fn events(&self) -> Vec<Value> {
            let text = self.text();
            let lines = text.lines();
            lines
                .map(|line| serde_json::from_str(line).unwrap())
                .collect()
        }
    }

    #[test]
    fn every_line_is_an_event_and_the_last_of_a_stage_says_all_of_it() {
        let written = Written::default();
        let lines = Told::to(Form::Json, written.clone());
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
        let lines = Told::to(Form::Json, written.clone());
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
        let lines = Told::to(Form::Json, written.clone());
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
