//! Format and unit of a mesh file.

use super::collada::read_collada;
use super::gltf::read_gltf;
use super::obj::read_obj;
use super::ply::read_ply;
use super::stl::read_stl;
use crate::error::{Error, Result};
use crate::files::check_content;
use crate::mesh::triangle_mesh::extent;
use crate::mesh::{MeshFile, SizeLimits};
use serde::{Deserialize, Serialize};
use std::io::BufRead;
use std::path::Path;

/// Mesh file formats that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshFormat {
    /// Polygon file format, ascii or binary.
    Ply,
    /// Wavefront OBJ.
    Obj,
    /// Stereolithography, ascii or binary.
    Stl,
    /// Collada, version 1.4 or 1.5.
    Collada,
    /// glTF 2.0, binary (`.glb`) or JSON (`.gltf`).
    Gltf,
}

/// Length unit of the numbers in a mesh file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum LengthUnit {
    /// Metre (m).
    #[default]
    #[serde(rename = "m")]
    Metre,
    /// Centimetre (cm).
    #[serde(rename = "cm")]
    Centimetre,
    /// Millimetre (mm).
    #[serde(rename = "mm")]
    Millimetre,
    /// Inch (in).
    #[serde(rename = "in")]
    Inch,
}

impl MeshFormat {
    /// Endings of the names of mesh files, for messages.
    pub const ENDINGS: &str = ".ply, .obj, .stl, .dae, .glb or .gltf";

    /// Returns the format of a file by its extension, ignoring case.
    ///
    /// # Errors
    /// If no supported format has this extension.
    pub fn from_path(path: &Path) -> Result<Self> {
        let ending = path.extension().unwrap_or_default().to_string_lossy();
        match ending.to_ascii_lowercase().as_str() {
            "ply" => Ok(Self::Ply),
            "obj" => Ok(Self::Obj),
            "stl" => Ok(Self::Stl),
            "dae" => Ok(Self::Collada),
            "glb" | "gltf" => Ok(Self::Gltf),
            _ => {
                let allowed = format!("a name that ends in {}", Self::ENDINGS);
                Err(Error::input(
                    path.display(),
                    "not a mesh by its name",
                    allowed,
                ))
            }
        }
    }

    /// Reads a file of this format and converts it to metres. Without a unit, the numbers of a Collada file are in the unit that the file contains. The
    /// numbers of other files are then metres. The size of the object must then be within `sizes` ([`SizeLimits::ANY`] if no narrower limits are known).
    ///
    /// # Errors
    /// If the file is invalid, or the size is outside the limits; errors begin with `place`, the path of the file.
    pub fn read(
        self,
        place: &str,
        unit: Option<LengthUnit>,
        sizes: &SizeLimits,
        mut source: impl BufRead,
    ) -> Result<MeshFile> {
        // A file whose beginning cannot be read fails in its reader, with the error of the format.
        check_content(place, source.fill_buf().unwrap_or_default())?;
        let (file, own_unit) = match self {
            Self::Ply => (read_ply(place, source)?, 1.0),
            Self::Obj => (read_obj(place, source)?, 1.0),
            Self::Stl => (read_stl(place, source)?, 1.0),
            Self::Collada => read_collada(place, source)?,
            Self::Gltf => (read_gltf(place, source)?, 1.0),
        };
        let file = file.scaled(place, unit.map_or(own_unit, LengthUnit::metres))?;
        if unit.is_none() {
            sizes.check(place, extent(file.vertices()))?;
        }
        Ok(file)
    }
}

impl LengthUnit {
    /// Names of the length units in options and files.
    pub const NAMES: [(&'static str, Self); 4] = [
        ("m", Self::Metre),
        ("cm", Self::Centimetre),
        ("mm", Self::Millimetre),
        ("in", Self::Inch),
    ];

    /// Returns the name of the length unit in options and files.
    pub fn name(self) -> &'static str {
        let named = Self::NAMES.iter().find(|(_, unit)| *unit == self);
        named.expect("every unit has a name").0
    }

    /// Returns the length of the unit, metres.
    pub fn metres(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Centimetre => 1e-2,
            Self::Millimetre => 1e-3,
            Self::Inch => 25.4e-3,
        }
    }
}

impl std::str::FromStr for LengthUnit {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let named = Self::NAMES.iter().find(|(name, _)| *name == text);
        named.map(|(_, unit)| *unit).ok_or_else(|| {
            let names = Self::NAMES.map(|(name, _)| name);
            format!("expected one of {}", names.join(", "))
        })
    }
}
