//! Errors with messages for the user: invalid input, and failures of the system.

use std::fmt::Display;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Result of the fallible functions of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// Error with a message for the user.
///
/// A message has the form `<where>: <what was given>; <what is allowed>`.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Invalid input. The command exits with code 2.
    #[error("{place}: {given}; {allowed}")]
    Input {
        /// Location of the input: a file (with line and key if known), an option, or an argument's name.
        place: String,
        /// Value that was given.
        given: String,
        /// Values that are allowed.
        allowed: String,
    },
    /// Failure to read or write for a reason outside the input. The command exits with code 1.
    #[error("{path}: {action} failed: {source}", path = path.display())]
    Io {
        /// Path of the file or folder.
        path: PathBuf,
        /// Attempted action: `read`, `write`, `create folder`, `rename`.
        action: &'static str,
        /// Error of the operating system.
        source: std::io::Error,
    },
    #[doc(hidden)]
    /// Failure of some work items of a study; the results of all other work items are written. The command exits with code 1.
    #[error("{path}: {n_failed} of {n_all} work items failed; the file says why, and the same command tries them again{reason}", path = path.display(), reason = first_reason(first))]
    WorkItems {
        /// Path of the table of failures.
        path: PathBuf,
        /// Number of work items that failed.
        n_failed: usize,
        /// Number of all work items.
        n_all: usize,
        /// Cause of the first failure in the table; empty if unknown.
        first: String,
    },
}

/// Returns the end of the message on failed work items, with the cause of the first failure.
fn first_reason(cause: &str) -> String {
    match cause {
        "" => String::new(),
        cause => format!(". The first reason: {cause}"),
    }
}

impl Error {
    /// Creates an input error from printable values. Long values are truncated, because a quotation from a broken file
    /// may be the whole file.
    pub fn input(place: impl ToString, given: impl ToString, allowed: impl ToString) -> Self {
        Self::Input {
            place: shortened(place.to_string()),
            given: shortened(given.to_string()),
            allowed: shortened(allowed.to_string()),
        }
    }

    /// Prepends `outer` to the location of invalid input. `outer` ends in a separator, such as a colon or a comma with a space.
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

    /// Creates an input/output error with file and action. If a path to be read is a folder, or the content of the file is invalid, creates an input error.
    pub fn io(path: impl AsRef<Path>, action: &'static str, source: std::io::Error) -> Self {
        match (action, source.kind()) {
            ("read", ErrorKind::IsADirectory | ErrorKind::InvalidData) => {
                Self::unreadable(path, "a readable file", source)
            }
            _ => Self::Io {
                path: path.as_ref().to_owned(),
                action,
                source,
            },
        }
    }

    /// Creates the error for a file that the user named and that cannot be read. A missing file, a folder or invalid content, such as a text that is not
    /// UTF-8, is invalid input, with `allowed` in the message.
    pub fn unreadable(path: impl AsRef<Path>, allowed: &str, source: std::io::Error) -> Self {
        let path = path.as_ref();
        let given = match source.kind() {
            ErrorKind::NotFound => "is missing".to_owned(),
            ErrorKind::IsADirectory => "a folder".to_owned(),
            ErrorKind::NotADirectory => "below a file".to_owned(),
            ErrorKind::InvalidData => format!("cannot be read ({source})"),
            _ => return Self::io(path, "read", source),
        };
        Self::input(path.display(), given, allowed)
    }

    /// Returns the command's exit code for this error: 2 for invalid input, 1 for other failures.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Input { .. } => 2,
            Self::Io { .. } | Self::WorkItems { .. } => 1,
        }
    }
}

/// Conversion that linfa's traits require for the error of every classifier.
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

/// Conversion for classifiers from outside of the crates, so that all parts of a program may return [`Error`].
#[cfg(feature = "learning")]
impl From<Error> for bubbletouch_svm::Error {
    fn from(error: Error) -> Self {
        match error {
            Error::Input {
                place,
                given,
                allowed,
            } => Self::input(place, given, allowed),
            other => Self::input("classifier", other, "a training without an error"),
        }
    }
}

/// Conversion of any error of a part from outside of this crate.
impl From<Box<dyn std::error::Error + Send + Sync>> for Error {
    fn from(error: Box<dyn std::error::Error + Send + Sync>) -> Self {
        match error.downcast() {
            Ok(ours) => *ours,
            Err(other) => Self::input("part of the program", other, "a part without an error"),
        }
    }
}

#[cfg(feature = "learning")]
impl From<bubbletouch_svm::Error> for Error {
    fn from(error: bubbletouch_svm::Error) -> Self {
        Self::input(error.place, error.given, error.allowed)
    }
}

/// Maximum number of characters shown per line of a message.
const LETTERS: usize = 800;
/// Maximum number of lines shown in a message.
const LINES: usize = 25;
/// Approximate maximum number of bytes shown in a message.
const BYTES: usize = 2000;

/// Truncates a text to a readable length for a message.
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

    #[test]
    fn an_error_of_an_own_part_keeps_its_words() {
        let boxed: Box<dyn std::error::Error + Send + Sync> = "no fit".into();
        let said = Error::from(boxed).to_string();
        assert_eq!(said, "part of the program: no fit; a part without an error");
        let ours = Error::input("a", "b", "c");
        let boxed: Box<dyn std::error::Error + Send + Sync> = ours.into();
        assert_eq!(Error::from(boxed).to_string(), "a: b; c");
    }

    #[test]
    fn a_file_that_is_no_text_is_invalid_input_and_a_failing_disk_is_not() {
        let not_text = || std::io::Read::read_to_string(&mut &b"\xff"[..], &mut String::new());
        let errors = [
            Error::io("a.toml", "read", not_text().unwrap_err()),
            Error::unreadable("a.toml", "a study", not_text().unwrap_err()),
        ];
        for (error, allowed) in errors.iter().zip(["a readable file", "a study"]) {
            let given = "cannot be read (stream did not contain valid UTF-8)";
            assert_eq!(error.to_string(), format!("a.toml: {given}; {allowed}"));
            assert_eq!(error.exit_code(), 2);
        }
        let failing = || std::io::Error::from(ErrorKind::PermissionDenied);
        assert_eq!(Error::io("a.toml", "read", failing()).exit_code(), 1);
        assert_eq!(Error::unreadable("a.toml", "", failing()).exit_code(), 1);
    }
}
