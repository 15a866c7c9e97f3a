//! Who listens to a run: a person at a terminal, a program, or nobody.

use bubbletouch::report::progress::{json_lines, to_stderr};
use bubbletouch::study::progress::{Progress, Silent};
use std::io::stdout;

#[derive(clap::Args)]
pub struct Listener {
    /// Say nothing but errors
    #[arg(long, conflicts_with = "json")]
    pub quiet: bool,
    /// Say what happens as JSON lines on standard output
    #[arg(long)]
    pub json: bool,
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
}
