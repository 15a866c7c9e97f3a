//! Parallel tasks that hold memory: each thread works on one of them at a time.
//!
//! A thread of a rayon pool that waits for others may start any other task of the pool, so several tasks of one thread can be in memory. Here, a thread that
//! works on a task only helps with the parallel parts of tasks that have begun.

use crate::error::Result;
use std::cell::Cell;
use std::sync::{Mutex, MutexGuard, PoisonError};

thread_local! {
    /// Whether the thread works on a task.
    static IS_BUSY: Cell<bool> = const { Cell::new(false) };
}

/// Tasks that remain with the first error, and the function that works on a task.
struct Queue<I, F> {
    left: Mutex<(I, Result<()>)>,
    run: F,
}

/// Runs all tasks, which begin in the given order. The number of tasks in memory is at most the number of threads; tasks within a task count with it, as
/// long as each is run by the thread of the outer task or by an idle thread.
///
/// # Errors
/// If a task fails; no other task then begins.
pub(crate) fn run_at_once<T: Send>(
    tasks: impl IntoIterator<Item = T, IntoIter: Send>,
    run: impl Fn(T) -> Result<()> + Sync,
) -> Result<()> {
    let queue = Queue {
        left: Mutex::new((tasks.into_iter(), Ok(()))),
        run,
    };
    rayon::scope(|scope| queue.work(scope));
    let left = queue.left.into_inner();
    left.unwrap_or_else(PoisonError::into_inner).1
}

impl<T: Send, I: Iterator<Item = T> + Send, F: Fn(T) -> Result<()> + Sync> Queue<I, F> {
    fn left(&self) -> MutexGuard<'_, (I, Result<()>)> {
        self.left.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn next(&self) -> Option<T> {
        let (tasks, ended) = &mut *self.left();
        ended.is_ok().then(|| tasks.next())?
    }

    /// Works on tasks until none is left. Before each task, idle threads are asked for help.
    fn work<'s>(&'s self, scope: &rayon::Scope<'s>) {
        let was_busy = IS_BUSY.replace(true);
        while let Some(task) = self.next() {
            scope.spawn(|scope| {
                if !IS_BUSY.get() {
                    self.work(scope);
                }
            });
            if let Err(error) = (self.run)(task) {
                let ended = &mut self.left().1;
                if ended.is_ok() {
                    *ended = Err(error);
                }
            }
        }
        IS_BUSY.set(was_busy);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use rayon::prelude::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn no_more_tasks_than_threads_are_in_memory_and_all_are_run() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build();
        let [live, inner, most, most_inner, n] = [0; 5].map(AtomicUsize::new);
        let count = |live: &AtomicUsize, most: &AtomicUsize| {
            let now = live.fetch_add(1, Ordering::SeqCst) + 1;
            most.fetch_max(now, Ordering::SeqCst);
        };
        // Waiting for the parts of a task makes threads look for other work.
        let parts = || {
            (0..64)
                .into_par_iter()
                .for_each(|_| std::thread::yield_now())
        };
        let task = |_| {
            count(&live, &most);
            run_at_once(0..5, |_| {
                count(&inner, &most_inner);
                parts();
                n.fetch_add(1, Ordering::SeqCst);
                inner.fetch_sub(1, Ordering::SeqCst);
                Ok(())
            })?;
            parts();
            live.fetch_sub(1, Ordering::SeqCst);
            Ok(())
        };
        pool.unwrap().install(|| run_at_once(0..100, task)).unwrap();
        let read = |count: &AtomicUsize| count.load(Ordering::SeqCst);
        assert_eq!(read(&n), 500);
        assert!(
            read(&most) <= 3 && read(&most_inner) <= 3,
            "{most:?} {most_inner:?}"
        );
    }

    #[test]
    fn after_an_error_no_task_begins() {
        let begun = AtomicUsize::new(0);
        let failed = run_at_once(0..1000, |task| {
            begun.fetch_add(1, Ordering::SeqCst);
            match task {
                0 => Err(Error::input("task", task, "others")),
                _ => {
                    std::thread::sleep(std::time::Duration::from_millis(1));
                    Ok(())
                }
            }
        });
        assert!(failed.is_err() && begun.into_inner() < 1000);
    }
}
