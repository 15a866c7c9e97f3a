//! What several work items need.

use crate::error::Result;
use std::sync::OnceLock;

/// Made by the first work item that needs it, for all. Two that need it at the same moment may both make it.
#[derive(Debug)]
pub struct Shared<T>(OnceLock<T>);

impl<T> Default for Shared<T> {
    fn default() -> Self {
        Self(OnceLock::new())
    }
}

impl<T> Shared<T> {
    /// It, made if nobody has made it yet.
    ///
    /// # Errors
    /// What it cannot be made for; the next one tries again.
    pub fn get(&self, make: impl FnOnce() -> Result<T>) -> Result<&T> {
        if let Some(made) = self.0.get() {
            return Ok(made);
        }
        let made = make()?;
        Ok(self.0.get_or_init(|| made))
    }
}
