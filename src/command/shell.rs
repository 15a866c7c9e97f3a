//! `bubbletouch completions` and `bubbletouch man`: what a shell and `man` need to know of the command.

use super::CommandLine;
use super::output::output_folder;
use super::streams::{say, write_out};
use bubbletouch::{Error, Result};
use clap::CommandFactory;
use clap_complete::Shell;
use clap_mangen::Man;
use std::path::PathBuf;

#[derive(clap::Args)]
pub struct CompletionArgs {
    /// The shell that reads them
    shell: Shell,
}

#[derive(clap::Args)]
pub struct ManArgs {
    /// Write a page for the command and one for each subcommand into a folder such as share/man/man1; else the first goes to
    /// standard output
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
}

/// Writes a completion script to standard output.
pub fn completions(args: &CompletionArgs) -> Result<()> {
    let mut script = Vec::new();
    let mut command = CommandLine::command();
    let name = command.get_name().to_owned();
    clap_complete::generate(args.shell, &mut command, name, &mut script);
    write_out(&script)
}

/// Writes manual pages.
pub fn man(args: &ManArgs) -> Result<()> {
    if let Some(folder) = &args.out {
        output_folder(folder)?;
        let written = clap_mangen::generate_to(CommandLine::command(), folder);
        written.map_err(|error| Error::io(folder, "write", error))?;
        return say(format_args!("Manual pages in {}", folder.display()));
    }
    let mut command = CommandLine::command().disable_help_subcommand(true);
    command.build();
    let mut page = Vec::new();
    let rendered = Man::new(command).render(&mut page);
    rendered.map_err(|error| Error::io("manual page", "write", error))?;
    write_out(&page)
}
