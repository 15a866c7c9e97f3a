//! The command line: one file a subcommand, each `Args` → work → files or terminal.

mod classify;
mod features;
mod objects;
mod objects_pack;
mod objects_show;
mod output;
mod plan;
mod press;
mod recording;
mod run;
mod run_object_detail;
mod run_reconstruction;
mod run_stability;
mod simulate;
mod study_args;
mod touches;
mod which_object;

use bubbletouch::Result;
use clap::{Parser, Subcommand};

/// Simulated touch for robot skin: press objects on arrays of taxels, compress what they feel, recognise the object.
///
/// Without a subcommand it runs experiments/quickstart.toml and writes results/quickstart/.
#[derive(Parser)]
#[command(name = "bubbletouch", version, propagate_version = true)]
struct CommandLine {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Run a study: simulate, compress, recognise; write tables, charts and a report
    Run(run::Args),
    /// Say what a study would do: cells, touches, memory and time, without running it
    Plan(plan::Args),
    /// Write a study's touches as NumPy files, to train elsewhere
    Touches(touches::Args),
    /// Write what one cell of a study learns from as NumPy files, to train on exactly those rows elsewhere
    Features(features::Args),
    /// Train and test one classifier on such a folder, and time it
    Classify(classify::Args),
    /// Simulate a scene: robots, skin and objects that move, from one TOML file
    Simulate(simulate::Args),
    /// Press one object on one array and write or draw the deflections
    Press(press::Args),
    /// Say what is in a recording, or draw it, still or moving
    Recording(recording::Args),
    /// List the built-in objects, or draw one
    Objects(objects::Args),
}

/// Parses the command line and does what it says.
pub fn dispatch() -> Result<()> {
    match CommandLine::parse().command {
        None => run::run(&run::Args::quickstart()),
        Some(Command::Run(args)) => run::run(&args),
        Some(Command::Plan(args)) => plan::plan(&args),
        Some(Command::Touches(args)) => touches::touches(&args),
        Some(Command::Features(args)) => features::features(&args),
        Some(Command::Classify(args)) => classify::classify(&args),
        Some(Command::Simulate(args)) => simulate::simulate(&args),
        Some(Command::Press(args)) => press::press(&args),
        Some(Command::Recording(args)) => recording::recording(&args),
        Some(Command::Objects(args)) => objects::objects(&args),
    }
}
