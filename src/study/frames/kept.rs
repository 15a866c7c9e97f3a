//! Frames kept in memory, or in a temporary file and read as they are wanted.

use super::coding::{decode, most_bytes};
use crate::error::{Error, Result};
use ndarray::{Array2, Axis};
use rayon::prelude::*;
use std::fs::File;
use std::io::{BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Where frames are while they are read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum FramePlace {
    /// In memory.
    #[default]
    Memory,
    /// In a file without a name, in this folder: it is gone with the process, however that ends.
    File(PathBuf),
}

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

/// Frames one after the other, and where each begins and the last ends.
#[derive(Debug)]
struct FrameFile {
    folder: PathBuf,
    file: Mutex<File>,
    offsets: Vec<u64>,
}

impl FrameFile {
    /// One frame, encoded; several threads read.
    fn read(&self, number: usize) -> Result<Vec<u8>> {
        let [from, to] = [self.offsets[number], self.offsets[number + 1]];
        let mut bytes = vec![0; (to - from) as usize];
        let mut file = self.file.lock().unwrap_or_else(|e| e.into_inner());
        let found = file.seek(SeekFrom::Start(from));
        let found = found.and_then(|_| file.read_exact(&mut bytes));
        found.map_err(|e| Error::io(&self.folder, "read frames from", e))?;
        Ok(bytes)
    }
}

impl KeptFrames {
    /// How many.
    pub fn len(&self) -> usize {
        match &self.place {
            Place::Memory(frames) => frames.len(),
            Place::File(file) => file.offsets.len() - 1,
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
}

/// Takes frames in their order.
pub struct FrameWriter {
    n_taxels: usize,
    place: Growing,
}

enum Growing {
    Memory(Vec<Box<[u8]>>),
    File {
        folder: PathBuf,
        file: BufWriter<File>,
        offsets: Vec<u64>,
    },
}

impl FrameWriter {
    /// Into memory.
    pub fn in_memory(n_taxels: usize) -> Self {
        let place = Growing::Memory(Vec::new());
        Self { n_taxels, place }
    }

    /// Into memory or a file.
    ///
    /// # Errors
    /// No file can be made in the folder.
    pub fn new(n_taxels: usize, place: &FramePlace) -> Result<Self> {
        match place {
            FramePlace::Memory => Ok(Self::in_memory(n_taxels)),
            FramePlace::File(folder) => Self::in_file(n_taxels, folder),
        }
    }

    fn in_file(n_taxels: usize, folder: &Path) -> Result<Self> {
        std::fs::create_dir_all(folder).map_err(|e| Error::io(folder, "create folder", e))?;
        let file = tempfile::tempfile_in(folder);
        let file = file.map_err(|e| Error::io(folder, "write frames to", e))?;
        let place = Growing::File {
            folder: folder.to_owned(),
            file: BufWriter::new(file),
            offsets: vec![0],
        };
        Ok(Self { n_taxels, place })
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
            Growing::File {
                folder,
                file,
                offsets,
            } => {
                let written = file.write_all(&frame);
                written.map_err(|e| Error::io(&*folder, "write frames to", e))?;
                offsets.push(offsets[offsets.len() - 1] + frame.len() as u64);
            }
        }
        Ok(())
    }

    /// What was put, and what happened meanwhile.
    pub(super) fn finish(self, facts: super::FrameFacts) -> Result<super::Frames> {
        let place = match self.place {
            Growing::Memory(frames) => Place::Memory(frames),
            Growing::File {
                folder,
                file,
                offsets,
            } => {
                let file = file.into_inner().map_err(|e| e.into_error());
                let file = file.map_err(|e| Error::io(&folder, "write frames to", e))?;
                Place::File(FrameFile {
                    folder,
                    file: Mutex::new(file),
                    offsets,
                })
            }
        };
        let kept = KeptFrames {
            n_taxels: self.n_taxels,
            place,
        };
        Ok(super::Frames { kept, facts })
    }
}
