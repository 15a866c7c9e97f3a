//! The journal of a run: one file, one writer at a time.

use crate::engine::journal::identity::Identity;
use crate::engine::journal::line::{Decoded, NO_STUDY, Records, decode, encode};
use crate::error::{Error, Result};
use serde::Serialize;
use serde::de::{DeserializeOwned, IgnoredAny};
use serde_json::value::RawValue;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
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
    /// What its lines said when it was opened; its header is taken out.
    before: Decoded,
    writer: Mutex<Option<Writer>>,
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
        let (begun, mut journal) = Self::of_bytes(path, &bytes)?;
        if let Some(begun) = &begun {
            identity.check_same((begun, journal.records()), &path.display().to_string())?;
        }
        let n_whole = journal.before.n_whole as u64;
        let cut = file
            .set_len(n_whole)
            .and_then(|()| file.seek(SeekFrom::End(0)));
        cut.map_err(|e| Error::io(path, "write", e))?;
        journal.writer = Mutex::new(Some(Writer {
            file,
            synced: Instant::now(),
            is_broken: false,
        }));
        if begun.is_none() {
            journal.before.first = journal.append(HEADER, identity)?;
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
        let damaged = |(line, given): (usize, &str)| {
            let allowed = "a journal as it was written; --fresh starts over and keeps the old results beside the new";
            Error::input(format!("{}: line {line}", path.display()), given, allowed)
        };
        let mut before = decode(HEADER, bytes).map_err(damaged)?;
        // What an interrupted write leaves of the first line is its beginning; anything else is not of this program.
        if before.n_whole == 0 && !begins_header(bytes) {
            return Err(damaged((1, NO_STUDY)));
        }
        let header = before.header.take();
        let begun = header.map(|header| serde_json::from_str(header.get()));
        let begun = begun.transpose().map_err(|_| damaged((1, NO_STUDY)))?;
        let path = path.to_owned();
        let journal = Self {
            path,
            before,
            ..Self::default()
        };
        Ok((begun, journal))
    }

    /// What was kept under a key before this journal was opened; `None` too for a record of another kind.
    pub fn get<R: DeserializeOwned>(&self, key: &str) -> Option<R> {
        serde_json::from_str(self.before.records.get(key)?.get()).ok()
    }

    /// Returns the records that the journal had when it was opened, by key.
    pub fn records(&self) -> &Records {
        &self.before.records
    }

    /// Keeps a record: when this returns, the end of the process cannot lose it.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn keep(&self, key: &str, record: &impl Serialize) -> Result<()> {
        self.append(key, record).map(|_| ())
    }

    /// Writes a line, unless this journal keeps nothing; its checksum.
    fn append(&self, key: &str, record: &impl Serialize) -> Result<u32> {
        let Some(writer) = &mut *self.lock() else {
            return Ok(0);
        };
        let line = encode(self.before.first, key, record).map_err(io::Error::from);
        let kept = line.and_then(|(checksum, line)| writer.append(&line).map(|()| checksum));
        kept.map_err(|e| Error::io(&self.path, "write", e))
    }

    /// Adds what another journal of the same study holds and this one did not hold when it was opened. If a work item failed in one journal and
    /// succeeded in the other, the success is kept.
    ///
    /// # Errors
    /// This journal cannot be written.
    pub fn take_from(&mut self, other: Self) -> Result<()> {
        for (key, record) in other.before.records {
            let known = self.before.records.get(&key);
            if known.is_none_or(|known| is_failure(known) && !is_failure(&record)) {
                self.keep(&key, &record)?;
                self.before.records.insert(key, record);
            }
        }
        Ok(())
    }

    /// Waits until everything is on the disk.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn sync(&self) -> Result<()> {
        let synced = self.lock().as_mut().map_or(Ok(()), Writer::sync);
        synced.map_err(|e| Error::io(&self.path, "write", e))
    }

    /// As [`sync`](Self::sync), and no thread writes from then on: for a process that is about to end.
    ///
    /// # Errors
    /// They cannot be written.
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

/// Whether bytes are the beginning of a first line: a checksum of 8 hexadecimal digits, a space and the key.
fn begins_header(bytes: &[u8]) -> bool {
    let expected = format!(" {{\"key\":\"{HEADER}\"");
    let is_digit = |byte: &u8| byte.is_ascii_hexdigit();
    let (digits, rest) = bytes.split_at(bytes.len().min(8));
    let n = rest.len().min(expected.len());
    digits.iter().all(is_digit) && rest[..n] == expected.as_bytes()[..n]
}

/// Whether a record is that of a failed work item, `{"Err":…}`.
fn is_failure(record: &RawValue) -> bool {
    type Outcome = std::result::Result<IgnoredAny, String>;
    serde_json::from_str(record.get()).is_ok_and(|outcome: Outcome| outcome.is_err())
}

/// Keeps a journal from other processes as long as the file is open.
pub(crate) fn lock(path: &Path, file: &File) -> Result<()> {
    file.try_lock().map_err(|error| match error {
        TryLockError::WouldBlock => Error::input(
            path.display(),
            "another run is writing to it",
            "one run in a folder at a time: wait for that one, or name another folder with --out",
        ),
        TryLockError::Error(error) => Error::io(path, "lock", error),
    })
}

/// Opens a journal, or makes an empty one, for this process alone, and reads it.
fn read_locked(path: &Path) -> Result<(File, Vec<u8>)> {
    let file = OpenOptions::new()
        .read(true)
        .write(true)
        .create(true)
        .truncate(false)
        .open(path);
    let mut file = file.map_err(|e| Error::io(path, "write", e))?;
    lock(path, &file)?;
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes)
        .map_err(|e| Error::io(path, "read", e))?;
    Ok((file, bytes))
}
