//! Progress on standard error: a bar on a terminal, a line a stage elsewhere.

use crate::report::run_clock::{RunClock, in_words};
use crate::study::progress::Progress;
use crate::study::time_left::Piece;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// The listener that suits standard error: a bar, or plain lines if it is not a terminal.
pub fn to_stderr() -> Box<dyn Progress> {
    let is_dumb = std::env::var("TERM").is_ok_and(|term| term == "dumb");
    if std::io::stderr().is_terminal() && !is_dumb {
        Box::new(Bar::default())
    } else {
        Box::new(Lines::to(std::io::stderr()))
    }
}

/// How often a bar is drawn while its stage does not advance.
const TICK: Duration = Duration::from_millis(250);

/// A bar of the stage with its rate, and the time left: of the whole run where it has said what it will do, else of the stage.
#[derive(Default)]
pub struct Bar {
    current: Mutex<Option<ProgressBar>>,
    clock: Arc<RunClock>,
}

impl Progress for Bar {
    fn stage(&self, name: &str, total: u64) {
        self.close();
        let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr());
        let template = "{msg:>14} [{bar:32}] {pos}/{len}, {per_sec}, {left}";
        if let Ok(style) = ProgressStyle::with_template(template) {
            let clock = Arc::clone(&self.clock);
            let left = move |state: &ProgressState, text: &mut dyn std::fmt::Write| {
                // A text in memory takes all that is written.
                let _ = text.write_str(&left(&clock, state.eta().as_secs_f64()));
            };
            bar.set_style(style.with_key("left", left).progress_chars("=> "));
        }
        bar.set_message(name.to_owned());
        bar.enable_steady_tick(TICK);
        if let Ok(mut current) = self.current.lock() {
            *current = Some(bar);
        }
    }

    fn advance(&self, n: u64) {
        if let Ok(current) = self.current.lock()
            && let Some(bar) = current.as_ref()
        {
            bar.inc(n);
        }
    }

    fn finish(&self, message: &str) {
        self.close();
        write_line(&mut std::io::stderr(), message);
    }

    fn expect(&self, work: &[Piece]) {
        self.clock.expect(work);
    }

    fn worked(&self, piece: &Piece, took_s: f64) {
        self.clock.worked(piece, took_s);
    }
}

fn left(clock: &RunClock, stage_left_s: f64) -> String {
    match clock.times() {
        Some(times) => format!("{} left", in_words(times.left_s)),
        None => format!("{} left of this stage", in_words(stage_left_s)),
    }
}

impl Bar {
    /// Leaves one plain line of what the stage took.
    fn close(&self) {
        let Ok(mut current) = self.current.lock() else {
            return;
        };
        if let Some(bar) = current.take() {
            let (name, seconds) = (bar.message(), bar.elapsed().as_secs_f64());
            bar.finish_and_clear();
            let line = stage_sentence(&name, bar.position(), seconds);
            write_line(&mut std::io::stderr(), &line);
        }
    }
}

/// One line when a stage ends.
pub struct Lines<W: Write + Send> {
    state: Mutex<(W, Option<Stage>)>,
}

struct Stage {
    name: String,
    done: u64,
    start: Instant,
}

impl<W: Write + Send> Lines<W> {
    /// Lines go to this writer; that it fails does not stop the run.
    pub fn to(writer: W) -> Self {
        Self {
            state: Mutex::new((writer, None)),
        }
    }

    /// The writer, once nobody listens any more.
    pub fn into_inner(self) -> Option<W> {
        self.state.into_inner().ok().map(|(writer, _)| writer)
    }
}

impl<W: Write + Send> Progress for Lines<W> {
    fn stage(&self, name: &str, _total: u64) {
        if let Ok(mut state) = self.state.lock() {
            close_stage(&mut state);
            state.1 = Some(Stage {
                name: name.to_owned(),
                done: 0,
                start: Instant::now(),
            });
        }
    }

    fn advance(&self, n: u64) {
        if let Ok(mut state) = self.state.lock()
            && let Some(stage) = state.1.as_mut()
        {
            stage.done += n;
        }
    }

    fn finish(&self, message: &str) {
        if let Ok(mut state) = self.state.lock() {
            close_stage(&mut state);
            write_line(&mut state.0, message);
        }
    }
}

fn close_stage<W: Write>(state: &mut (W, Option<Stage>)) {
    if let Some(stage) = state.1.take() {
        let seconds = stage.start.elapsed().as_secs_f64();
        let line = stage_sentence(&stage.name, stage.done, seconds);
        write_line(&mut state.0, &line);
    }
}

fn stage_sentence(name: &str, done: u64, seconds: f64) -> String {
    format!("{name:>14}: {done} in {seconds:.1} s")
}

/// A closed standard error must not end a run.
fn write_line(writer: &mut impl Write, line: &str) {
    if !line.is_empty() {
        let _ = writeln!(writer, "{line}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_name_each_stage_once_with_what_it_did() {
        let lines = Lines::to(Vec::new());
        lines.stage("simulate", 10);
        lines.advance(4);
        lines.advance(6);
        lines.stage("learn", 3);
        lines.advance(3);
        lines.finish("done: results/quickstart");
        let text = String::from_utf8(lines.into_inner().unwrap()).unwrap();
        let said: Vec<&str> = text.lines().collect();
        assert_eq!(said.len(), 3);
        assert!(said[0].contains("simulate: 10 in"), "{text}");
        assert!(said[1].contains("learn: 3 in"), "{text}");
        assert_eq!(said[2], "done: results/quickstart");
    }
}
