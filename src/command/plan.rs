//! `bubbletouch plan`: prints the size of a study without running it.

use crate::command::options::study_args::{MemoryLimit, StudyArgs};
use crate::command::terminal::say;
use bubbletouch::kinds::AnyStudy;
use bubbletouch::report::progress::{RunState, locked};
use bubbletouch::study::work_items::RunOptions;
use bubbletouch::{Error, Result};
use bubbletouch_sim::text::spelling::duration;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

/// Print the size of a study: configurations, touches, memory
#[derive(clap::Args)]
#[command(after_help = "Example:\n  bubbletouch plan experiments/cans.toml --time=5")]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    #[command(flatten)]
    memory: MemoryLimit,
    /// Run the study for some seconds and estimate its run time
    ///
    /// Nothing of the sample is kept.
    #[arg(
        long,
        value_name = "SECONDS",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "2",
        value_parser = seconds,
        help_heading = "Run"
    )]
    time: Option<f64>,
}

/// Parses a positive number of seconds, at most a day.
fn seconds(text: &str) -> std::result::Result<f64, String> {
    let parsed = text.parse().ok();
    let within = parsed.filter(|&seconds: &f64| seconds > 0.0 && seconds <= 86_400.0);
    within.ok_or_else(|| "seconds, more than 0 and at most 86400".to_owned())
}

pub fn plan(
    Args {
        study,
        memory,
        time,
    }: &Args,
) -> Result<()> {
    let loaded = study.load(&study.default_results()?, memory.bytes()?)?;
    say(format_args!("{}: {}", study.name()?, loaded.plan()?))?;
    if let Some(mixed) = study.mixed_touches()? {
        say(mixed)?;
    }
    match time {
        None => Ok(()),
        Some(seconds) => say(format_args!("  time     {}", sample(loaded, *seconds)?)),
    }
}

/// Runs a study for `seconds` without storing results, and returns a text that describes the completed work. The run continues until the process ends.
///
/// # Errors
/// If a work item of the sample fails.
fn sample(study: Box<dyn AnyStudy>, seconds: f64) -> Result<String> {
    let sample = Arc::new(Mutex::new(RunState::default()));
    let (sender, ended) = mpsc::channel();
    let progress = sample.clone();
    thread::spawn(move || {
        let outcome = study.run(&RunOptions::whole(progress.as_ref()));
        // After the sample, progress reports are ignored.
        let _ = sender.send(outcome.map(drop));
    });
    match ended.recv_timeout(Duration::from_secs_f64(seconds)) {
        Ok(outcome) => outcome?,
        Err(RecvTimeoutError::Timeout) => {}
        Err(RecvTimeoutError::Disconnected) => {
            return Err(Error::input(
                "--time",
                "a sample",
                "a study that does not panic",
            ));
        }
    }
    let n_threads = rayon::current_num_threads();
    Ok(describe(&locked(&sample), seconds, n_threads))
}

/// Returns a text with the estimated time of the whole run and a description of the sample from which it was estimated.
fn describe(sample: &RunState, seconds: f64, n_threads: usize) -> String {
    let now = Instant::now();
    let estimate = sample.clock.as_ref().and_then(|clock| {
        let (n_finished, n_items) = clock.counts();
        let (elapsed_s, left_s) = (clock.elapsed_s(now), clock.left_s(now)?);
        let total_s = (elapsed_s + left_s).max(1.0);
        let total = duration(total_s);
        let cores = cores(total_s, n_threads);
        Some(format!(
            "about {total} ({n_finished} of {n_items} work items took {elapsed_s:.1} s)\n  cores    {cores}"
        ))
    });
    estimate.unwrap_or_else(|| {
        let longer = (10.0 * seconds).ceil();
        let during = sample.stage.as_ref().map_or_else(String::new, |stage| {
            format!(" ({}: {} of {})", stage.name, stage.done, stage.total)
        });
        format!("no work item finished in {seconds} s{during}; --time={longer} samples longer")
    })
}

/// Returns the computing time of a run in core hours, as clusters bill it.
fn cores(total_s: f64, n_threads: usize) -> String {
    let hours = total_s / 3600.0;
    let core_hours = hours * n_threads as f64;
    format!(
        "{n_threads} cores × {hours:.2} h = {core_hours:.2} core hours; with N shards about {core_hours:.2} / N hours on one core each"
    )
}

#[cfg(test)]
mod tests {
    #[test]
    fn core_hours_are_cores_times_hours() {
        let said = super::cores(7200.0, 4);
        assert!(
            said.starts_with("4 cores × 2.00 h = 8.00 core hours"),
            "{said}"
        );
    }
}
