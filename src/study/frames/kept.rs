//! Frames kept in memory, or in a file and read as they are wanted.

use super::coding::{decode, most_bytes};
use super::frame_file::{FrameFile, FrameFileWriter};
use crate::error::Result;
use ndarray::{Array2, Axis};
use rayon::prelude::*;
use std::path::Path;

/// Frames of n_taxels metres of deflection each; only touched taxels are kept.
#[derive(Debug)]
pub struct KeptFrames {
    n_taxels: usize,
    place: Place,
}

#[derive(Debug)]
enum Place {
    Memory(Vec<Box<[u8]>>),
    File(FrameFile),
}

impl KeptFrames {
    /// Those of a file.
    pub(super) fn of_file(file: FrameFile) -> Self {
        Self {
            n_taxels: file.facts().n_taxels,
            place: Place::File(file),
        }
    }

    /// Reads them into memory if they take at most so many bytes.
    pub(super) fn within(mut self, most: u64) -> Result<Self> {
        if let Place::File(file) = &self.place
            && file.n_bytes() <= most
        {
            self.place = Place::Memory(file.read_all()?);
        }
        Ok(self)
    }

    /// Lets their file go with them.
    pub(super) fn remove_when_done(&mut self) {
        if let Place::File(file) = &mut self.place {
            file.remove_when_done();
        }
    }

    /// How many.
    pub fn len(&self) -> usize {
        match &self.place {
            Place::Memory(frames) => frames.len(),
            Place::File(file) => file.len(),
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Taxels of each.
    pub fn n_taxels(&self) -> usize {
        self.n_taxels
    }

    /// Writes frame `number` into `frame` (n_taxels, metres).
    ///
    /// # Errors
    /// The file cannot be read.
    ///
    /// # Panics
    /// There is no such frame, or `frame` has another length.
    pub fn read(&self, number: usize, frame: &mut [f64]) -> Result<()> {
        assert_eq!(frame.len(), self.n_taxels, "a value a taxel");
        match &self.place {
            Place::Memory(frames) => decode(&frames[number], frame),
            Place::File(file) => decode(&file.read(number)?, frame),
        }
        Ok(())
    }

    /// All frames, len × n_taxels metres.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn to_array(&self) -> Result<Array2<f64>> {
        let mut array = Array2::zeros((self.len(), self.n_taxels));
        array
            .axis_iter_mut(Axis(0))
            .into_par_iter()
            .enumerate()
            .try_for_each(|(number, mut row)| {
                self.read(number, row.as_slice_mut().expect("rows of a new array"))
            })?;
        Ok(array)
    }

    /// Every frame as it is kept, in order.
    pub(super) fn in_memory(&self) -> Option<&[Box<[u8]>]> {
        match &self.place {
            Place::Memory(frames) => Some(frames),
            Place::File(_) => None,
        }
    }
}

/// Takes frames in their order.
pub struct FrameWriter {
    n_taxels: usize,
    what: String,
    place: Growing,
}

enum Growing {
    Memory(Vec<Box<[u8]>>),
    File(Box<FrameFileWriter>),
}

impl FrameWriter {
    /// Into memory; `what` they are of, in words.
    pub fn in_memory(n_taxels: usize, what: &str) -> Self {
        Self {
            n_taxels,
            what: what.to_owned(),
            place: Growing::Memory(Vec::new()),
        }
    }

    /// Into a file, which is there once all frames are.
    pub(super) fn in_file(path: &Path, n_taxels: usize, what: &str) -> Result<Self> {
        Ok(Self {
            place: Growing::File(Box::new(FrameFileWriter::create(path)?)),
            ..Self::in_memory(n_taxels, what)
        })
    }

    /// Taxels of a frame.
    pub fn n_taxels(&self) -> usize {
        self.n_taxels
    }

    /// The next frame, encoded.
    pub(super) fn put(&mut self, frame: Box<[u8]>) -> Result<()> {
        debug_assert!(frame.len() <= most_bytes(self.n_taxels));
        match &mut self.place {
            Growing::Memory(frames) => frames.push(frame),
            Growing::File(file) => file.put(&frame)?,
        }
        Ok(())
    }

    /// What was put, and what happened meanwhile.
    pub(super) fn finish(self, mut facts: super::FrameFacts) -> Result<super::Frames> {
        facts.n_taxels = self.n_taxels;
        facts.what = self.what;
        let place = match self.place {
            Growing::Memory(frames) => Place::Memory(frames),
            Growing::File(file) => Place::File(file.commit(&facts)?),
        };
        let kept = KeptFrames {
            n_taxels: self.n_taxels,
            place,
        };
        Ok(super::Frames { kept, facts })
    }
}
