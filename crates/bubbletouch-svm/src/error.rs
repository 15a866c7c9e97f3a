//! Error type for invalid input.

/// Result type of this crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Error for invalid input: the place, the given value, and the allowed values.
///
/// The message has the form `<place>: <given>; <allowed>`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {given}; {allowed}")]
#[non_exhaustive]
pub struct Error {
    /// Name of the parameter, or row and column of the data.
    pub place: String,
    /// Description of the rejected value.
    pub given: String,
    /// Description of the allowed values.
    pub allowed: String,
}

impl Error {
    /// Creates an error from a place, a given value and the allowed values.
    pub fn input(place: impl ToString, given: impl ToString, allowed: impl ToString) -> Self {
        Self {
            place: place.to_string(),
            given: given.to_string(),
            allowed: allowed.to_string(),
        }
    }
}

/// Checks that a parameter is a finite number above 0.
///
/// # Errors
/// If the value is 0, negative, NaN or infinite.
pub(crate) fn check_above_zero(place: &str, value: f64) -> Result<()> {
    match value > 0.0 && value.is_finite() {
        true => Ok(()),
        false => Err(Error::input(
            place,
            value,
            "a finite number above 0 is allowed",
        )),
    }
}

/// Converts any error of a classifier from outside of this crate.
impl From<Box<dyn std::error::Error + Send + Sync>> for Error {
    fn from(error: Box<dyn std::error::Error + Send + Sync>) -> Self {
        match error.downcast() {
            Ok(ours) => *ours,
            Err(other) => Self::input("classifier", other, "a classifier without an error"),
        }
    }
}

/// Converts a linfa error into an input error, as linfa's traits require.
impl From<linfa::Error> for Error {
    fn from(error: linfa::Error) -> Self {
        Self::input(
            "classifier",
            error,
            "see the documentation of linfa for what is allowed",
        )
    }
}
