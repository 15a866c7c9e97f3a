//! Command line: one file for each subcommand. The doc comments of its `Args` are its help.
//!
//! A program with parts of its own registers them and calls [`run`]; its command line then has all subcommands, and studies may use the parts
//! ([guide](crate::guide::own_methods)).

mod advise;
mod audit;
mod calibrate;
mod classify;
mod compare;
mod features;
mod layout;
mod merge;
mod objects;
mod options;
mod plan;
mod press;
mod recording;
mod report;
mod run;
mod schema;
mod shell;
mod simulate;
mod slurm;
mod terminal;
mod touches;
mod verify;

use bubbletouch::Result;
use clap::{CommandFactory, Parser, Subcommand};
use options::study_args::QUICKSTART_FILE;
use std::ffi::OsString;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// Simulate touch on robot skin, compress the frames, recognise the object
///
/// Without a subcommand, bubbletouch runs experiments/quickstart.toml and writes results/quickstart/.
#[derive(Parser)]
#[command(name = "bubbletouch", version, propagate_version = true)]
#[command(after_help = "Example:\n  bubbletouch press --object mug")]
struct CommandLine {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    Run(run::Args),
    Plan(plan::Args),
    Report(report::Args),
    Advise(advise::Args),
    Compare(compare::Args),
    Verify(verify::Args),
    Merge(merge::Args),
    Slurm(slurm::Args),
    Touches(touches::Args),
    Features(features::Args),
    Classify(classify::Args),
    Calibrate(calibrate::Args),
    Audit(audit::Args),
    Press(press::Args),
    Objects(objects::Args),
    Layout(layout::Args),
    Simulate(simulate::Args),
    Recording(recording::Args),
    Schema(schema::Args),
    Completions(shell::CompletionArgs),
    Man(shell::ManArgs),
}

/// Name of the program that runs commands; empty for `bubbletouch`.
static PROGRAM: Mutex<String> = Mutex::new(String::new());

/// Returns the name of the program, the first word of the command lines that results contain.
fn program() -> String {
    let name = PROGRAM.lock().unwrap_or_else(PoisonError::into_inner);
    match &**name {
        "" => "bubbletouch".to_owned(),
        name => name.to_owned(),
    }
}

/// Runs a command line and returns its exit code: 0, 1 for a failure, or 2 for invalid input. Results are printed on standard output, and errors on standard
/// error. The first argument is the name of the program, as in [`std::env::args_os`].
///
/// ```
/// assert_eq!(bubbletouch::command::run(["bubbletouch", "press", "--object", "no_such_mug"]), 2);
/// ```
pub fn run(arguments: impl IntoIterator<Item = impl Into<OsString>>) -> u8 {
    let arguments: Vec<OsString> = arguments.into_iter().map(Into::into).collect();
    let name = arguments
        .first()
        .and_then(|path| Path::new(path).file_stem());
    let name = name.unwrap_or_default().to_string_lossy().into_owned();
    *PROGRAM.lock().unwrap_or_else(PoisonError::into_inner) = name;
    dispatch(&arguments).unwrap_or_else(|error| {
        terminal::note(format_args!("error: {error}"));
        error.exit_code()
    })
}

/// Parses the command line and runs its subcommand. Returns the exit code of a command line that is invalid, or of an audit that found a fault.
fn dispatch(arguments: &[OsString]) -> Result<u8> {
    bubbletouch::files::protect_inputs();
    let line = match CommandLine::try_parse_from(arguments) {
        Ok(line) => line,
        // Handles --help and --version.
        Err(asked) if !asked.use_stderr() => {
            return terminal::written(asked.print()).map(|()| 0);
        }
        Err(wrong) => {
            let _ = wrong.print();
            return Ok(wrong.exit_code() as u8);
        }
    };
    let quickstart = ["bubbletouch", "run", QUICKSTART_FILE, "--demonstration"];
    let command = line
        .command
        .or_else(|| CommandLine::parse_from(quickstart).command);
    let done = match command {
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
        Some(Command::Audit(args)) => return audit::audit(&args, &arguments[1..]),
        Some(Command::Calibrate(args)) => calibrate::calibrate(&args),
        Some(Command::Simulate(args)) => simulate::simulate(&args),
        Some(Command::Press(args)) => press::press(&args),
        Some(Command::Recording(args)) => recording::recording(&args),
        Some(Command::Objects(args)) => objects::objects(&args),
        Some(Command::Layout(args)) => layout::layout(&args),
        Some(Command::Schema(args)) => schema::schema(&args),
        Some(Command::Completions(args)) => shell::completions(&args, CommandLine::command()),
        Some(Command::Man(args)) => shell::man(&args, CommandLine::command()),
    };
    done.map(|()| 0)
}

#[cfg(test)]
mod tests {
    use super::CommandLine;
    use clap::{Command, CommandFactory, Parser};
    use std::collections::BTreeSet;

    /// Maximum number of words in a help line, without the default value.
    const MAX_WORDS: usize = 12;

    /// Calls `check` with every subcommand, nested ones included.
    fn for_each(command: &Command, check: &mut impl FnMut(&Command)) {
        for subcommand in command.get_subcommands() {
            check(subcommand);
            for_each(subcommand, check);
        }
    }

    fn check_line(place: &str, line: &str) {
        let words = line.split(" [").next().unwrap().split_whitespace();
        assert!(
            (1..=MAX_WORDS).contains(&words.count()),
            "{place}: {line:?}: one to {MAX_WORDS} words"
        );
        let lower = line.to_lowercase();
        let words: Vec<&str> = lower.split(|c: char| !c.is_alphanumeric()).collect();
        for word in ["cell", "cells", "say", "says"] {
            assert!(!words.contains(&word), "{place}: {line:?}: {word}");
        }
    }

    #[test]
    fn help_lines_are_short_and_options_have_headings() {
        for_each(&CommandLine::command(), &mut |command| {
            let name = command.get_name();
            check_line(name, &command.get_about().unwrap().to_string());
            for argument in command.get_arguments().filter(|a| !a.is_hide_set()) {
                let place = format!("{name} {}", argument.get_id());
                check_line(&place, &argument.get_help().unwrap().to_string());
                let is_grouped = argument.get_help_heading().is_some();
                assert!(is_grouped || argument.is_positional(), "{place}");
            }
        });
    }

    #[test]
    fn every_subcommand_has_an_example_that_is_parsed() {
        let mut n_examples = 0;
        for_each(&CommandLine::command(), &mut |command| {
            let after = command.get_after_help().map(ToString::to_string);
            let after = after.unwrap_or_else(|| panic!("{}: no example", command.get_name()));
            let example = after.strip_prefix("Example:\n  ").unwrap();
            let (line, _) = example.split_once(" > ").unwrap_or((example, ""));
            let words: Vec<&str> = line.split(' ').collect();
            assert!(words.contains(&command.get_name()), "{example}");
            if let Err(error) = CommandLine::try_parse_from(words) {
                panic!("{example}: {error}");
            }
            n_examples += 1;
        });
        assert!(n_examples > 18, "{n_examples}");
    }

    /// Asserts that names are unique; clap checks this only in builds with debug assertions.
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
