//! Work that may fail without ending the run that it is part of.

use crate::error::Result;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Does some work. What goes wrong in it is said in words, a panic too: a defect in one piece is no reason to lose a night's work on the
/// others. If the first failure is to end the run, it is the error.
pub fn attempt<T>(
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

/// What a panic said.
fn words(panic: &(dyn std::any::Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("it did not say why")
}
