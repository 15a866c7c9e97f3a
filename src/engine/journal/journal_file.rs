//! Journal of a run: a single file with one writer at a time. The journals of a study's shards can be joined.

use crate::engine::journal::identity::Identity;
use crate::engine::journal::line::{Decoded, NO_STUDY, Records, decode, encode};
use crate::error::{Error, Result};
use serde::Serialize;
use serde::de::{DeserializeOwned, IgnoredAny};
use serde_json::value::RawValue;
use std::fs::{DirEntry, File, OpenOptions, TryLockError};
use std::io::ErrorKind::{NotADirectory, NotFound};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, MutexGuard};
use std::time::{Duration, Instant};

/// File name of the journal, which stores finished work items, in a result folder.
pub const JOURNAL_FILE: &str = "journal.jsonl";

/// Key of the first line of a journal, which identifies the study.
const HEADER: &str = "study";

/// Time between writes of journal lines to the disk. When `keep` returns, the operating system has the line, so it survives the end of the process. With a
/// larger value, a power failure loses more results; a flush after each line would take longer than a work item of a millisecond.
const SYNC_INTERVAL: Duration = Duration::from_millis(100);

/// Journal of a run: a file to which the result of each finished work item is appended. A journal may also store nothing.
#[derive(Debug, Default)]
pub struct Journal {
    path: PathBuf,
    /// Records that the journal contained when it was opened, without the first line.
    before: Decoded,
    writer: Mutex<Option<Writer>>,
}

#[derive(Debug)]
struct Writer {
    file: LockedFile,
    synced: Instant,
    /// Whether a write to the journal has failed. The last line may then be incomplete, so no further line is written.
    is_broken: bool,
}

impl Journal {
    /// Returns a journal without records that stores nothing.
    pub fn none() -> &'static Self {
        static NONE: LazyLock<Journal> = LazyLock::new(Journal::default);
        &NONE
    }

    /// Opens the journal of a study at `path`, or creates it in an existing folder. An incomplete last line is removed.
    ///
    /// # Errors
    /// If another process has the journal open, or the journal was started by another study (the error lists the differences). If its first line does
    /// not identify a study. If it is damaged before its last line or has lines of two studies. If it cannot be read or written.
    pub fn open(path: &Path, identity: &Identity) -> Result<Self> {
        let (mut file, bytes) = read_locked(path)?;
        let (begun, mut journal) = Self::of_bytes(path, &bytes)?;
        if let Some(begun) = &begun {
            identity.check_same((begun, journal.records()), &path.display().to_string())?;
        }
        let n_whole = journal.before.n_whole as u64;
        let cut = file.0.set_len(n_whole);
        let cut = cut.and_then(|()| file.0.seek(SeekFrom::End(0)));
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

    /// Reads the identity and the records of a journal, also while another process writes to the journal. Returns `None` if there is no file or no complete
    /// line.
    ///
    /// # Errors
    /// If the file cannot be read or is damaged.
    pub fn read(path: &Path) -> Result<Option<(Identity, Self)>> {
        let bytes = match std::fs::read(path) {
            // There is no journal below a path that is a file. A command that makes the folder refuses this path.
            Err(error) if matches!(error.kind(), NotFound | NotADirectory) => return Ok(None),
            bytes => bytes.map_err(|e| Error::io(path, "read", e))?,
        };
        let (identity, journal) = Self::of_bytes(path, &bytes)?;
        Ok(identity.map(|identity| (identity, journal)))
    }

    /// Reads the records of a journal, also while another process writes to the journal. Returns a journal without records if there is no file. The result
    /// stores nothing.
    ///
    /// # Errors
    /// If the file cannot be read or is damaged.
    pub fn read_records(path: &Path) -> Result<Self> {
        Ok(Self::read(path)?.map_or_else(Self::default, |(_, journal)| journal))
    }

    /// Decodes a journal: its study identity and its records. The identity is `None` if the journal contains no complete line.
    fn of_bytes(path: &Path, bytes: &[u8]) -> Result<(Option<Identity>, Self)> {
        let damaged = |(line, given): (usize, &str)| {
            let allowed = "a journal as it was written; --fresh starts over and keeps the old results beside the new";
            Error::input(format!("{}: line {line}", path.display()), given, allowed)
        };
        let mut before = decode(HEADER, bytes).map_err(damaged)?;
        // An interrupted write leaves a prefix of the first line; any other content was not written by this program.
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

    /// Returns the record with this key that the journal contained when it was opened. Returns `None` if there is no such record, or if the record has another
    /// type.
    pub fn get<R: DeserializeOwned>(&self, key: &str) -> Option<R> {
        serde_json::from_str(self.before.records.get(key)?.get()).ok()
    }

    /// Returns all records that the journal contained when it was opened, sorted by key.
    pub fn records(&self) -> &Records {
        &self.before.records
    }

    /// Appends a record to the journal. After this function returns, the record survives the end of the process.
    ///
    /// # Errors
    /// If the journal cannot be written.
    pub fn keep(&self, key: &str, record: &impl Serialize) -> Result<()> {
        self.append(key, record).map(|_| ())
    }

    /// Appends a line with a key and a record, and returns the checksum of the line; returns 0 if the journal does not store anything.
    fn append(&self, key: &str, record: &impl Serialize) -> Result<u32> {
        let Some(writer) = &mut *self.lock() else {
            return Ok(0);
        };
        let line = encode(self.before.first, key, record).map_err(io::Error::from);
        let kept = line.and_then(|(checksum, line)| writer.append(&line).map(|()| checksum));
        kept.map_err(|e| Error::io(&self.path, "write", e))
    }

    /// Copies the records of another journal of this study that are missing in this journal. If a work item failed in one journal and succeeded in the other,
    /// the success is used.
    ///
    /// # Errors
    /// If this journal cannot be written.
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

    /// Flushes all lines of the journal to the disk.
    ///
    /// # Errors
    /// If the journal cannot be written.
    pub fn sync(&self) -> Result<()> {
        let synced = self.lock().as_mut().map_or(Ok(()), Writer::sync);
        synced.map_err(|e| Error::io(&self.path, "write", e))
    }

    /// Writes all lines to the disk and blocks all later writes until the process ends.
    ///
    /// # Errors
    /// If the journal cannot be written.
    pub fn stop(&self) -> Result<()> {
        // The lock is never released: other writers block until the process ends.
        let mut writer = std::mem::ManuallyDrop::new(self.lock());
        let synced = writer.as_mut().map_or(Ok(()), Writer::sync);
        synced.map_err(|e| Error::io(&self.path, "write", e))
    }

    fn lock(&self) -> MutexGuard<'_, Option<Writer>> {
        // A thread that panicked during a write leaves a writer that is marked as broken.
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
        self.file.0.write_all(line.as_bytes())?;
        if self.synced.elapsed() >= SYNC_INTERVAL {
            self.sync()?;
        }
        self.is_broken = false;
        Ok(())
    }

    fn sync(&mut self) -> io::Result<()> {
        self.file.0.sync_data()?;
        self.synced = Instant::now();
        Ok(())
    }
}

/// Returns whether the bytes can be the start of a journal file. A journal starts with a checksum (8 hexadecimal digits), a space and the key of the first
/// line.
fn begins_header(bytes: &[u8]) -> bool {
    let expected = format!(" {{\"key\":\"{HEADER}\"");
    let is_digit = |byte: &u8| byte.is_ascii_hexdigit();
    let (digits, rest) = bytes.split_at(bytes.len().min(8));
    let n = rest.len().min(expected.len());
    digits.iter().all(is_digit) && rest[..n] == expected.as_bytes()[..n]
}

/// Returns whether a record describes a failed work item, `{"Err":…}`.
fn is_failure(record: &RawValue) -> bool {
    type Outcome = std::result::Result<IgnoredAny, String>;
    serde_json::from_str(record.get()).is_ok_and(|outcome: Outcome| outcome.is_err())
}

/// Opens or creates a journal file with exclusive access for this process, and reads its content.
fn read_locked(path: &Path) -> Result<(LockedFile, Vec<u8>)> {
    let file = OpenOptions::new()
        .read(true)
        .write(true)
        .create(true)
        .truncate(false)
        .open(path);
    let file = file.map_err(|e| Error::io(path, "write", e))?;
    let mut file = LockedFile::new(path, file)?;
    let mut bytes = Vec::new();
    let read = file.0.read_to_end(&mut bytes);
    read.map_err(|e| Error::io(path, "read", e))?;
    Ok((file, bytes))
}

impl Journal {
    /// Adds the records of all shard journals in the given folders, and returns the number of these journals.
    ///
    /// # Errors
    /// If a folder or a journal cannot be read, or a journal belongs to another study.
    pub fn take_from_shards<'a>(
        &mut self,
        identity: &Identity,
        folders: impl IntoIterator<Item = &'a Path>,
    ) -> Result<usize> {
        let mut n_journals = 0;
        for folder in folders {
            let mut names = names_in(folder)?;
            // The file name has the form of `Shard::file_name`.
            names.retain(|name| is_journal(name) && name.contains("-of-"));
            for name in names {
                let path = folder.join(name);
                n_journals += 1;
                if let Some((begun, shard)) = Self::read(&path)? {
                    let place = path.display().to_string();
                    identity.check_same((&begun, shard.records()), &place)?;
                    self.take_from(shard)?;
                }
            }
        }
        Ok(n_journals)
    }
}

/// Returns the names of all entries of a folder, sorted.
///
/// # Errors
/// If the folder cannot be read.
pub(crate) fn names_in(folder: &Path) -> Result<Vec<String>> {
    let name = |entry: io::Result<DirEntry>| Ok(entry?.file_name().to_string_lossy().into_owned());
    let entries = std::fs::read_dir(folder);
    let names = entries.and_then(|entries| entries.map(name).collect::<io::Result<Vec<_>>>());
    let mut names = names.map_err(|e| Error::io(folder, "read", e))?;
    names.sort();
    Ok(names)
}

/// Returns whether a file name is the name of a journal, of a whole study or of a shard.
pub(crate) fn is_journal(name: &str) -> bool {
    name.starts_with("journal.") && name.ends_with(".jsonl")
}

/// File that is locked against other runs until this value is dropped.
///
/// A child process that another thread is starting has a copy of each open file until its own program begins. Closing the file would not end the lock in this
/// time, so the lock is released explicitly.
#[derive(Debug)]
pub(crate) struct LockedFile(pub File);

impl LockedFile {
    /// Locks an open file. `path` is its path for error sentences.
    ///
    /// # Errors
    /// If another run has locked the file, or the file system cannot lock files.
    pub(crate) fn new(path: &Path, file: File) -> Result<Self> {
        match file.try_lock() {
            Ok(()) => Ok(Self(file)),
            Err(TryLockError::WouldBlock) => Err(Error::input(
                path.display(),
                "another run is writing to it",
                "one run in a folder at a time: wait for that one, or name another folder with --out",
            )),
            Err(TryLockError::Error(error)) => Err(Error::io(path, "lock", error)),
        }
    }
}

impl Drop for LockedFile {
    fn drop(&mut self) {
        // If this fails, the lock ends when the last copy of the file is closed.
        let _ = self.0.unlock();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lock_ends_while_a_copy_of_the_file_is_open() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal.jsonl");
        let file = File::create(&path).unwrap();
        // A child process has such a copy before its program begins.
        let copy = file.try_clone().unwrap();
        let locked = LockedFile::new(&path, file).unwrap();
        let open = || File::open(&path).unwrap();
        let error = LockedFile::new(&path, open()).unwrap_err().to_string();
        assert!(error.contains("another run is writing to it"), "{error}");
        drop(locked);
        LockedFile::new(&path, open()).unwrap();
        drop(copy);
    }
}
