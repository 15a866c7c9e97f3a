//! Parallel processing of batches; each thread has its own scratch memory.

use crate::errors::bad_input;
use crate::threads::{Interrupt, pool};
use pyo3::prelude::*;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

/// Maximum number of items of a batch that a thread takes at one time. With a larger value, threads finish at different times; with a smaller value, threads
/// wait for each other more often.
const MAX_AT_ONCE: usize = 16;
/// Minimum number of items of a batch per thread. For fewer items, waking a thread (5 to 50 µs) takes too long.
const LEAST_PER_THREAD: usize = 4;

/// Returns the number of threads that a Python call requests; `None` means all threads of the pool.
///
/// # Errors
/// If the number is zero or less.
pub fn n_threads(asked: Option<i64>) -> PyResult<Option<usize>> {
    let Some(asked) = asked else {
        return Ok(None);
    };
    match usize::try_from(asked) {
        Ok(n) if n > 0 => Ok(Some(n)),
        _ => Err(bad_input(
            "threads",
            asked,
            "at least 1, or None for all cores",
        )),
    }
}

/// Store of scratch memory that successive calls of a method reuse.
pub struct Spare<S>(Mutex<Vec<S>>);

impl<S> Spare<S> {
    /// Creates an empty store of scratch memory.
    pub const fn new() -> Self {
        Self(Mutex::new(Vec::new()))
    }

    /// Takes scratch memory out of the store; returns `None` if the store is empty.
    pub fn take(&self) -> Option<S> {
        self.0.lock().ok()?.pop()
    }

    /// Puts scratch memory into the store.
    pub fn give_back(&self, scratch: S) {
        if let Ok(mut spare) = self.0.lock() {
            spare.push(scratch);
        }
    }
}

/// Processes the items of a batch on several threads, without the interpreter's lock. For each item, `work` receives its number, the item and the thread's
/// scratch memory. The calling thread also processes items, and checks for Ctrl-C.
///
/// # Errors
/// Returns the first error of `work`, ordered by item number among the started items, or the exception of Ctrl-C.
pub fn for_each<T: Send, S: Send>(
    py: Python,
    items: Vec<T>,
    threads: Option<usize>,
    spare: &Spare<S>,
    new_scratch: impl Fn() -> S + Sync,
    work: impl Fn(usize, T, &mut S) -> PyResult<()> + Sync,
) -> PyResult<()> {
    let n_items = items.len();
    py.detach(|| {
        let most = n_items.div_ceil(LEAST_PER_THREAD);
        let scratch = || spare.take().unwrap_or_else(&new_scratch);
        if most <= 1 || threads == Some(1) {
            let (mut scratch, mut interrupt) = (scratch(), Interrupt::new());
            let worked = items
                .into_iter()
                .enumerate()
                .try_for_each(|(number, item)| {
                    work(number, item, &mut scratch)?;
                    interrupt.check()
                });
            spare.give_back(scratch);
            return worked;
        }
        let pool = pool()?;
        let n_threads = threads.unwrap_or_else(|| pool.current_num_threads());
        let n_threads = n_threads.min(most);
        let at_once = (n_items / (4 * n_threads)).clamp(1, MAX_AT_ONCE);
        let queue = Mutex::new(items.into_iter().enumerate());
        let failed: Mutex<Option<(usize, PyErr)>> = Mutex::new(None);
        let is_over = AtomicBool::new(false);
        let fail = |number: usize, error: PyErr| {
            is_over.store(true, Ordering::Relaxed);
            if let Ok(mut failed) = failed.lock()
                && failed.as_ref().is_none_or(|(first, _)| number < *first)
            {
                *failed = Some((number, error));
            }
        };
        let run = |mut interrupt: Option<Interrupt>| {
            let mut scratch = scratch();
            let mut taken = Vec::with_capacity(at_once);
            while !is_over.load(Ordering::Relaxed) {
                match queue.lock() {
                    Ok(mut queue) => taken.extend(queue.by_ref().take(at_once)),
                    Err(_) => break,
                }
                if taken.is_empty() {
                    break;
                }
                for (number, item) in taken.drain(..) {
                    if let Err(error) = work(number, item, &mut scratch) {
                        fail(number, error);
                        break;
                    }
                    if let Some(Err(error)) = interrupt.as_mut().map(Interrupt::check) {
                        fail(0, error);
                        break;
                    }
                }
            }
            spare.give_back(scratch);
        };
        pool.in_place_scope(|scope| {
            for _ in 1..n_threads {
                scope.spawn(|_| run(None));
            }
            run(Some(Interrupt::new()));
        });
        match failed.into_inner() {
            Ok(Some((_, error))) => Err(error),
            _ => Ok(()),
        }
    })
}
