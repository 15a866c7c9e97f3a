//! The command line: one file a subcommand, each `Args` → work → files or terminal.

mod advise;
mod calibrate;
mod classify;
mod compare;
mod features;
mod merge;
mod objects;
mod objects_pack;
mod objects_show;
mod options;
mod plan;
mod press;
mod press_place;
mod press_poses;
mod recording;
mod report;
mod run;
mod shell;
mod simulate;
mod slurm;
mod slurm_jobs;
pub mod terminal;
mod touches;
mod verify;

use bubbletouch::Result;
use clap::{CommandFactory, Parser, Subcommand};
use options::study_args::QUICKSTART_FILE;

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
    ///
    /// A table of its file says of which kind it is: [recognition] (which object is touched), [reconstruction] (how exactly frames are
    /// reconstructed from measurements), [object_detail] (how detailed models of objects must be), [whole_body] (what a body of
    /// millions of taxels costs) or [stability] (at which settings contact methods fail).
    Run(run::Args),
    /// Put the shards of a study together, and write its tables, charts and report
    Merge(merge::Args),
    /// Run a study as an array of Slurm jobs, and the merge after them; what failed is submitted again by the same command
    Slurm(slurm::Args),
    /// Write the charts and the page of a folder of results again, from its tables
    ///
    /// A table, or the study, that was changed after its run is refused: manifest.json holds the SHA-256 of each.
    Report(report::Args),
    /// Say what moved between two folders of results, whether chance explains it, and whether both rank designs alike
    Compare(compare::Args),
    /// Check the files of a folder of results, and run a few of its work items again, compared byte by byte
    Verify(verify::Args),
    /// Print the configurations, touches and memory of a study without running it
    Plan(plan::Args),
    /// Say which setting is the cheapest that is accurate enough, or the most accurate that is cheap enough
    Advise(advise::Args),
    /// Write a study's touches as NumPy files, to train elsewhere
    ///
    /// Frames are the deflections of the press: without noise, smoothing and sensor errors. With --configuration they are what that cell of the
    /// study reads, with all of these.
    Touches(touches::Args),
    /// Write what one cell of a study learns from as NumPy files, to train on exactly those rows elsewhere
    Features(features::Args),
    /// Train and test one classifier on such a folder, and time it
    Classify(classify::Args),
    /// Say what noise, gains, drift, crosstalk ... a skin has, from its recorded frames, as the [signal] of a study
    ///
    /// Each number comes with its 95 % interval; what frames do not tell is a comment that says why. Noise, smoothing and drift need frames of the
    /// untouched skin (--untouched or --untouched-frames).
    Calibrate(calibrate::Args),
    /// Simulate a scene: robots, skin and objects that move, from one TOML file
    Simulate(simulate::Args),
    /// Press one object on one array and write or draw the deflections
    Press(press::Args),
    /// Say what is in a recording, or draw it, still or moving
    Recording(recording::Args),
    /// List the built-in objects, or draw one
    Objects(objects::Args),
    /// Write completions for a shell to standard output
    Completions(shell::CompletionArgs),
    /// Write the manual page, or those of all subcommands
    Man(shell::ManArgs),
}

/// Parses the command line and does what it says; exits with 2 if it cannot be parsed.
pub fn dispatch() -> Result<()> {
    bubbletouch::files::protect_inputs();
    let line = match CommandLine::try_parse() {
        Ok(line) => line,
        // --help and --version.
        Err(asked) if !asked.use_stderr() => return terminal::streams::written(asked.print()),
        Err(wrong) => wrong.exit(),
    };
    let quickstart = ["bubbletouch", "run", QUICKSTART_FILE, "--demonstration"];
    let command = line
        .command
        .or_else(|| CommandLine::parse_from(quickstart).command);
    match command {
        None => Ok(()),
        Some(Command::Run(args)) => run::run(&args),
        Some(Command::Merge(args)) => merge::merge(&args),
        Some(Command::Slurm(args)) => slurm::slurm(&args),
        Some(Command::Report(args)) => report::report(&args),
        Some(Command::Compare(args)) => compare::compare(&args),
        Some(Command::Verify(args)) => verify::verify(&args),
        Some(Command::Plan(args)) => plan::plan(&args),
        Some(Command::Advise(args)) => advise::advise(&args),
        Some(Command::Touches(args)) => touches::touches(&args),
        Some(Command::Features(args)) => features::features(&args),
        Some(Command::Classify(args)) => classify::classify(&args),
        Some(Command::Calibrate(args)) => calibrate::calibrate(&args),
        Some(Command::Simulate(args)) => simulate::simulate(&args),
        Some(Command::Press(args)) => press::press(&args),
        Some(Command::Recording(args)) => recording::recording(&args),
        Some(Command::Objects(args)) => objects::objects(&args),
        Some(Command::Completions(args)) => shell::completions(&args, CommandLine::command()),
        Some(Command::Man(args)) => shell::man(&args, CommandLine::command()),
    }
}

#[cfg(test)]
mod tests {
    use super::CommandLine;
    use clap::{Command, CommandFactory};
    use std::collections::BTreeSet;

    /// Clap asserts this itself, but only in builds with debug assertions.
    fn names_are_unique(command: &Command) {
        let own = command.get_arguments().map(clap::Arg::get_id);
        let mut seen = BTreeSet::new();
        for id in own.chain(command.get_groups().map(clap::ArgGroup::get_id)) {
            assert!(seen.insert(id), "{}: '{id}' twice", command.get_name());
        }
        command.get_subcommands().for_each(names_are_unique);
    }

    #[test]
    fn no_subcommand_has_two_options_or_groups_of_one_name() {
        let command = CommandLine::command();
        assert!(command.get_subcommands().count() > 10);
        names_are_unique(&command);
    }

    #[test]
    fn clap_finds_no_fault_with_any_subcommand() {
        CommandLine::command().debug_assert();
    }
}
