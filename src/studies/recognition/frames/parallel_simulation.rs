//! Simulation of frames on all threads, with results in a fixed order.

use crate::engine::progress::Progress;
use crate::studies::recognition::frames::frame_store::{FrameFacts, Frames};
use bubbletouch_sim::frame_coding::encode;
use ndarray::{Array2, ArrayViewMut2};
use rayon::prelude::*;
use std::time::Instant;

/// Approximate number of frames in one simulation task of a thread. With a smaller value, scheduling takes more time; with a larger value, the threads finish
/// at different times.
const BLOCK: usize = 32;
/// Number of tasks per thread that are simulated before their frames are stored.
const BLOCKS_A_THREAD: usize = 8;

/// Returns the number of touches that a task simulates, if each touch has `n_frames` frames.
fn block(n_frames: usize) -> usize {
    (BLOCK / n_frames.max(1)).max(1)
}

/// Returns the number of touches to simulate before their frames are stored; `n_frames` is the number of frames per touch.
fn made_at_once(n_frames: usize) -> usize {
    block(n_frames) * BLOCKS_A_THREAD * rayon::current_num_threads()
}

impl Frames {
    /// Simulates the frames of touches on all threads, each of which has a workspace; results do not depend on the number of threads. For each touch, `press`
    /// writes F frames of n_values values. The function `press` returns whether the touch missed the object, and whether it saturated a taxel at its deepest
    /// point.
    pub fn make<T: Sync, W>(
        &mut self,
        touches: &[T],
        workspace: impl Fn() -> W + Sync,
        press: impl Fn(&T, &mut W, ArrayViewMut2<f32>) -> (bool, bool) + Sync,
        progress: &dyn Progress,
    ) {
        let shape = (self.facts.n_frames, self.n_values);
        for touches in touches.chunks(made_at_once(shape.0)) {
            let blocks = touches.par_chunks(block(shape.0));
            let made = blocks.map_init(&workspace, |workspace, touches: &[T]| {
                let start = Instant::now();
                let mut rows = Array2::zeros(shape);
                let mut frames = Vec::with_capacity(touches.len() * shape.0);
                let mut facts = FrameFacts::default();
                for touch in touches {
                    let (missed, saturated) = press(touch, workspace, rows.view_mut());
                    facts.n_missed += usize::from(missed);
                    facts.n_saturated += usize::from(saturated);
                    let rows = rows.outer_iter();
                    frames.extend(rows.map(|row| encode(row.to_slice().expect("a row"))));
                }
                progress.advance(touches.len() as u64);
                facts.cpu_s = start.elapsed().as_secs_f64();
                (frames, facts)
            });
            for (frames, facts) in made.collect::<Vec<_>>() {
                self.facts.n_missed += facts.n_missed;
                self.facts.n_saturated += facts.n_saturated;
                self.facts.cpu_s += facts.cpu_s;
                self.put(frames);
            }
        }
    }
}
