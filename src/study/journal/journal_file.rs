//! The journal of a run: one file, one writer at a time.

use super::identity::Identity;
use super::line::{Records, decode, encode};
use crate::error::{Error, Result};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{LazyLock, Mutex, MutexGuard};
use std::time::{Duration, Instant};

/// The journal's name in a folder of results.
pub const JOURNAL_FILE: &str = "journal.jsonl";

/// The key of the first line.
const HEADER: &str = "study";

/// A line is with the system when [`Journal::keep`] returns, so that it outlives the process, and on the disk within this
/// time, so that little is lost with the power. Waiting for the disk after each line would cost cells of a millisecond more
/// than themselves.
const SYNC_INTERVAL: Duration = Duration::from_millis(100);

/// What a run has finished, on disk; or a journal that keeps nothing.
#[derive(Debug, Default)]
pub struct Journal {
    path: PathBuf,
    /// What every line is bound to its study with.
    of: String,
    before: Records,
    /// Bytes of whole lines when it was opened.
    n_whole: usize,
    writer: Mutex<Option<Writer>>,
    /// Records after which the process ends; 0: it does not.
    aborts_after: AtomicUsize,
}

#[derive(Debug)]
struct Writer {
    file: File,
    synced: Instant,
    /// A line may be torn at the end: nothing may follow it.
    is_broken: bool,
}

impl Journal {
    /// A journal that knows nothing and keeps nothing.
    pub fn none() -> &'static Self {
        static NONE: LazyLock<Journal> = LazyLock::new(Journal::default);
        &NONE
    }

    /// Opens the journal of this study, or starts one, at `path` in a folder that exists. A torn last line is cut off.
    ///
    /// # Errors
    /// Another process has it open; it was begun with another study (the error says what differs); its first line does not say with
    /// which; it is damaged before its last line, or has lines of two studies; it cannot be read or written.
    pub fn open(path: &Path, identity: &Identity) -> Result<Self> {
        let (mut file, bytes) = read_locked(path)?;
        let (begun, journal) = Self::of_bytes(path, &bytes)?;
        let of = identity.binding();
        if let Some(begun) = &begun {
            begun.check_same(identity, &path.display().to_string())?;
            check_bound(path, &journal.of, &of)?;
        }
        let n_whole = journal.n_whole as u64;
        let cut = file
            .set_len(n_whole)
            .and_then(|()| file.seek(SeekFrom::End(0)));
        cut.map_err(|e| Error::io(path, "write", e))?;
        let writer = Writer {
            file,
            synced: Instant::now(),
            is_broken: false,
        };
        let journal = Self {
            of,
            writer: Mutex::new(Some(writer)),
            ..journal
        };
        if begun.is_none() {
            journal.keep(HEADER, identity)?;
            journal.sync()?;
        }
        Ok(journal)
    }

    /// The records that stand in a journal, by key, whoever is writing to it; none where there is no file, or nothing whole in it.
    ///
    /// # Errors
    /// It cannot be read, or is damaged, as of [`open`](Self::open).
    pub fn read(path: &Path) -> Result<Option<(Identity, Self)>> {
        let bytes = match std::fs::read(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            bytes => bytes.map_err(|e| Error::io(path, "read", e))?,
        };
        let (identity, journal) = Self::of_bytes(path, &bytes)?;
        Ok(identity.map(|identity| (identity, journal)))
    }

    /// What a file holds, and the study that it was begun with: none where no line is whole.
    fn of_bytes(path: &Path, bytes: &[u8]) -> Result<(Option<Identity>, Self)> {
        let decoded = decode(bytes);
        if let Some((line, given)) = decoded.damage {
            return Err(damaged(path, line, given));
        }
        let mut journal = Self {
            path: path.to_owned(),
            before: decoded.records,
            n_whole: decoded.n_whole,
            ..Self::default()
        };
        let Some(first) = decoded.first else {
            return Ok((None, journal));
        };
        journal.of = first.of;
        match serde_json::from_str(first.record.get()) {
            Ok(begun) if first.key == HEADER => Ok((Some(begun), journal)),
            _ => {
                let given =
                    "is no record of a study: nothing says which study the finished work is of";
                Err(damaged(path, 1, given))
            }
        }
    }

    /// What was kept under a key before this journal was opened; `None` too for a record of another kind.
    pub fn get<R: DeserializeOwned>(&self, key: &str) -> Option<R> {
        serde_json::from_str(self.before.get(key)?.get()).ok()
    }

    /// How many records there were when it was opened.
    pub fn n_before(&self) -> usize {
        self.before.len()
    }

    /// Keeps a record: when this returns, the end of the process cannot lose it.
    pub fn keep(&self, key: &str, record: &impl Serialize) -> Result<()> {
        if let Some(writer) = self.lock().as_mut() {
            let line = encode(&self.of, key, record).map_err(io::Error::from);
            let kept = line.and_then(|line| writer.append(&line));
            kept.map_err(|e| Error::io(&self.path, "write", e))?;
            if self.aborts_after.load(Relaxed) > 0 && self.aborts_after.fetch_sub(1, Relaxed) == 1 {
                std::process::abort();
            }
        }
        Ok(())
    }

    /// Ends the process, as a kill does, when so many more records are kept: to try what is left of it.
    pub fn abort_after(&self, n_records: usize) {
        self.aborts_after.store(n_records, Relaxed);
    }

    /// Adds what another journal of the same study holds and this one did not hold when it was opened.
    ///
    /// # Errors
    /// Its lines are of another study; this journal cannot be written.
    pub fn take_from(&mut self, other: Self) -> Result<()> {
        check_bound(&other.path, &other.of, &self.of)?;
        for (key, record) in other.before {
            if !self.before.contains_key(&key) {
                self.keep(&key, &record)?;
                self.before.insert(key, record);
            }
        }
        Ok(())
    }

    /// Waits until everything is on the disk.
    pub fn sync(&self) -> Result<()> {
        let synced = self.lock().as_mut().map_or(Ok(()), Writer::sync);
        synced.map_err(|e| Error::io(&self.path, "write", e))
    }

    /// As [`sync`](Self::sync), and no thread writes from then on: for a process that is about to end.
    pub fn stop(&self) -> Result<()> {
        // Never given back: who wants to write waits for the end.
        let mut writer = std::mem::ManuallyDrop::new(self.lock());
        let synced = writer.as_mut().map_or(Ok(()), Writer::sync);
        synced.map_err(|e| Error::io(&self.path, "write", e))
    }

    fn lock(&self) -> MutexGuard<'_, Option<Writer>> {
        // A thread that panicked while it wrote has left a broken writer, and that knows it.
        self.writer
            .lock()
            .unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}

impl Writer {
    fn append(&mut self, line: &str) -> io::Result<()> {
        if self.is_broken {
            return Err(io::Error::other("an earlier line could not be written"));
        }
        self.is_broken = true;
        self.file.write_all(line.as_bytes())?;
        if self.synced.elapsed() >= SYNC_INTERVAL {
            self.sync()?;
        }
        self.is_broken = false;
        Ok(())
    }

    fn sync(&mut self) -> io::Result<()> {
        self.file.sync_data()?;
        self.synced = Instant::now();
        Ok(())
    }
}

/// Opens a journal, or makes an empty one, for this process alone, and reads it.
fn read_locked(path: &Path) -> Result<(File, Vec<u8>)> {
    let options = OpenOptions::new()
        .read(true)
        .write(true)
        .create(true)
        .truncate(false)
        .open(path);
    let mut file = options.map_err(|e| Error::io(path, "write", e))?;
    file.try_lock().map_err(|error| match error {
        TryLockError::WouldBlock => Error::input(
            path.display(),
            "another run is writing to it",
            "one run in a folder at a time: wait for that one, or name another folder with --out",
        ),
        TryLockError::Error(error) => Error::io(path, "lock", error),
    })?;
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes)
        .map_err(|e| Error::io(path, "read", e))?;
    Ok((file, bytes))
}

/// Lines that are bound to a study are of the study that the first of them names.
fn check_bound(path: &Path, of: &str, expected: &str) -> Result<()> {
    match of == expected {
        true => Ok(()),
        false => Err(damaged(
            path,
            1,
            "names another study than the one that the lines are of",
        )),
    }
}

fn damaged(path: &Path, line: usize, given: &str) -> Error {
    let allowed =
        "a journal as it was written; --fresh starts over and keeps the old results beside the new";
    Error::input(format!("{}: line {line}", path.display()), given, allowed)
}
