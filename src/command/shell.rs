//! `bubbletouch completions` and `bubbletouch man`: write shell completions and manual pages.

use crate::command::terminal::{output_folder, say, write_out};
use bubbletouch::files::write_bytes;
use bubbletouch::{Error, Result};
use clap::Command;
use clap_complete::Shell;
use clap_mangen::Man;
use std::path::{Path, PathBuf};

/// Write the completions of a shell to standard output
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  bubbletouch completions bash > ~/.local/share/bash-completion/completions/bubbletouch"
)]
pub struct CompletionArgs {
    /// Shell that reads the completions
    shell: Shell,
}

/// Write the manual page, or the pages of all subcommands
#[derive(clap::Args)]
#[command(after_help = "Example:\n  bubbletouch man --out ~/.local/share/man/man1")]
pub struct ManArgs {
    /// Write the pages of all subcommands to this folder
    ///
    /// Without this option, the page of the command is written to standard output.
    #[arg(long, value_name = "FOLDER", help_heading = "Output")]
    out: Option<PathBuf>,
}

/// Writes a completion script to standard output.
pub fn completions(args: &CompletionArgs, mut command: Command) -> Result<()> {
    let mut script = Vec::new();
    let name = command.get_name().to_owned();
    clap_complete::generate(args.shell, &mut command, name, &mut script);
    write_out(&script)
}

/// Writes the manual pages of all commands into a folder; returns an error if a file of another program would be replaced.
fn write_pages(folder: &Path, command: Command) -> Result<()> {
    let failed = |error| Error::io(folder, "write", error);
    let made = tempfile::tempdir().map_err(failed)?;
    clap_mangen::generate_to(command, made.path()).map_err(failed)?;
    let mut pages = Vec::new();
    for entry in std::fs::read_dir(made.path()).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let (page, path) = (
            std::fs::read(entry.path()).map_err(failed)?,
            folder.join(entry.file_name()),
        );
        if std::fs::symlink_metadata(&path).is_ok() {
            let stands = std::fs::read(&path).unwrap_or_default();
            if !String::from_utf8_lossy(&stands).contains("\n.TH bubbletouch") {
                let given = "stands there, and is no manual page of bubbletouch";
                let allowed = "a folder without such a file; nothing was written";
                return Err(Error::input(path.display(), given, allowed));
            }
        }
        pages.push((path, page));
    }
    output_folder(folder)?;
    pages
        .iter()
        .try_for_each(|(path, page)| write_bytes(path, page))
}

/// Writes manual pages.
pub fn man(args: &ManArgs, command: Command) -> Result<()> {
    if let Some(folder) = &args.out {
        write_pages(folder, command)?;
        return say(format_args!("Manual pages in {}", folder.display()));
    }
    let mut command = command.disable_help_subcommand(true);
    command.build();
    let mut page = Vec::new();
    let rendered = Man::new(command).render(&mut page);
    rendered.map_err(|error| Error::io("manual page", "write", error))?;
    write_out(&page)
}
