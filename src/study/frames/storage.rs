//! Where the frames of an array come from, and where they are while cells read them.

use super::Frames;
use super::cache::TouchCache;
use super::coding::most_bytes;
use super::kept::{FrameWriter, KeptFrames};
use crate::error::Result;
use crate::study::content_hash::ContentHash;
use crate::study::progress::Progress;
use crate::study::provenance::SOURCE;
use crate::study::runner::describe;
use crate::study::touch_set::TouchSet;
use crate::world::Patch;
use std::sync::OnceLock;

/// Processor-seconds from which on touches are worth a file: reading them back takes less than a tenth.
const WORTH_KEEPING_S: f64 = 2.0;

/// Touches and their key, which is computed once: when a cache first asks for it.
pub struct KeyedTouches<'a> {
    touched: &'a dyn TouchSet,
    key: OnceLock<String>,
}

impl<'a> KeyedTouches<'a> {
    /// The key is not computed yet.
    pub fn new(touched: &'a dyn TouchSet) -> Self {
        let key = OnceLock::new();
        Self { touched, key }
    }

    fn key(&self) -> &str {
        self.key.get_or_init(|| self.touched.key())
    }
}

/// How frames are kept.
#[derive(Clone, Debug)]
pub struct FrameStorage {
    cache: Option<TouchCache>,
    memory: u64,
}

impl FrameStorage {
    /// In memory, and forgotten afterwards.
    pub fn in_memory() -> Self {
        Self {
            cache: None,
            memory: u64::MAX,
        }
    }

    /// In a cache, from one run to the next; in memory up to so many bytes, read from their file beyond.
    pub fn new(cache: TouchCache, memory: u64) -> Self {
        Self {
            cache: Some(cache),
            memory,
        }
    }

    /// The frames of touches on an array, F each: kept ones, or new ones; also where those kept are damaged.
    ///
    /// # Errors
    /// A file of the cache cannot be read or written.
    pub fn frames(
        &self,
        touches: &KeyedTouches,
        (patch, n_frames): (&Patch, usize),
        progress: &dyn Progress,
    ) -> Result<Frames> {
        let touched = touches.touched;
        let n_taxels = patch.grid.n_taxels();
        let n_touches = touched.labels().len();
        let what = what(n_touches, patch, n_frames);
        let in_memory = || FrameWriter::in_memory(n_taxels, &what);
        let simulate = |writer| touched.simulate((patch, n_frames), writer, progress);
        let Some(cache) = &self.cache else {
            return simulate(in_memory());
        };
        let key = key(touches, patch, n_frames);
        if let Some(file) = cache.open(&key)? {
            progress.advance(n_touches as u64);
            return Ok(Frames {
                facts: file.facts().clone(),
                kept: KeptFrames::of_file(file).within(self.memory)?,
            });
        }
        if (n_touches * n_frames * most_bytes(n_taxels)) as u64 <= self.memory {
            let frames = simulate(in_memory())?;
            if frames.facts.cpu_s >= WORTH_KEEPING_S {
                cache.keep(&key, &frames)?;
            }
            return Ok(frames);
        }
        cache.prepare()?;
        let path = cache.path(&key);
        let mut frames = simulate(FrameWriter::in_file(&path, n_taxels, &what)?)?;
        match cache.may_keep(&path) {
            true => cache.make_room()?,
            false => frames.kept.remove_when_done(),
        }
        frames.kept = frames.kept.within(self.memory)?;
        Ok(frames)
    }
}

/// SHA-256 of all that frames depend on, the program's own source included.
fn key(touches: &KeyedTouches, patch: &Patch, n_frames: usize) -> String {
    let hash = ContentHash::default().bytes("touches 1\n").bytes(SOURCE);
    let hash = hash.bytes(format!("\n{patch:?}\n{n_frames} frames\n"));
    hash.bytes(touches.key()).hex()
}

fn what(n_touches: usize, patch: &Patch, n_frames: usize) -> String {
    let array = describe(patch);
    match n_frames {
        1 => format!("{n_touches} touches, {array}"),
        n => format!("{n_touches} touches of {n} frames, {array}"),
    }
}
