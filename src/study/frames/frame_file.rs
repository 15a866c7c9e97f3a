//! A file of frames, sealed as all files of a cache are.
//!
//! | bytes | what |
//! |---|---|
//! | … | the frames, one after the other |
//! | 8 (n + 1) | where each begins, and the last ends, u64 |
//! | … | [`FrameFacts`], JSON |
//! | 8, 8 | n; bytes of the facts |
//! | … | the seal |

use super::FrameFacts;
use super::coding::most_bytes;
use crate::error::{Error, Result};
use crate::study::sealed::{self, Checked, SealedFile, Unsealed};
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// The version of this form.
const KIND: &str = "touches 2";
/// Bytes between the facts and the seal.
const TAIL: u64 = 8 + 8;

/// A file of frames in the making; dropped before it is whole, it leaves nothing behind.
pub struct FrameFileWriter {
    path: PathBuf,
    file: SealedFile,
    at: u64,
    offsets: Vec<u64>,
}

impl FrameFileWriter {
    pub fn create(path: &Path) -> Result<Self> {
        Ok(Self {
            path: path.to_owned(),
            file: SealedFile::create(path, KIND)?,
            at: 0,
            offsets: vec![0],
        })
    }

    fn write(&mut self, bytes: &[u8]) -> Result<()> {
        self.at += bytes.len() as u64;
        self.file.write(bytes)
    }

    /// The next frame.
    pub fn put(&mut self, frame: &[u8]) -> Result<()> {
        self.write(frame)?;
        self.offsets.push(self.at);
        Ok(())
    }

    /// Puts the whole file in its place, and opens it.
    pub fn commit(mut self, facts: &FrameFacts) -> Result<FrameFile> {
        let offsets = std::mem::take(&mut self.offsets);
        for offset in &offsets {
            self.write(&offset.to_le_bytes())?;
        }
        let facts_json = serde_json::to_vec(facts).expect("numbers and words");
        self.write(&facts_json)?;
        self.write(&(offsets.len() as u64 - 1).to_le_bytes())?;
        self.write(&(facts_json.len() as u64).to_le_bytes())?;
        self.file.commit()?;
        let file = File::open(&self.path).map_err(|e| Error::io(&self.path, "read", e))?;
        Ok(FrameFile {
            path: self.path,
            file: Mutex::new(file),
            offsets,
            facts: facts.clone(),
            is_passing: false,
        })
    }
}

/// Frames in a file, read as they are wanted.
#[derive(Debug)]
pub struct FrameFile {
    path: PathBuf,
    file: Mutex<File>,
    offsets: Vec<u64>,
    facts: FrameFacts,
    is_passing: bool,
}

impl FrameFile {
    /// Opens a file that is whole; `None` if there is none, or a damaged one, which is said.
    ///
    /// # Errors
    /// Something that is not a file stands there and cannot be moved.
    pub fn open(path: &Path) -> Result<Option<Self>> {
        let Some(mut unsealed) = sealed::open(path, KIND)? else {
            return Ok(None);
        };
        let Ok(Some(Parts { offsets, facts })) = Parts::read(&mut unsealed) else {
            sealed::make_again(path, "of another version")?;
            return Ok(None);
        };
        Ok(Some(Self {
            path: path.to_owned(),
            file: Mutex::new(unsealed.file),
            offsets,
            facts,
            is_passing: false,
        }))
    }

    /// What stands around the frames of a file, which are not read.
    ///
    /// # Errors
    /// It cannot be read, or is damaged there.
    pub fn facts_of(path: &Path) -> Result<FrameFacts> {
        facts(path, sealed::glance(path, KIND))
    }

    /// The same, every byte of the frames checked.
    ///
    /// # Errors
    /// It cannot be read, or is damaged.
    pub fn checked_facts_of(path: &Path) -> Result<FrameFacts> {
        facts(path, sealed::check(path, KIND))
    }

    pub fn facts(&self) -> &FrameFacts {
        &self.facts
    }

    pub fn len(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Bytes of its frames.
    pub fn n_bytes(&self) -> u64 {
        self.offsets[self.len()] - self.offsets[0]
    }

    /// Lets the file go with this.
    pub fn remove_when_done(&mut self) {
        self.is_passing = true;
    }

    /// One frame, encoded.
    pub fn read(&self, number: usize) -> Result<Vec<u8>> {
        let [from, to] = [self.offsets[number], self.offsets[number + 1]];
        let mut bytes = vec![0; (to - from) as usize];
        read_at(&self.file, from, &mut bytes).map_err(|e| Error::io(&self.path, "read", e))?;
        Ok(bytes)
    }

    /// All frames, encoded.
    pub fn read_all(&self) -> Result<Vec<Box<[u8]>>> {
        let frames = (0..self.len()).map(|number| self.read(number).map(Vec::into_boxed_slice));
        frames.collect()
    }
}

impl Drop for FrameFile {
    fn drop(&mut self) {
        if self.is_passing {
            // That it cannot be removed changes nothing in what was read from it.
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

/// Reads at a place of a file that several threads read.
fn read_at(file: &Mutex<File>, at: u64, bytes: &mut [u8]) -> std::io::Result<()> {
    let mut file = file.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    file.seek(SeekFrom::Start(at))?;
    file.read_exact(bytes)
}

fn facts(path: &Path, found: Checked) -> Result<FrameFacts> {
    let mut unsealed = found.ok().flatten();
    let parts = unsealed.as_mut().map(Parts::read).transpose();
    let parts = parts.map_err(|e| Error::io(path, "read", e))?.flatten();
    parts.map(|parts| parts.facts).ok_or_else(|| {
        let allowed = "a whole file of touches; a run that wants them makes them again";
        Error::input(path.display(), "damaged", allowed)
    })
}

/// What stands around the frames.
struct Parts {
    offsets: Vec<u64>,
    facts: FrameFacts,
}

impl Parts {
    /// `None` if they are not those of a whole file.
    fn read(unsealed: &mut Unsealed) -> std::io::Result<Option<Self>> {
        let Unsealed { file, n_bytes } = unsealed;
        let Some(room) = n_bytes.checked_sub(TAIL) else {
            return Ok(None);
        };
        let mut tail = [0; TAIL as usize];
        file.seek(SeekFrom::Start(room))?;
        file.read_exact(&mut tail)?;
        let number = |at: usize| u64::from_le_bytes(tail[at..at + 8].try_into().expect("eight"));
        let (n, n_facts) = (number(0), number(8));
        let around = n.checked_add(1).and_then(|n| n.checked_mul(8));
        let around = around.and_then(|bytes| bytes.checked_add(n_facts));
        let Some(around) = around.filter(|&bytes| bytes <= room) else {
            return Ok(None);
        };
        let mut bytes = vec![0; around as usize];
        file.seek(SeekFrom::Start(room - around))?;
        file.read_exact(&mut bytes)?;
        let (offsets, facts) = bytes.split_at((around - n_facts) as usize);
        let offset = |bytes: &[u8]| u64::from_le_bytes(bytes.try_into().expect("eight"));
        let offsets: Vec<u64> = offsets.chunks_exact(8).map(offset).collect();
        let facts: Option<FrameFacts> = serde_json::from_slice(facts).ok();
        Ok(facts
            .map(|facts| Self { offsets, facts })
            .filter(Self::is_sound))
    }

    /// Whether frames have the length that their taxels allow.
    fn is_sound(&self) -> bool {
        let most = most_bytes(self.facts.n_taxels) as u64;
        let fits = |pair: &[u64]| pair[0] <= pair[1] && pair[1] - pair[0] <= most;
        !self.offsets.is_empty() && self.offsets.windows(2).all(fits)
    }
}
