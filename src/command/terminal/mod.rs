//! What the command prints, and signals.

pub(crate) mod output;
pub(crate) mod signals;
pub(crate) mod streams;
