//! What can go wrong, in two kinds: the input is bad, or the world failed.

use std::fmt::Display;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The result of everything that can fail here.
pub type Result<T> = std::result::Result<T, Error>;

/// An error that a person can act on.
///
/// The text reads `<where>: <what was given>; <what is allowed>`.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The caller gave something that cannot be used. The command exits with code 2.
    #[error("{place}: {given}; {allowed}")]
    Input {
        /// Where: a file (with line and key where known), an option, or an argument's name.
        place: String,
        /// What was given there.
        given: String,
        /// What is allowed there.
        allowed: String,
    },
    /// Reading or writing failed for a reason outside the input. The command exits with code 1.
    #[error("{path}: {action} failed: {source}", path = path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What was attempted: `read`, `write`, `create folder`, `rename`.
        action: &'static str,
        /// What the system answered.
        source: std::io::Error,
    },
    /// Some work items of a study failed; what the others found is written. The command exits with code 1.
    #[error("{path}: {n_failed} of {n_all} work items failed; the file says why, and the same command tries them again", path = path.display())]
    WorkItems {
        /// The table of failures.
        path: PathBuf,
        /// Those that failed.
        n_failed: usize,
        /// All.
        n_all: usize,
    },
}

impl Error {
    /// An [`Error::Input`] from anything printable. Of long lines, and of many, the beginning: what is quoted from a broken file
    /// may be the whole file.
    pub fn input(place: impl ToString, given: impl ToString, allowed: impl ToString) -> Self {
        Self::Input {
            place: shortened(place.to_string()),
            given: shortened(given.to_string()),
            allowed: shortened(allowed.to_string()),
        }
    }

    /// The same, with `outer` before the place of bad input; `outer` ends in what parts the two (`: ` or `, `).
    pub fn under(self, outer: impl Display) -> Self {
        match self {
            Self::Input {
                place,
                given,
                allowed,
            } => Self::input(format!("{outer}{place}"), given, allowed),
            other @ (Self::Io { .. } | Self::WorkItems { .. }) => other,
        }
    }

    /// An [`Error::Io`] that says which file and which action; an [`Error::Input`] where a folder stands in the place of a file to read.
    pub fn io(path: impl AsRef<Path>, action: &'static str, source: std::io::Error) -> Self {
        if action == "read" && source.kind() == ErrorKind::IsADirectory {
            return Self::input(path.as_ref().display(), "a folder", "a file");
        }
        Self::Io {
            path: path.as_ref().to_owned(),
            action,
            source,
        }
    }

    /// What is said of a file that a person named and that cannot be read: bad input if it is not there or is a folder; what is
    /// `allowed` is said then.
    pub fn unreadable(path: impl AsRef<Path>, allowed: &str, source: std::io::Error) -> Self {
        let path = path.as_ref();
        let given = match source.kind() {
            ErrorKind::NotFound => "is missing",
            ErrorKind::IsADirectory => "a folder",
            ErrorKind::NotADirectory => "below a file",
            _ => return Self::io(path, "read", source),
        };
        Self::input(path.display(), given, allowed)
    }

    /// An [`Error::Input`] from a TOML file: `file:line:column: what was given; what is allowed`.
    pub fn toml(place: &str, text: &str, error: &toml::de::Error) -> Self {
        let position = error.span().map_or(String::new(), |span| {
            let before = &text[..span.start.min(text.len())];
            let line = before.matches('\n').count() + 1;
            let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
            format!(":{line}:{column}")
        });
        // What Rust calls usize, people call a whole number.
        let message = error
            .message()
            .replace('\n', " ")
            .replace("expected usize", "expected a whole number")
            .replace("expected u64", "expected a whole number")
            .replace("expected u32", "expected a whole number")
            .replace("expected f64", "expected a number")
            .replace(
                "u64 value was too large",
                "too large, expected a number below 2⁶³",
            );
        let (given, allowed) = match message.split_once(", expected ") {
            Some((given, allowed)) => (given.to_owned(), format!("expected {allowed}")),
            None => (message, "TOML as in experiments/ and objects/".to_owned()),
        };
        Self::input(format!("{place}{position}"), given, allowed)
    }

    /// The command's exit code: 2 for bad input, 1 when the world failed.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Input { .. } => 2,
            Self::Io { .. } | Self::WorkItems { .. } => 1,
        }
    }
}

/// linfa's traits ask this of the error of every classifier.
#[cfg(feature = "learning")]
impl From<linfa::Error> for Error {
    fn from(error: linfa::Error) -> Self {
        Self::input(
            "classifier",
            error,
            "see the documentation of linfa for what is allowed",
        )
    }
}

#[cfg(feature = "learning")]
impl From<bubbletouch_svm::Error> for Error {
    fn from(error: bubbletouch_svm::Error) -> Self {
        Self::input(error.place, error.given, error.allowed)
    }
}

/// Letters of a line that are shown.
const LETTERS: usize = 500;
/// Lines that are shown.
const LINES: usize = 25;
/// Bytes of all of them, about.
const BYTES: usize = 2000;

/// A text that a person can read to its end.
fn shortened(text: String) -> String {
    if text.len() <= LETTERS {
        return text;
    }
    let mut lines: Vec<String> = Vec::new();
    let mut n_bytes = 0;
    for line in text.lines().take(LINES) {
        if n_bytes > BYTES {
            break;
        }
        let mut shown: String = line.chars().take(LETTERS).collect();
        if shown.len() < line.len() {
            shown.push('…');
        }
        n_bytes += shown.len();
        lines.push(shown);
    }
    let n_more = text.lines().count() - lines.len();
    if n_more > 0 {
        lines.push(format!("  … and {n_more} more lines"));
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentence_about_a_broken_file_does_not_repeat_the_file() {
        let said = |given: &str| Error::input("a.toml", given, "less").to_string();
        assert_eq!(said("7\n  8"), "a.toml: 7\n  8; less");
        let long = "é".repeat(3 * LETTERS);
        assert_eq!(
            said(&long).chars().filter(|&letter| letter == 'é').count(),
            LETTERS
        );
        let lines = said(&"line\n".repeat(10_000));
        assert_eq!(lines.matches("line\n").count(), LINES);
        assert!(lines.contains("and 9975 more lines"), "{lines}");
        let long_lines = said(&("-".repeat(300) + "\n").repeat(20));
        assert!(long_lines.len() < BYTES + 400, "{long_lines}");
        assert!(long_lines.contains("and 13 more lines"), "{long_lines}");
    }
}
