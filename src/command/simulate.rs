//! `bubbletouch simulate`: simulates a scene file and writes its folder of results.

use crate::command::terminal::{note, output_folder, say, write_out};
use bubbletouch::Result;
use bubbletouch::report::progress::to_stderr;
use bubbletouch::report::scene_files::{SceneFiles, scene_table};
use bubbletouch::scene::{FrameSink, ScenePlan, Simulation, Stepping, Summary};
use bubbletouch::study::progress::{Progress, Silent};
use std::path::PathBuf;
use std::time::Instant;

/// Simulate a scene of robots, skin and moving objects
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  bubbletouch simulate experiments/scenes/ball_over_forearm.toml --out results/ball"
)]
pub struct Args {
    /// Scene, a TOML file such as those of experiments/scenes/
    scene: PathBuf,
    /// Write the recording to this folder
    #[arg(long, value_name = "FOLDER", help_heading = "Output")]
    out: PathBuf,
    /// End the scene at this time
    ///
    /// The frames are the first frames of the whole scene, bit by bit.
    #[arg(
        long,
        value_name = "SECONDS",
        allow_negative_numbers = true,
        help_heading = "Run"
    )]
    until_s: Option<f64>,
    /// Print errors only
    #[arg(long, help_heading = "Output")]
    quiet: bool,
}

pub fn simulate(args: &Args) -> Result<()> {
    let mut plan = ScenePlan::read(&args.scene)?;
    if let Some(until) = args.until_s {
        plan.cut("--until-s", until)?;
    }
    output_folder(&args.out)?;
    let mut files = SceneFiles::create(&args.out, &plan)?;
    if !args.quiet {
        note_all(plan.notes());
    }
    let mut summary = Summary::default();
    let progress: Box<dyn Progress> = if args.quiet {
        Box::new(Silent)
    } else {
        to_stderr()
    };
    progress.stage("simulate", plan.n_frames as u64);
    let start = Instant::now();
    let mut simulation = Simulation::new(&plan, Stepping::AsNeeded);
    while let Some(frame) = simulation.next_frame()? {
        summary.frame(frame)?;
        files.frame(frame)?;
        progress.advance(1);
    }
    let seconds = start.elapsed().as_secs_f64();
    files.finish()?;
    let n_steps = simulation.n_steps();
    let each_us = 1e6 * seconds / n_steps as f64;
    progress.finish(&format!("{n_steps} steps, {each_us:.0} µs each"));
    if !args.quiet {
        write_out(scene_table(&plan, &summary).as_bytes())?;
        if simulation.n_unsettled() > 0 {
            let n = simulation.n_unsettled();
            say(format_args!(
                "\nFree objects were not at rest in {n} of {n_steps} steps."
            ))?;
        }
        say(format_args!("\nResults in {}", args.out.display()))?;
    }
    Ok(())
}

/// Maximum number of notes that are printed for one scene, because a robot file may repeat a fault in each joint.
const MAX_NOTES: usize = 12;

fn note_all(mut notes: impl Iterator<Item = String>) {
    for text in notes.by_ref().take(MAX_NOTES) {
        note(format_args!("note: {text}"));
    }
    let n_more = notes.count();
    if n_more > 0 {
        note(format_args!("note: {n_more} more notes of this kind"));
    }
}
