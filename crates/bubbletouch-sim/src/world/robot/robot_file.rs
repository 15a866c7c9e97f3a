//! Readers of robots from a URDF or MJCF file, its bytes, or its text.

use super::Robot;
use super::mjcf::read_mjcf;
use super::text::root_name;
use super::urdf::{NamedSensor, read_urdf};
use crate::error::{Error, Result};
use crate::files::check_content;
use crate::text::encoding::decoded;
use std::path::Path;

impl Robot {
    /// Reads a robot from the text of a URDF file. Invalid parts that do not affect the poses of links are omitted with a note.
    ///
    /// # Errors
    /// If a part that determines poses of links is invalid. The message begins with `place`, the file's name, and contains the line.
    pub fn from_urdf(place: &str, text: &str) -> Result<Self> {
        read_urdf(place, text).map(|(robot, _)| robot)
    }

    /// Reads a robot, as `from_urdf` does, and the name and content of each tactile sensor. The error of an unreadable sensor, which the robot omits with a note,
    /// contains the line.
    ///
    /// # Errors
    /// Returns the errors of `from_urdf`.
    pub fn with_all_sensors(place: &str, text: &str) -> Result<(Self, Vec<NamedSensor>)> {
        read_urdf(place, text)
    }

    /// Reads a robot from the text of an MJCF file; `place` is the path of the file. Files of `<include>` are read from the folder of the file. The links are
    /// the bodies in the order of MuJoCo's model, from `world`, and after them the sites with a name.
    ///
    /// # Errors
    /// If a part that determines poses of bodies is invalid, or an included file cannot be read. The message contains the file and the line.
    pub fn from_mjcf(place: &str, text: &str) -> Result<Self> {
        read_mjcf(place, text)
    }

    /// Reads a robot from a URDF or MJCF file in UTF-8, UTF-16 with a byte order mark, or Latin-1. The root element, `<robot>` or `<mujoco>`, determines the
    /// format. Mesh files are not opened.
    ///
    /// # Errors
    /// If the file cannot be read or its text is invalid.
    pub fn read(path: &Path) -> Result<Self> {
        let place = path.display().to_string();
        let bytes = crate::files::read(path).map_err(|e| {
            Error::input(
                &place,
                format!("cannot be read ({e})"),
                "a URDF or MJCF file",
            )
        })?;
        Self::from_bytes(&place, &bytes)
    }

    /// Reads a robot from the bytes of a URDF or MJCF file; `place` is the file's path.
    ///
    /// # Errors
    /// If the bytes cannot be decoded or the text is invalid.
    pub fn from_bytes(place: &str, bytes: &[u8]) -> Result<Self> {
        check_content(place, bytes)?;
        let (text, note) = decoded(place, bytes);
        let mut robot = match root_name(&text).as_deref() {
            Some("mujoco") => read_mjcf(place, &text)?,
            _ => Self::from_urdf(place, &text)?,
        };
        robot.notes.splice(0..0, note);
        Ok(robot)
    }
}
