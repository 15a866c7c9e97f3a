//! Terminal output of the command, and handling of signals.

pub(crate) mod output;
pub(crate) mod signals;
pub(crate) mod streams;
