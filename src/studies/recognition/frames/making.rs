//! Frames made on all threads, and put down in their order.

use crate::engine::progress::Progress;
use crate::studies::recognition::frames::kept::{FrameFacts, Frames};
use bubbletouch_sim::frame_coding::encode;
use ndarray::{Array2, ArrayViewMut2};
use rayon::prelude::*;
use std::time::Instant;

/// Frames made by one thread at a time, about: large enough to hide the hand-over, small enough to share out evenly.
const BLOCK: usize = 32;
/// Blocks a thread before frames are put down.
const BLOCKS_A_THREAD: usize = 8;

/// Touches of F frames in a block.
fn block(n_frames: usize) -> usize {
    (BLOCK / n_frames.max(1)).max(1)
}

/// Touches of F frames whose frames are held before they are put down.
fn made_at_once(n_frames: usize) -> usize {
    block(n_frames) * BLOCKS_A_THREAD * rayon::current_num_threads()
}

impl Frames {
    /// Makes the frames of some touches, each thread in a workspace of its own; the same bytes at any number of threads. `press` writes a touch
    /// into its F frames (F × n_values), and says whether it met nothing, and whether it saturated a taxel when it was deepest.
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
