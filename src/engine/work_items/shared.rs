//! Data that several work items share.

use crate::error::Result;
use std::sync::OnceLock;

/// Data that several work items need, computed by the first item that needs them. Two items that need the data at the same time may both compute them.
#[derive(Debug)]
pub struct Shared<T>(OnceLock<T>);

impl<T> Default for Shared<T> {
    fn default() -> Self {
        Self(OnceLock::new())
    }
}

impl<T> Shared<T> {
    /// Returns the shared data; computes them with `make` if they do not exist yet.
    ///
    /// # Errors
    /// If `make` fails; the next call tries again.
    pub fn get(&self, make: impl FnOnce() -> Result<T>) -> Result<&T> {
        if let Some(made) = self.0.get() {
            return Ok(made);
        }
        let made = make()?;
        Ok(self.0.get_or_init(|| made))
    }
}
