//! Execution of a single work item, such that an error or panic does not end the run.

use crate::error::Result;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs `work` and returns its result. An error or a panic is converted to a message, so that one failed work item does not end a long run. If `fail_fast` is true, a failure is returned as an error.
pub fn run_isolated<T>(
    fail_fast: bool,
    work: impl FnOnce() -> Result<T>,
) -> Result<std::result::Result<T, String>> {
    if fail_fast {
        return work().map(Ok);
    }
    Ok(match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(found)) => Ok(found),
        Ok(Err(error)) => Err(error.to_string()),
        Err(panic) => Err(format!("a defect of the program: {}", words(&*panic))),
    })
}

/// Returns the message of a panic as text.
fn words(panic: &(dyn std::any::Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("it did not say why")
}
