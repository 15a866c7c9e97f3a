//! Progress of a run: one line with a bar on a terminal, plain lines for other outputs, and JSON lines for other programs.
//!
//! ```text
//! {"event":"stage","name":"recognise 32×32 at 2 mm","total":240}
//! {"event":"progress","done":96,"total":240,"elapsed_s":1.2,"run_elapsed_s":2.5,"run_left_s":3.1}
//! {"event":"message","text":"going on: 96 of 240 work items were finished before"}
//! ```

use crate::engine::progress::Progress;
use crate::spelling::duration;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use serde_json::json;
use std::io::{IsTerminal, Write};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::time::{Duration, Instant};
use std::{fmt, thread};

/// Time between two progress reports, even if nothing has changed. With a larger value, reports are delayed; with a smaller value, more lines are written.
const INTERVAL: Duration = Duration::from_millis(200);

/// Layout of a progress bar's line, in the notation of the library indicatif.
const BAR: &str = "{prefix:>14} [{bar:24}] {pos}/{len}, {rate}, {left}{msg}";

/// Creates the progress listener that writes to standard error: a bar on a terminal, otherwise plain lines.
pub fn to_stderr() -> Box<dyn Progress> {
    let is_dumb = std::env::var("TERM").is_ok_and(|term| term == "dumb");
    match std::io::stderr().is_terminal() && !is_dumb {
        true => Box::new(Bar::new(ProgressDrawTarget::stderr())),
        false => Box::new(Events::new(Form::Lines, std::io::stderr())),
    }
}

/// Creates a progress listener that writes one JSON event per line. A failing writer does not stop the run.
pub fn json_lines(writer: impl Write + Send + 'static) -> Box<dyn Progress> {
    Box::new(Events::new(Form::Json, writer))
}

/// Stage of a run, such as the training of classifiers.
pub struct Stage {
    /// Name of the stage.
    pub name: String,
    /// Number of steps of the stage.
    pub total: u64,
    /// Number of finished steps.
    pub done: u64,
    start: Instant,
}

impl Stage {
    fn seconds(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    /// Returns the line that describes the finished stage and remains on the terminal.
    fn summary(&self) -> String {
        let Self { name, done, .. } = self;
        format!("{name:>14}: {done} in {:.1} s", self.seconds())
    }
}

/// State of a run: its current stage, and the number of its finished work items.
#[derive(Default)]
pub struct RunState {
    /// Current stage; `None` before the first one.
    pub stage: Option<Stage>,
    /// Clock of the run; `None` until the number of its work items is known.
    pub clock: Option<RunClock>,
}

/// Progress listener that keeps the state of a run and writes nothing.
impl Progress for Mutex<RunState> {
    fn stage(&self, name: &str, total: u64) {
        locked(self).stage = Some(Stage {
            name: name.to_owned(),
            total,
            done: 0,
            start: Instant::now(),
        });
    }

    fn advance(&self, n: u64) {
        if let Some(stage) = &mut locked(self).stage {
            stage.done += n;
        }
    }

    fn expect(&self, n_items: usize) {
        locked(self).clock = Some(RunClock::start(n_items));
    }

    fn item_finished(&self) {
        if let Some(clock) = &mut locked(self).clock {
            clock.item_finished();
        }
    }

    fn finish(&self, _message: &str) {}
}

/// Locks a mutex, also after a panic of another thread.
pub(crate) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Progress bar on a terminal: one line with the current stage and the number of finished work items.
struct Bar {
    bar: ProgressBar,
    clock: Mutex<RunClock>,
}

impl Bar {
    fn new(target: ProgressDrawTarget) -> Self {
        let style = ProgressStyle::with_template(BAR).expect("a valid template");
        let style = style.progress_chars("=> ").with_key("rate", write_rate);
        let style = style.with_key("left", write_left);
        Self {
            bar: ProgressBar::with_draw_target(Some(0), target).with_style(style),
            clock: Mutex::new(RunClock::start(0)),
        }
    }
}

impl Progress for Bar {
    fn stage(&self, name: &str, total: u64) {
        self.bar.set_prefix(name.to_owned());
        self.bar.set_length(total);
        self.bar.reset();
        self.bar.enable_steady_tick(INTERVAL);
    }

    fn advance(&self, n: u64) {
        self.bar.inc(n);
    }

    fn expect(&self, n_items: usize) {
        *locked(&self.clock) = RunClock::start(n_items);
    }

    fn item_finished(&self) {
        let mut clock = locked(&self.clock);
        clock.item_finished();
        let (done, all) = clock.counts();
        self.bar
            .set_message(format!("; {done} of {all} work items"));
    }

    fn finish(&self, message: &str) {
        self.bar.finish_and_clear();
        if !message.is_empty() {
            self.bar.println(message);
        }
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// Writes the number of steps per second of a progress bar.
fn write_rate(state: &ProgressState, text: &mut dyn fmt::Write) {
    // Writing to the text of a bar cannot fail.
    let _ = write!(text, "{:.2}/s", state.per_sec());
}

/// Writes the estimated remaining time of a progress bar.
fn write_left(state: &ProgressState, text: &mut dyn fmt::Write) {
    let _ = match state.pos() {
        0 => write!(text, "no rate yet"),
        _ => write!(text, "{} left", duration(state.eta().as_secs_f64())),
    };
}

/// Format of progress output that is not shown as bars.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    /// One line at the end of each stage.
    Lines,
    /// One JSON line for each event.
    Json,
}

/// Progress listener that writes plain lines or JSON events. All threads of a run share its output.
struct Events<W: Write>(Arc<Output<W>>);

struct Output<W: Write> {
    form: Form,
    run: Mutex<RunState>,
    writer: Mutex<W>,
}

impl<W: Write + Send + 'static> Events<W> {
    fn new(form: Form, writer: W) -> Self {
        let output = Arc::new(Output {
            form,
            run: Mutex::default(),
            writer: Mutex::new(writer),
        });
        if form == Form::Json {
            let output = Arc::downgrade(&output);
            thread::spawn(move || report_regularly(&output));
        }
        Self(output)
    }
}

impl<W: Write + Send + 'static> Progress for Events<W> {
    fn stage(&self, name: &str, total: u64) {
        self.0.end_stage();
        // No progress of the stage is written before its start.
        if self.0.form == Form::Json {
            let event = json!({ "event": "stage", "name": name, "total": total });
            self.0.write(&event);
        }
        self.0.run.stage(name, total);
    }

    fn advance(&self, n: u64) {
        self.0.run.advance(n);
    }

    fn expect(&self, n_items: usize) {
        self.0.run.expect(n_items);
    }

    fn item_finished(&self) {
        self.0.run.item_finished();
    }

    fn finish(&self, message: &str) {
        self.0.end_stage();
        match (message.is_empty(), self.0.form) {
            (true, _) => {}
            (false, Form::Json) => self
                .0
                .write(&json!({ "event": "message", "text": message })),
            (false, Form::Lines) => self.0.write(&message),
        }
    }
}

/// Writes a progress event at regular intervals until the run ends.
fn report_regularly<W: Write>(output: &Weak<Output<W>>) {
    loop {
        thread::sleep(INTERVAL);
        let Some(output) = output.upgrade() else {
            return;
        };
        output.write_progress();
    }
}

impl<W: Write> Output<W> {
    /// Writes and flushes a complete line, so that readers never receive an incomplete line. If the output is closed, the run continues.
    fn write(&self, line: &impl std::fmt::Display) {
        let mut writer = locked(&self.writer);
        let written = writer.write_all(format!("{line}\n").as_bytes());
        let _ = written.and_then(|()| writer.flush());
    }

    /// Writes the progress event of the current stage.
    fn write_progress(&self) {
        let run = locked(&self.run);
        let Some(stage) = &run.stage else {
            return;
        };
        let mut event = json!({
            "event": "progress",
            "done": stage.done,
            "total": stage.total,
            "elapsed_s": round_to_ms(stage.seconds()),
        });
        if let Some(clock) = &run.clock {
            let now = Instant::now();
            event["run_elapsed_s"] = round_to_ms(clock.elapsed_s(now)).into();
            if let Some(left_s) = clock.left_s(now) {
                event["run_left_s"] = round_to_ms(left_s).into();
            }
        }
        self.write(&event);
    }

    /// Writes the line that reports the end of a stage.
    fn end_stage(&self) {
        if self.form == Form::Json {
            self.write_progress();
        }
        let stage = locked(&self.run).stage.take();
        if let (Some(stage), Form::Lines) = (stage, self.form) {
            self.write(&stage.summary());
        }
    }
}

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
            (_, n_finished) => Some(self.elapsed_s(now) * n_pending as f64 / n_finished as f64),
        }
    }
}

/// Rounds a time in seconds to milliseconds.
fn round_to_ms(s: f64) -> f64 {
    (s * 1e3).round() / 1e3
}

#[cfg(test)]
mod tests {
    use super::*;
    use indicatif::TermLike;
    use serde_json::Value;
    use std::io;

    #[test]
    fn lines_name_each_stage_once_with_what_it_did() {
        let written = Written::default();
        let lines = Events::new(Form::Lines, written.clone());
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
    fn one_line_shows_stage_count_rate_remaining_time_and_work_items() {
        let written = Written::default();
        let target = ProgressDrawTarget::term_like(Box::new(written.clone()));
        let bar = Bar::new(target);
        bar.expect(2);
        bar.stage("simulate", 4);
        thread::sleep(2 * INTERVAL);
        bar.advance(1);
        bar.item_finished();
        thread::sleep(2 * INTERVAL);
        let shown = written.text();
        assert!(shown.contains("simulate [======>  "), "{shown}");
        assert!(shown.contains("] 1/4, "), "{shown}");
        assert!(shown.contains("; 1 of 2 work items"), "{shown}");
        assert!(shown.contains("0/4, 0.00/s, no rate yet"), "{shown}");
        assert!(shown.contains("s left"), "{shown}");
        bar.stage("learn", 2);
        thread::sleep(2 * INTERVAL);
        let text = written.text();
        assert!(text.contains("learn ["), "{text}");
        assert!(!text.contains('\n'), "one line alone: {text}");
        bar.finish("done");
        let text = written.text();
        assert!(text.trim_end().ends_with("done"), "{text}");
        drop(bar);
        thread::sleep(2 * INTERVAL);
        assert_eq!(written.text(), text, "no bar is drawn later");
    }

    /// Test output that stores everything that is written, with the width of a terminal of 100 columns.
    #[derive(Clone, Debug, Default)]
    struct Written(Arc<Mutex<Vec<u8>>>);

    impl Write for Written {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.lock().unwrap().write(bytes)
        }

        fn flush(&mut self) -> io::Result<()> {
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

        fn put(&self, text: &str) -> io::Result<()> {
            self.clone().write_all(text.as_bytes())
        }
    }

    impl TermLike for Written {
        fn width(&self) -> u16 {
            100
        }

        fn move_cursor_up(&self, _n: usize) -> io::Result<()> {
            Ok(())
        }

        fn move_cursor_down(&self, _n: usize) -> io::Result<()> {
            Ok(())
        }

        fn move_cursor_right(&self, _n: usize) -> io::Result<()> {
            Ok(())
        }

        fn move_cursor_left(&self, _n: usize) -> io::Result<()> {
            Ok(())
        }

        fn write_line(&self, line: &str) -> io::Result<()> {
            self.put(&format!("{line}\n"))
        }

        fn write_str(&self, text: &str) -> io::Result<()> {
            self.put(text)
        }

        fn clear_line(&self) -> io::Result<()> {
            Ok(())
        }

        fn flush(&self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn every_line_is_an_event_and_the_last_of_a_stage_has_its_count() {
        let written = Written::default();
        let lines = Events::new(Form::Json, written.clone());
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
    fn a_stage_is_reported_regularly_until_the_listener_is_dropped() {
        let written = Written::default();
        let lines = Events::new(Form::Json, written.clone());
        lines.expect(2);
        lines.stage("pack", 2);
        thread::sleep(5 * INTERVAL / 2);
        let before = written.events();
        lines.item_finished();
        lines.advance(1);
        thread::sleep(2 * INTERVAL);
        drop(lines);
        thread::sleep(INTERVAL);
        let all = written.events();
        thread::sleep(2 * INTERVAL);
        assert_eq!(written.events().len(), all.len());

        assert!(before.len() > 1 && all.len() > before.len(), "{all:?}");
        let (first, last) = (before.last().unwrap(), all.last().unwrap());
        assert_eq!(first["done"], 0);
        assert!(first["run_left_s"].is_null(), "no work item is finished");
        assert_eq!(last["done"], 1);
        assert_eq!(last["run_left_s"], last["run_elapsed_s"]);
    }

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
