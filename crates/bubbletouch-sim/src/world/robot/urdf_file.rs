//! Readers of robots: from a file, its bytes, or its text.

use super::Robot;
use super::text::decoded;
use super::urdf::read_urdf;
use crate::error::{Error, Result};
use std::path::Path;

impl Robot {
    /// Reads a robot from the text of a URDF file. What decides where links are must be right; the rest may be missing or wrong, and is
    /// then left out with a [note](Self::notes).
    ///
    /// # Errors
    /// Errors begin with `place`, the file's name, and give the line.
    pub fn from_urdf(place: &str, text: &str) -> Result<Self> {
        read_urdf(place, text)
    }

    /// Reads a robot from a URDF file in UTF-8, UTF-16 with a byte order mark, or Latin-1. Mesh files that it names are not opened.
    ///
    /// # Errors
    /// A file that cannot be read; those of [`from_urdf`](Self::from_urdf).
    pub fn read_urdf(path: &Path) -> Result<Self> {
        let place = path.display().to_string();
        let bytes = crate::files::read(path)
            .map_err(|e| Error::input(&place, format!("cannot be read ({e})"), "a URDF file"))?;
        Self::from_urdf_bytes(&place, &bytes)
    }

    /// The same from the bytes of a file.
    ///
    /// # Errors
    /// Those of [`from_urdf`](Self::from_urdf).
    pub fn from_urdf_bytes(place: &str, bytes: &[u8]) -> Result<Self> {
        let (text, note) = decoded(place, bytes);
        let mut robot = read_urdf(place, &text)?;
        robot.notes.splice(0..0, note);
        Ok(robot)
    }
}
