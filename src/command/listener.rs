//! Who listens to a run: a person at a terminal, a program, or nobody.

use super::streams::{note, say};
use bubbletouch::Result;
use bubbletouch::report::progress::{json_lines, to_stderr};
use bubbletouch::study::progress::{Progress, Silent};
use std::io::stdout;

#[derive(Clone, Copy, Debug, Default, clap::Args)]
pub struct Listener {
    /// Say nothing but errors
    #[arg(long, conflicts_with = "json")]
    quiet: bool,
    /// Say what happens as JSON lines on standard output
    #[arg(long)]
    json: bool,
}

impl Listener {
    /// What is told how far a run is.
    pub fn progress(&self) -> Box<dyn Progress> {
        match (self.quiet, self.json) {
            (true, _) => Box::new(Silent),
            (_, true) => json_lines(stdout()),
            _ => to_stderr(),
        }
    }

    /// Whether text for people belongs on standard output.
    pub fn is_person(&self) -> bool {
        !self.quiet && !self.json
    }

    /// Says a line outside any stage.
    pub fn remark(&self, text: &str) {
        match (self.quiet, self.json) {
            (true, _) => {}
            (_, true) => self.progress().finish(text),
            _ => note(text),
        }
    }

    /// Says, to a program, what came of a run.
    pub fn finished(&self, event: serde_json::Value) -> Result<()> {
        match self.json {
            true => say(event),
            false => Ok(()),
        }
    }
}
