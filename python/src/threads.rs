//! Thread pool for long calls, and handling of Ctrl-C.
//!
//! All parallel work runs in one pool. A forked process (`multiprocessing` on Linux) inherits no threads, so it creates its own pool at its first long call.

use crate::errors::guarded;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Time between two checks for Ctrl-C. With a longer time, calls end later after Ctrl-C; with a shorter time, the checks (1 µs each) take more time.
const PATIENCE: Duration = Duration::from_millis(20);

static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Returns the thread pool of this process, with one thread per core.
///
/// # Errors
/// If the system cannot create threads.
pub fn pool() -> PyResult<Arc<ThreadPool>> {
    let process = std::process::id();
    let mut kept = POOL.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    if let Some((of, pool)) = &*kept
        && *of == process
    {
        return Ok(Arc::clone(pool));
    }
    let pool = ThreadPoolBuilder::new()
        .build()
        .map_err(|error| pyo3::exceptions::PyOSError::new_err(error.to_string()))?;
    let pool = Arc::new(pool);
    if let Some((_, parents)) = kept.replace((process, Arc::clone(&pool))) {
        // The threads of the parent's pool do not exist in this process and cannot be ended, so the pool is not dropped.
        std::mem::forget(parents);
    }
    Ok(pool)
}

/// Runs a call on the threads of the pool, without the interpreter's lock.
///
/// # Errors
/// If the system cannot create threads.
pub fn in_pool<T: Send>(py: Python, call: impl FnOnce() -> T + Send) -> PyResult<T> {
    let pool = pool()?;
    Ok(py.detach(|| pool.install(call)))
}

/// Periodic check for Ctrl-C during a long call.
pub struct Interrupt {
    looked: Instant,
}

impl Interrupt {
    /// Creates a check whose first check is due after a whole period.
    pub fn new() -> Self {
        Self {
            looked: Instant::now(),
        }
    }

    /// Handles Python's signals if the period has elapsed.
    ///
    /// # Errors
    /// Returns the exception of the signal handler; Python's own handler raises `KeyboardInterrupt`.
    pub fn check(&mut self) -> PyResult<()> {
        if self.looked.elapsed() < PATIENCE {
            return Ok(());
        }
        let checked = Python::attach(|py| py.check_signals());
        self.looked = Instant::now();
        checked
    }
}

/// Flag that stops a long call early; the call checks it periodically.
#[derive(Clone, Default)]
pub struct Stop(Arc<AtomicBool>);

/// Payload of the panic that ends a stopped call.
struct Stopped;

impl Stop {
    /// If the stop was requested, ends the call by a panic that [`aside`] catches.
    pub fn end_if_told(&self) {
        if self.is_told() {
            resume_unwind(Box::new(Stopped));
        }
    }

    /// Returns whether another thread has requested the stop.
    pub fn is_told(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Requests that the call stops at its next check.
    pub fn tell(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Runs a long call in the pool, without the interpreter's lock, while this thread checks for Ctrl-C.
///
/// After Ctrl-C, the function returns at once. The call ends at its next check of [`Stop`]. A call without checks runs to its end, and its result is dropped.
///
/// # Errors
/// Returns the errors of the call, `KeyboardInterrupt` after Ctrl-C, or an error after a panic of the call.
pub fn aside<T: Send + 'static>(
    py: Python,
    call: impl FnOnce(&Stop) -> T + Send + 'static,
) -> PyResult<T> {
    let pool = pool()?;
    let stop = Stop::default();
    let (sender, receiver) = channel();
    let told = stop.clone();
    py.detach(move || {
        pool.spawn(move || {
            let called = catch_unwind(AssertUnwindSafe(|| call(&told)));
            // After Ctrl-C, there is no receiver.
            let _ = sender.send(called);
        });
        loop {
            match receiver.recv_timeout(PATIENCE) {
                Ok(Ok(value)) => return Ok(value),
                Ok(Err(payload)) if payload.is::<Stopped>() => {
                    return Err(PyKeyboardInterrupt::new_err(()));
                }
                Ok(Err(payload)) => return guarded(|| resume_unwind(payload)),
                Err(RecvTimeoutError::Timeout) => {
                    let checked = Python::attach(|py| py.check_signals());
                    if let Err(error) = checked {
                        stop.tell();
                        return Err(error);
                    }
                }
                Err(RecvTimeoutError::Disconnected) => {
                    return guarded(|| panic!("a long call was lost"));
                }
            }
        }
    })
}
