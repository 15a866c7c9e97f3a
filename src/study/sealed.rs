//! Files of a cache: each ends with a seal, and one whose seal is broken is made again.
//!
//! The seal is the last line, 80 bytes: `# bubbletouch <kind>, crc32 <of all bytes before the line>`. A cache asks [`open`] for
//! the file of a key; what is cut, changed, of another version or no file at all is said in one line on standard error, and
//! taken for absent. [`SealedFile`] writes beside the name and renames, so that other processes see whole files only.

use crate::error::{Error, Result};
use crate::files::WholeFile;
use crc32fast::Hasher;
use std::fs::{self, File};
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Bytes of a seal, its end of line included.
const SEAL: usize = 80;

/// A file in the making; dropped before it is sealed, it leaves nothing behind.
pub struct SealedFile {
    file: WholeFile,
    crc: Hasher,
    kind: &'static str,
}

impl SealedFile {
    /// `kind`: what it holds, and the version of its form.
    pub fn create(path: &Path, kind: &'static str) -> Result<Self> {
        Ok(Self {
            file: WholeFile::create(path)?,
            crc: Hasher::new(),
            kind,
        })
    }

    /// Writes part of it.
    pub fn write(&mut self, bytes: &[u8]) -> Result<()> {
        self.crc.update(bytes);
        self.file.write(|sink| sink.write_all(bytes))
    }

    /// Seals it and puts it in place, over what stood there.
    pub fn commit(mut self) -> Result<()> {
        let seal = seal(self.kind, self.crc.finalize());
        self.file.write(|sink| sink.write_all(seal.as_bytes()))?;
        self.file.commit()
    }
}

fn seal(kind: &str, crc: u32) -> String {
    let said = format!("# bubbletouch {kind}, crc32 {crc:08x}");
    format!("{said:<width$}\n", width = SEAL - 1)
}

/// A sealed file, open at its beginning, and its bytes before the seal.
pub struct Unsealed {
    pub file: File,
    pub n_bytes: u64,
}

/// The file at `path` if its seal is whole; every byte is read. `None` if there is none, or a damaged one, of which it is said
/// that it is [made again](make_again).
///
/// # Errors
/// Something that is not a file stands at `path` and cannot be moved.
pub fn open(path: &Path, kind: &'static str) -> Result<Option<Unsealed>> {
    match check(path, kind) {
        Ok(found) => Ok(found),
        Err(damage) => {
            make_again(path, &damage)?;
            Ok(None)
        }
    }
}

/// Says that a file is made again, for it is damaged, and removes it; what is not a file is set aside, with all that it holds.
///
/// # Errors
/// It cannot be moved.
pub fn make_again(path: &Path, damage: &str) -> Result<()> {
    // That nobody reads it changes nothing.
    let _ = writeln!(
        io::stderr(),
        "note: {} is {damage}: it is made again",
        path.display()
    );
    match fs::symlink_metadata(path) {
        // If it stays, the new one replaces it.
        Ok(meta) if meta.is_file() => drop(fs::remove_file(path)),
        Ok(_) => match fs::rename(path, aside(path)) {
            // Another process may have been faster.
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                return Err(Error::io(path, "move aside", error));
            }
            _ => {}
        },
        Err(_) => {}
    }
    Ok(())
}

/// A name that is free: with `.aside`, and a number if need be.
fn aside(path: &Path) -> PathBuf {
    let name = |number: u32| {
        let mut name = path.as_os_str().to_owned();
        name.push(match number {
            1 => ".aside".to_owned(),
            _ => format!(".aside-{number}"),
        });
        PathBuf::from(name)
    };
    let mut names = (1..).map(name);
    let free = names.find(|name| fs::symlink_metadata(name).is_err());
    free.expect("numbers do not end")
}

/// A file, `None` if there is none, or what is wrong with it, as in `it is cut`.
type Checked = std::result::Result<Option<Unsealed>, String>;

/// What [`open`] finds, without a word.
fn check(path: &Path, kind: &'static str) -> Checked {
    let Some((mut file, n_bytes, said)) = read_seal(path).map_err(unreadable)?? else {
        return Ok(None);
    };
    if !is_of(kind, &said) {
        return Err("cut, or of another version".to_owned());
    }
    let crc = crc_of(&mut file, n_bytes).map_err(unreadable)?;
    if said != seal(kind, crc) {
        return Err("damaged".to_owned());
    }
    file.rewind().map_err(unreadable)?;
    Ok(Some(Unsealed { file, n_bytes }))
}

fn unreadable(error: io::Error) -> String {
    format!("not readable ({error})")
}

fn is_of(kind: &str, said: &str) -> bool {
    said.starts_with(&format!("# bubbletouch {kind}, "))
}

type Sealed = std::result::Result<Option<(File, u64, String)>, String>;

/// The file, its bytes before the seal, and the seal.
fn read_seal(path: &Path) -> io::Result<Sealed> {
    let meta = match fs::metadata(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Ok(None)),
        meta => meta?,
    };
    // Opening a pipe would wait for who writes to it.
    if !meta.is_file() {
        return Ok(Err("not a file".to_owned()));
    }
    let mut file = File::open(path)?;
    let Some(n_bytes) = file.metadata()?.len().checked_sub(SEAL as u64) else {
        return Ok(Err("cut".to_owned()));
    };
    let mut seal = [0; SEAL];
    file.seek(SeekFrom::Start(n_bytes))?;
    file.read_exact(&mut seal)?;
    Ok(Ok(Some((
        file,
        n_bytes,
        String::from_utf8_lossy(&seal).into_owned(),
    ))))
}

/// The checksum of the leading bytes.
fn crc_of(file: &mut File, n_bytes: u64) -> io::Result<u32> {
    file.rewind()?;
    let mut reader = BufReader::with_capacity(1 << 20, file).take(n_bytes);
    let (mut crc, mut block) = (Hasher::new(), vec![0; 1 << 20]);
    loop {
        match reader.read(&mut block)? {
            0 => return Ok(crc.finalize()),
            n => crc.update(&block[..n]),
        }
    }
}
