//! Output folders and files of the commands.

use bubbletouch::files::check_single_output;
use bubbletouch::{Error, Result};
use std::path::{Path, PathBuf};

/// Creates an output folder; returns an error if a file with this name exists.
pub fn output_folder(folder: &Path) -> Result<()> {
    if folder.exists() && !folder.is_dir() {
        let allowed = "a folder, or a path where one can be made";
        return Err(Error::input(folder.display(), "a file", allowed));
    }
    std::fs::create_dir_all(folder).map_err(|e| match e.kind() {
        // A parent folder in the path is a file.
        std::io::ErrorKind::NotADirectory | std::io::ErrorKind::AlreadyExists => {
            let allowed = "a path where a folder can be made";
            Error::input(folder.display(), "below a file", allowed)
        }
        _ => Error::io(folder, "create folder", e),
    })
}

/// Returns an error if a file name has another ending than required, or if the file belongs to a folder of results or of data.
pub fn check_ending(path: Option<&Path>, ending: &str) -> Result<()> {
    path.map_or(Ok(()), check_single_output)?;
    let has_another = |path: &&Path| path.extension().is_none_or(|given| given != ending);
    let Some(path) = path.filter(has_another) else {
        return Ok(());
    };
    let given = format!("not a .{ending} file");
    let allowed = format!("a name that ends in .{ending}");
    Err(Error::input(path.display(), given, allowed))
}

/// Returns the folder that stores packed meshes for later runs, next to a folder of results.
pub fn packings_beside(folder: &Path) -> PathBuf {
    folder.parent().unwrap_or(Path::new("")).join("packings")
}

/// Returns the width of the terminal in characters, or a default width without a terminal.
pub fn terminal_width() -> usize {
    let terminal = console::Term::stdout();
    match terminal.size_checked() {
        Some((_, columns)) if terminal.is_term() => usize::from(columns),
        _ => 100,
    }
}
