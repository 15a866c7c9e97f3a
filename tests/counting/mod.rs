//! Counts this thread's allocations and bytes: the test harness's own threads do not count.
// Each test file uses its part of this.
#![allow(dead_code)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

struct Counting;

thread_local! {
    static COUNT: Cell<usize> = const { Cell::new(0) };
    static LIVE: Cell<isize> = const { Cell::new(0) };
    static PEAK: Cell<isize> = const { Cell::new(0) };
    static LIMIT: Cell<isize> = const { Cell::new(isize::MAX) };
}

unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.with(|count| count.set(count.get() + 1));
        // What another thread gave may be freed here, and the other way round: so it may be below zero.
        let live = LIVE.with(|live| {
            live.set(live.get() + layout.size() as isize);
            live.get()
        });
        if live > LIMIT.with(Cell::get) {
            return std::ptr::null_mut();
        }
        PEAK.with(|peak| peak.set(peak.get().max(live)));
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        LIVE.with(|live| live.set(live.get() - layout.size() as isize));
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

/// How often `work` allocates.
pub fn allocations(work: impl FnOnce()) -> usize {
    let before = COUNT.with(Cell::get);
    work();
    COUNT.with(Cell::get) - before
}

/// How many bytes more than before `work` holds at once, at most.
pub fn peak_bytes(work: impl FnOnce()) -> usize {
    let before = LIVE.with(Cell::get);
    PEAK.with(|peak| peak.set(before));
    work();
    (PEAK.with(Cell::get) - before) as usize
}

/// What `work` returns; the process ends if it holds more than so many bytes.
pub fn limit_bytes<R>(bytes: usize, work: impl FnOnce() -> R) -> R {
    let most = LIVE.with(Cell::get) + bytes as isize;
    LIMIT.with(|limit| limit.set(most));
    let result = work();
    LIMIT.with(|limit| limit.set(isize::MAX));
    result
}
