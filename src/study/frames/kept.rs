//! Frames kept in memory, or in a temporary file and read as they are wanted.

use super::FrameFacts;
use crate::error::{Error, Result};
use bubbletouch_sim::frame_coding::decode;
use ndarray::{Array2, Axis};
use rayon::prelude::*;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::PathBuf;
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

/// (n_touches · F) frames of an array, n_values each (a metre of deflection a taxel, or more channels), and what happened while they were made: object by object, touch by
/// touch, the deepest frame of a touch last. Only touched taxels are kept.
#[derive(Debug)]
pub struct Frames {
    /// What happened.
    pub facts: FrameFacts,
    /// Numbers of each.
    pub n_values: usize,
    place: Place,
}

#[derive(Debug)]
enum Place {
    Memory(Vec<Box<[u8]>>),
    /// Frames one after the other, and where each begins and the last ends.
    File {
        folder: PathBuf,
        file: Mutex<File>,
        offsets: Vec<u64>,
    },
}

impl Frames {
    /// None yet, of so many a touch.
    ///
    /// # Errors
    /// No file can be made in the folder.
    pub fn new((n_values, n_frames): (usize, usize), place: &FramePlace) -> Result<Self> {
        let place = match place {
            FramePlace::Memory => Place::Memory(Vec::new()),
            FramePlace::File(folder) => {
                std::fs::create_dir_all(folder)
                    .map_err(|e| Error::io(folder, "create folder", e))?;
                let file = tempfile::tempfile_in(folder);
                let file = file.map_err(|e| Error::io(folder, "write frames to", e))?;
                Place::File {
                    folder: folder.clone(),
                    file: Mutex::new(file),
                    offsets: vec![0],
                }
            }
        };
        let facts = FrameFacts {
            n_frames,
            ..FrameFacts::default()
        };
        Ok(Self {
            facts,
            n_values,
            place,
        })
    }

    /// Takes the next frames, encoded.
    pub(super) fn put(&mut self, encoded: Vec<Box<[u8]>>) -> Result<()> {
        match &mut self.place {
            Place::Memory(frames) => frames.extend(encoded),
            Place::File {
                folder,
                file,
                offsets,
            } => {
                for frame in &encoded {
                    offsets.push(offsets[offsets.len() - 1] + frame.len() as u64);
                }
                let file = file.get_mut().unwrap_or_else(|e| e.into_inner());
                let written = file.write_all(&encoded.concat());
                written.map_err(|e| Error::io(&*folder, "write frames to", e))?;
            }
        }
        Ok(())
    }

    /// How many.
    pub fn n(&self) -> usize {
        match &self.place {
            Place::Memory(frames) => frames.len(),
            Place::File { offsets, .. } => offsets.len() - 1,
        }
    }

    /// Writes frame `number` into `frame` (n_values); several threads read.
    ///
    /// # Errors
    /// The file cannot be read.
    ///
    /// # Panics
    /// There is no such frame, or `frame` has another length.
    pub fn read(&self, number: usize, frame: &mut [f64]) -> Result<()> {
        assert_eq!(frame.len(), self.n_values, "all values");
        match &self.place {
            Place::Memory(frames) => decode(&frames[number], frame),
            Place::File {
                folder,
                file,
                offsets,
            } => {
                let [from, to] = [offsets[number], offsets[number + 1]];
                let mut bytes = vec![0; (to - from) as usize];
                let mut file = file.lock().unwrap_or_else(|e| e.into_inner());
                let found = file.seek(SeekFrom::Start(from));
                let found = found.and_then(|_| file.read_exact(&mut bytes));
                drop(file);
                found.map_err(|e| Error::io(folder, "read frames from", e))?;
                decode(&bytes, frame);
            }
        }
        Ok(())
    }

    /// All frames, n × n_values.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn to_array(&self) -> Result<Array2<f64>> {
        let mut array = Array2::zeros((self.n(), self.n_values));
        let rows = array.axis_iter_mut(Axis(0)).into_par_iter().enumerate();
        rows.try_for_each(|(number, mut row)| {
            self.read(number, row.as_slice_mut().expect("rows of a new array"))
        })?;
        Ok(array)
    }
}
