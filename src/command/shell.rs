//! `bubbletouch completions` and `bubbletouch man`: what a shell and `man` need to know of the command.

use super::CommandLine;
use super::output::output_folder;
use super::streams::{say, write_out};
use bubbletouch::files::write_bytes;
use bubbletouch::{Error, Result};
use clap::{Command, CommandFactory};
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
    let mut command = CommandLine::command().disable_help_subcommand(true);
    command.build();
    let Some(folder) = &args.out else {
        return write_out(&page(command)?);
    };
    output_folder(folder)?;
    let pages = pages(command)?;
    for (name, page) in &pages {
        write_bytes(&folder.join(name), page)?;
    }
    say(format_args!(
        "{} pages in {}",
        pages.len(),
        folder.display()
    ))
}

/// Of a command and all that are below it: file name and content.
fn pages(command: Command) -> Result<Vec<(String, Vec<u8>)>> {
    let below: Vec<Command> = command.get_subcommands().cloned().collect();
    let name = command.get_display_name().unwrap_or(command.get_name());
    let mut all = vec![(format!("{name}.1"), page(command.clone())?)];
    for command in below {
        all.extend(pages(command)?);
    }
    Ok(all)
}

fn page(command: Command) -> Result<Vec<u8>> {
    let mut page = Vec::new();
    let failed = |error| Error::io("manual page", "write", error);
    Man::new(command).render(&mut page).map_err(failed)?;
    Ok(page)
}
