//! Threads of long calls, and Ctrl-C during them.
//!
//! All parallel work runs in one pool. A process that was forked (`multiprocessing` on Linux) has none of its parent's threads, so it
//! gets a pool of its own at its first such call.

use crate::errors::guarded;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Between two looks for Ctrl-C. Larger: a call is left later; smaller: more time is spent looking, 1 µs each.
const PATIENCE: Duration = Duration::from_millis(20);

static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// The pool of this process, with a thread for each core.
///
/// # Errors
/// The system gives no threads.
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
        // Its threads are not here, so nobody would end them.
        std::mem::forget(parents);
    }
    Ok(pool)
}

/// Says now and then whether somebody pressed Ctrl-C.
pub struct Interrupt {
    looked: Instant,
}

impl Interrupt {
    /// From now on.
    pub fn new() -> Self {
        Self {
            looked: Instant::now(),
        }
    }

    /// Lets Python handle its signals, if it is time to.
    ///
    /// # Errors
    /// What the handler raises, `KeyboardInterrupt` if it is Python's own.
    pub fn check(&mut self) -> PyResult<()> {
        if self.looked.elapsed() < PATIENCE {
            return Ok(());
        }
        let checked = Python::attach(|py| py.check_signals());
        self.looked = Instant::now();
        checked
    }
}

/// Whether a long call should end early; what it runs in asks now and then.
#[derive(Clone, Default)]
pub struct Stop(Arc<AtomicBool>);

/// What unwinds a call that was told to stop.
struct Stopped;

impl Stop {
    /// Ends the call here if it should: unwinds to [`aside`].
    pub fn end_if_told(&self) {
        if self.is_told() {
            resume_unwind(Box::new(Stopped));
        }
    }

    /// Whether it should.
    pub fn is_told(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// It should.
    pub fn tell(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Runs a long call in the pool, without the interpreter's lock, while this thread looks for Ctrl-C.
///
/// After Ctrl-C it returns at once; the call ends where it next asks [`Stop`], and one that never asks ends by itself, unheard.
///
/// # Errors
/// The call's own; `KeyboardInterrupt`; a panic of the call.
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
            // Nobody hears it after Ctrl-C.
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
