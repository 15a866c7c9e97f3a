//! A file of frames.
//!
//! | bytes | what |
//! |---|---|
//! | 16 | the magic words |
//! | … | the frames, one after the other |
//! | 8 (n + 1) | where each begins, and the last ends, u64 |
//! | … | [`FrameFacts`], JSON |
//! | 8, 8 | n; bytes of the facts |
//! | 4 | CRC-32 of all before |
//! | 16 | the magic words again |

use super::FrameFacts;
use super::coding::most_bytes;
use crate::error::{Error, Result};
use crate::files::WholeFile;
use crc32fast::Hasher;
use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

const MAGIC: &[u8; 16] = b"bubbletouch frm1";
/// Bytes after the facts.
const TAIL: u64 = 8 + 8 + 4 + 16;

/// A file of frames in the making; dropped before it is whole, it leaves nothing behind.
pub struct FrameFileWriter {
    path: PathBuf,
    file: WholeFile,
    crc: Hasher,
    at: u64,
    offsets: Vec<u64>,
}

impl FrameFileWriter {
    pub fn create(path: &Path) -> Result<Self> {
        let mut writer = Self {
            path: path.to_owned(),
            file: WholeFile::create(path)?,
            crc: Hasher::new(),
            at: 0,
            offsets: Vec::new(),
        };
        writer.write(MAGIC)?;
        writer.offsets.push(writer.at);
        Ok(writer)
    }

    fn write(&mut self, bytes: &[u8]) -> Result<()> {
        self.crc.update(bytes);
        self.at += bytes.len() as u64;
        self.file.write(|sink| sink.write_all(bytes))
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
        let crc = self.crc.clone().finalize();
        self.write(&crc.to_le_bytes())?;
        self.write(MAGIC)?;
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
    /// Opens a file and checks that it is whole.
    ///
    /// # Errors
    /// It cannot be read, or is damaged.
    pub fn open(path: &Path) -> Result<Self> {
        let io = |error| Error::io(path, "read", error);
        let mut file = File::open(path).map_err(io)?;
        let parts = Parts::read(&mut file).map_err(io)?;
        let parts = parts.ok_or_else(|| damaged(path))?;
        let n_bytes = file.metadata().map_err(io)?.len();
        if crc_of(&mut file, n_bytes - 20).map_err(io)? != parts.crc {
            return Err(damaged(path));
        }
        Ok(Self {
            path: path.to_owned(),
            file: Mutex::new(file),
            offsets: parts.offsets,
            facts: parts.facts,
            is_passing: false,
        })
    }

    /// What stands around the frames of a file, which are not read.
    ///
    /// # Errors
    /// It cannot be read, or is damaged there.
    pub fn facts_of(path: &Path) -> Result<FrameFacts> {
        let io = |error| Error::io(path, "read", error);
        let mut file = File::open(path).map_err(io)?;
        let parts = Parts::read(&mut file).map_err(io)?;
        Ok(parts.ok_or_else(|| damaged(path))?.facts)
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

fn damaged(path: &Path) -> Error {
    let allowed =
        "a whole file of frames: remove it (bubbletouch cache prune), and it is made again";
    Error::input(path.display(), "damaged", allowed)
}

/// What stands around the frames.
struct Parts {
    offsets: Vec<u64>,
    facts: FrameFacts,
    /// Of all that comes before it.
    crc: u32,
}

impl Parts {
    /// `None` if they are not those of a whole file.
    fn read(file: &mut File) -> std::io::Result<Option<Self>> {
        let n_bytes = file.metadata()?.len();
        if n_bytes < MAGIC.len() as u64 + 8 + TAIL {
            return Ok(None);
        }
        let mut tail = [0; TAIL as usize];
        file.seek(SeekFrom::End(-(TAIL as i64)))?;
        file.read_exact(&mut tail)?;
        let number = |at: usize| u64::from_le_bytes(tail[at..at + 8].try_into().expect("eight"));
        let (n, n_facts) = (number(0), number(8));
        let crc = u32::from_le_bytes(tail[16..20].try_into().expect("four"));
        let around = n.checked_add(1).and_then(|n| n.checked_mul(8));
        let around = around.and_then(|bytes| bytes.checked_add(n_facts));
        let room = n_bytes - TAIL - MAGIC.len() as u64;
        let Some(around) = around.filter(|&bytes| bytes <= room) else {
            return Ok(None);
        };
        if &tail[20..] != MAGIC {
            return Ok(None);
        }
        let mut bytes = vec![0; around as usize];
        file.seek(SeekFrom::Start(n_bytes - TAIL - around))?;
        file.read_exact(&mut bytes)?;
        let (offsets, facts) = bytes.split_at((around - n_facts) as usize);
        let offset = |bytes: &[u8]| u64::from_le_bytes(bytes.try_into().expect("eight"));
        let offsets: Vec<u64> = offsets.chunks_exact(8).map(offset).collect();
        let facts: Option<FrameFacts> = serde_json::from_slice(facts).ok();
        Ok(facts
            .map(|facts| Self {
                offsets,
                facts,
                crc,
            })
            .filter(Self::is_sound))
    }

    /// Whether frames have the length that their taxels allow.
    fn is_sound(&self) -> bool {
        let most = most_bytes(self.facts.n_taxels) as u64;
        let fits = |pair: &[u64]| pair[0] <= pair[1] && pair[1] - pair[0] <= most;
        !self.offsets.is_empty() && self.offsets.windows(2).all(fits)
    }
}

/// The checksum of the leading bytes.
fn crc_of(file: &mut File, n_bytes: u64) -> std::io::Result<u32> {
    file.seek(SeekFrom::Start(0))?;
    let mut reader = BufReader::with_capacity(1 << 20, file).take(n_bytes);
    let (mut crc, mut block) = (Hasher::new(), vec![0; 1 << 20]);
    loop {
        match reader.read(&mut block)? {
            0 => return Ok(crc.finalize()),
            n => crc.update(&block[..n]),
        }
    }
}
