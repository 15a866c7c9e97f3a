//! Frames made on all threads, and put down in their order.

use super::coding::encode;
use super::kept::FrameWriter;
use super::{FrameFacts, Frames};
use crate::error::Result;
use crate::study::progress::Progress;
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
pub fn made_at_once(n_frames: usize) -> usize {
    block(n_frames) * BLOCKS_A_THREAD * rayon::current_num_threads()
}

/// What presses touches, with a workspace that each thread has of its own.
pub trait Press: Sync {
    /// A touch to make.
    type Touch: Sync;
    /// What a thread works in.
    type Workspace;

    /// A workspace for a thread.
    fn workspace(&self) -> Self::Workspace;

    /// Writes a touch into its F frames (F × n_taxels, metres); whether it met nothing, and whether it saturated a taxel when it
    /// was deepest.
    fn press(
        &self,
        touch: &Self::Touch,
        workspace: &mut Self::Workspace,
        rows: ArrayViewMut2<f32>,
    ) -> (bool, bool);
}

/// Frames in the making.
pub struct Making<'a> {
    writer: FrameWriter,
    facts: FrameFacts,
    progress: &'a dyn Progress,
}

/// What a block of touches gave.
struct Block {
    frames: Vec<Box<[u8]>>,
    n_missed: usize,
    n_saturated: usize,
    cpu_s: f64,
}

impl<'a> Making<'a> {
    /// Of `n_frames` a touch.
    pub fn new(writer: FrameWriter, n_frames: usize, progress: &'a dyn Progress) -> Self {
        let facts = FrameFacts {
            n_frames,
            ..FrameFacts::default()
        };
        Self {
            writer,
            facts,
            progress,
        }
    }

    /// Makes touches; the same bytes at any number of threads.
    pub fn make<P: Press>(&mut self, press: &P, touches: &[P::Touch]) -> Result<()> {
        let n_frames = self.facts.n_frames;
        for touches in touches.chunks(made_at_once(n_frames)) {
            let blocks: Vec<Block> = touches
                .par_chunks(block(n_frames))
                .map_init(
                    || press.workspace(),
                    |work, touches| self.block(press, touches, work),
                )
                .collect();
            for block in blocks {
                self.facts.n_missed += block.n_missed;
                self.facts.n_saturated += block.n_saturated;
                self.facts.cpu_s += block.cpu_s;
                for frame in block.frames {
                    self.writer.put(frame)?;
                }
            }
        }
        Ok(())
    }

    fn block<P: Press>(&self, press: &P, touches: &[P::Touch], work: &mut P::Workspace) -> Block {
        let start = Instant::now();
        let mut rows = Array2::zeros((self.facts.n_frames, self.writer.n_taxels()));
        let mut block = Block {
            frames: Vec::with_capacity(touches.len() * self.facts.n_frames),
            n_missed: 0,
            n_saturated: 0,
            cpu_s: 0.0,
        };
        let mut bytes = Vec::new();
        for touch in touches {
            let (missed, saturated) = press.press(touch, work, rows.view_mut());
            block.n_missed += usize::from(missed);
            block.n_saturated += usize::from(saturated);
            for row in rows.outer_iter() {
                bytes.clear();
                encode(row.to_slice().expect("rows of a new array"), &mut bytes);
                block.frames.push(bytes.as_slice().into());
            }
        }
        self.progress.advance(touches.len() as u64);
        block.cpu_s = start.elapsed().as_secs_f64();
        block
    }

    /// All of them.
    pub fn finish(self) -> Result<Frames> {
        self.writer.finish(self.facts)
    }
}
