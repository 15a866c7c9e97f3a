//! Input that cannot be used.

/// The result of everything that can fail here.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Input that cannot be used: where, what was given there, and what is allowed there.
///
/// The text reads `<place>: <given>; <allowed>`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {given}; {allowed}")]
pub struct Error {
    /// The parameter, or the row and column of the data.
    pub place: String,
    /// What was given there.
    pub given: String,
    /// What is allowed there.
    pub allowed: String,
}

impl Error {
    /// An error from anything printable.
    pub fn input(place: impl ToString, given: impl ToString, allowed: impl ToString) -> Self {
        Self {
            place: place.to_string(),
            given: given.to_string(),
            allowed: allowed.to_string(),
        }
    }
}

/// linfa's traits ask this of the errors of every classifier.
impl From<linfa::Error> for Error {
    fn from(error: linfa::Error) -> Self {
        Self::input(
            "classifier",
            error,
            "see the documentation of linfa for what is allowed",
        )
    }
}
