//! Formats in which layouts are written.

use super::{LayoutFile, csv, icub, npz, paxini, urdf};
use crate::error::{Error, Result};
use crate::files::write_bytes;
use std::path::Path;
use std::str::FromStr;

/// Format of a layout file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LayoutFormat {
    /// Table with one row for each taxel.
    Csv,
    /// NumPy archive of positions and normals.
    Npz,
    /// NumPy archive of poses and pixels, as for Analog Devices' DEX-01.
    Dex01,
    /// Position file of iCub's skin.
    Icub,
    /// JSON of PaXini's sensors: positions, mm, and rotation matrices.
    Paxini,
    /// `<sensor><tactile>` of urdf_tactile, with one `<taxel>` for each taxel.
    Urdf,
}

impl LayoutFormat {
    /// All formats, each with its name.
    pub const ALL: [(&'static str, Self); 6] = [
        ("csv", Self::Csv),
        ("npz", Self::Npz),
        ("dex-01", Self::Dex01),
        ("icub", Self::Icub),
        ("paxini", Self::Paxini),
        ("urdf", Self::Urdf),
    ];

    /// Returns the format that belongs to the extension of a file name; `None` if the extension is unknown.
    pub fn from_path(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        Some(match &ending[..] {
            "csv" => Self::Csv,
            "npz" => Self::Npz,
            "txt" | "ini" => Self::Icub,
            "json" => Self::Paxini,
            "urdf" | "xml" => Self::Urdf,
            _ => return None,
        })
    }

    /// Returns whether the format can carry radii.
    const fn has_radii(self) -> bool {
        !matches!(self, Self::Icub | Self::Paxini)
    }

    /// Returns whether the format can carry the image of the sensor.
    const fn has_pixels(self) -> bool {
        matches!(self, Self::Csv | Self::Npz | Self::Dex01)
    }
}

impl FromStr for LayoutFormat {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self> {
        let found = Self::ALL.iter().find(|(known, _)| *known == name);
        found.map(|(_, format)| *format).ok_or_else(|| {
            let known = Self::ALL.map(|(known, _)| known).join(", ");
            Error::input("layout format", format!("`{name}`"), known)
        })
    }
}

impl LayoutFile {
    /// Writes the layout to a file. If `format` is `None`, the extension of the file name determines the format. Returns a note for each content that the
    /// format cannot carry.
    ///
    /// The reader returns the same layout: bitwise equal in `.csv` and `.npz` files and in the position files of iCub, otherwise up to rounding.
    ///
    /// # Errors
    /// If the extension of the file name belongs to another format or is unknown, the file cannot be written, or the running command reads it.
    pub fn write(&self, path: &Path, format: Option<LayoutFormat>) -> Result<Vec<String>> {
        let of_path = LayoutFormat::from_path(path);
        let place = path.display();
        let format = match (format, of_path) {
            // The two formats of NumPy archives share one extension.
            (Some(LayoutFormat::Dex01), Some(LayoutFormat::Npz)) => LayoutFormat::Dex01,
            (Some(given), Some(known)) if given == known => given,
            (None, Some(known)) => known,
            (_, None) => return Err(Error::input(place, "another file", super::FORMATS)),
            (Some(given), Some(_)) => {
                let name = LayoutFormat::ALL
                    .iter()
                    .find(|(_, format)| *format == given);
                let given = format!("the format {}", name.map_or("", |(name, _)| name));
                return Err(Error::input(place, given, "the format of this extension"));
            }
        };
        let name = path.file_stem().and_then(|name| name.to_str());
        let name = name.unwrap_or("skin");
        let bytes = match format {
            LayoutFormat::Csv => csv::written(self).into_bytes(),
            LayoutFormat::Npz => npz::written(self)?,
            LayoutFormat::Dex01 => npz::written_as_poses(self)?,
            LayoutFormat::Icub => icub::written(self, name).into_bytes(),
            LayoutFormat::Paxini => paxini::written(self, name).into_bytes(),
            LayoutFormat::Urdf => urdf::written(self, name).into_bytes(),
        };
        write_bytes(path, &bytes)?;
        let default = self.default_radius();
        let is_default = |radius: &f64| (radius / default - 1.0).abs() < 1e-9;
        let has_radii = self
            .radii
            .iter()
            .flatten()
            .any(|radius| !is_default(radius));
        let mut notes = Vec::new();
        if has_radii && !format.has_radii() {
            notes.push(format!(
                "{place}: the format has no radii; a reader takes half the distance of neighbours"
            ));
        }
        if self.image().is_some() && !format.has_pixels() {
            notes.push(format!(
                "{place}: the format has no image of rows and columns"
            ));
        }
        Ok(notes)
    }
}
