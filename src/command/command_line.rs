//! The commands that make a study's folder, as they would be typed.

use super::study_args::StudyArgs;
use std::path::Path;

/// The command that makes a study's folder again.
pub fn command_line(args: &StudyArgs) -> String {
    line_of("run", args)
}

/// The command that puts the shards of a study together, told where they were written as they were.
pub fn merge_line(args: &StudyArgs, out: Option<&Path>) -> String {
    let out = out.map(|folder| format!(" --out {}", folder.display()));
    line_of("merge", args) + &out.unwrap_or_default()
}

fn line_of(subcommand: &str, args: &StudyArgs) -> String {
    let mut command = format!("bubbletouch {subcommand} {}", args.study.display());
    if let Some(objects) = &args.objects {
        command += &format!(" --objects {}", objects.display());
    }
    if let Some(seed) = args.seed {
        command += &format!(" --seed {seed}");
    }
    command
}
