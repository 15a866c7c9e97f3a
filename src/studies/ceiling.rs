//! Limit of the memory that a run may use.

use crate::engine::work_items::scale::Scale;
use crate::error::{Error, Result};
use crate::inputs::memory::GIB;

/// Returns the largest number of threads for which the memory of a study stays within the limit `ceiling`, bytes. If there is no limit, returns the number of
/// all threads.
///
/// # Errors
/// If even one work item at a time exceeds the limit.
pub fn threads_within(scale: &Scale, ceiling: Option<u64>) -> Result<usize> {
    let Some(ceiling) = ceiling else {
        return Ok(rayon::current_num_threads());
    };
    scale.n_at_once(ceiling as f64).ok_or_else(|| {
        Error::input(
            "memory",
            format!("a ceiling of {:.2} GiB", ceiling as f64 / GIB),
            format!(
                "at least {:.2} GiB for this study; fewer touches, frames, taxels or measurements take less",
                scale.least_bytes() / GIB
            ),
        )
    })
}

/// Runs `work` on the number of threads that the memory limit allows. The result does not depend on the number of threads.
///
/// # Errors
/// If [`threads_within`] or `work` fails.
pub fn within_memory<T: Send>(
    scale: &Scale,
    ceiling: Option<u64>,
    work: impl FnOnce() -> Result<T> + Send,
) -> Result<T> {
    let n_threads = threads_within(scale, ceiling)?;
    if n_threads == rayon::current_num_threads() {
        return work();
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads);
    let pool = pool
        .build()
        .map_err(|error| Error::input("threads", error, "a number that the system can start"))?;
    pool.install(work)
}
