//! Contents of a glTF 2.0 file: the JSON description and the buffers of numbers.

use super::base64;
use super::joined_parts::affine;
use super::text_lines::BYTE_ORDER_MARK;
use crate::error::{Error, Result};
use crate::files::spellings;
use glam::{DAffine3, DMat4, DQuat, DVec3};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// First bytes of a binary file.
const MAGIC: &[u8] = b"glTF";
/// Length of the header of a binary file: magic bytes, version, length.
const HEADER: usize = 12;
/// Types of chunks of a binary file.
const JSON: u32 = 0x4E4F_534A;
const BINARY: u32 = 0x004E_4942;
/// Extensions that change positions or triangles. The reader does not decode them, so files that require them are refused.
const ENCODINGS: [&str; 4] = [
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "EXT_mesh_gpu_instancing",
];

/// Parts of the JSON description of a glTF file from which meshes are read.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase", default)]
#[derive(Default)]
pub(super) struct Description {
    pub scene: Option<usize>,
    pub scenes: Vec<Scene>,
    pub nodes: Vec<Node>,
    pub meshes: Vec<Mesh>,
    accessors: Vec<Accessor>,
    buffer_views: Vec<View>,
    buffers: Vec<Buffer>,
    extensions_required: Vec<String>,
}

/// Scene: indices of its root nodes.
#[derive(Deserialize)]
pub(super) struct Scene {
    #[serde(default)]
    pub nodes: Vec<usize>,
}

/// Node with its transform: a matrix, or scale, rotation and translation.
#[derive(Deserialize)]
pub(super) struct Node {
    #[serde(default)]
    pub children: Vec<usize>,
    pub mesh: Option<usize>,
    pub skin: Option<usize>,
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
}

/// Mesh as a list of primitives.
#[derive(Deserialize)]
pub(super) struct Mesh {
    pub primitives: Vec<Primitive>,
}

/// Triangles or other primitives.
#[derive(Deserialize)]
pub(super) struct Primitive {
    pub attributes: Attributes,
    pub indices: Option<usize>,
    pub mode: Option<u32>,
}

/// Accessors of a primitive's attributes.
#[derive(Deserialize)]
pub(super) struct Attributes {
    #[serde(rename = "POSITION")]
    pub position: Option<usize>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Accessor {
    buffer_view: Option<usize>,
    #[serde(default)]
    byte_offset: usize,
    component_type: u32,
    #[serde(default)]
    normalized: bool,
    count: usize,
    #[serde(rename = "type")]
    kind: String,
    sparse: Option<serde::de::IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct View {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: Option<usize>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Buffer {
    uri: Option<String>,
    byte_length: usize,
}

/// glTF file with its buffers.
pub(super) struct GltfFile<'p> {
    place: &'p str,
    pub description: Description,
    buffers: Vec<Vec<u8>>,
}

impl<'p> GltfFile<'p> {
    /// Reads the description and the buffers of a `.glb` or `.gltf` file. Buffers in other files are searched in the folder of `place`, the path of the file.
    ///
    /// # Errors
    /// If the file is cut off or invalid, or a buffer cannot be read.
    pub fn new(place: &'p str, bytes: &[u8]) -> Result<Self> {
        let (json, binary) = match bytes.starts_with(MAGIC) {
            true => chunks(place, bytes)?,
            // Some programs write a byte order mark.
            false => (bytes.strip_prefix(&BYTE_ORDER_MARK).unwrap_or(bytes), None),
        };
        if bytes.is_empty() {
            return Err(Error::input(place, "an empty file", "glTF 2.0"));
        }
        let description: Description = serde_json::from_slice(json).map_err(|error| {
            let said = error.to_string();
            let given = said
                .rsplit_once(" at line ")
                .map_or(said.as_str(), |(given, _)| given);
            let place = format!("{place}, line {}", error.line());
            Error::input(place, given, "glTF 2.0")
        })?;
        let mut required = description.extensions_required.iter();
        if let Some(encoding) = required.find(|name| ENCODINGS.contains(&name.as_str())) {
            let given = format!("meshes in the encoding {encoding}");
            return Err(Error::input(place, given, "meshes without this extension"));
        }
        let buffers = description.buffers.iter().enumerate();
        let buffers = buffers.map(|(index, buffer)| {
            let place_of_buffer = format!("{place}, buffer {index}");
            let content = match &buffer.uri {
                None => binary.map(<[u8]>::to_vec).ok_or_else(|| {
                    Error::input(&place_of_buffer, "no data", "an address, or a .glb file")
                })?,
                Some(address) => content_of(place, &place_of_buffer, address)?,
            };
            match content.len() >= buffer.byte_length {
                true => Ok(content),
                false => {
                    let given = format!("{} bytes", content.len());
                    let allowed = format!("`byteLength` {} or more", buffer.byte_length);
                    Err(Error::input(place_of_buffer, given, allowed))
                }
            }
        });
        let buffers = buffers.collect::<Result<_>>()?;
        Ok(Self {
            place,
            description,
            buffers,
        })
    }

    /// Returns the positions in an accessor.
    ///
    /// # Errors
    /// If the accessor does not contain points, or lies outside its buffer.
    pub fn positions(&self, accessor: usize) -> Result<Vec<DVec3>> {
        let numbers = self.numbers(accessor, "VEC3", 3)?;
        let points = numbers.chunks_exact(3);
        Ok(points.map(DVec3::from_slice).collect())
    }

    /// Returns the vertex indices in an accessor.
    ///
    /// # Errors
    /// If the accessor does not contain unsigned integers, or lies outside its buffer.
    pub fn indices(&self, accessor: usize) -> Result<Vec<u32>> {
        let component = self.accessor(accessor)?.component_type;
        if ![5121, 5123, 5125].contains(&component) {
            let given = format!("vertex indices with `componentType` {component}");
            return Err(self.refuse(accessor, given, "5121, 5123 or 5125"));
        }
        let numbers = self.numbers(accessor, "SCALAR", 1)?;
        Ok(numbers.into_iter().map(|number| number as u32).collect())
    }

    fn accessor(&self, index: usize) -> Result<&Accessor> {
        self.item("accessor", &self.description.accessors, index)
    }

    fn refuse(&self, accessor: usize, given: impl ToString, allowed: impl ToString) -> Error {
        let place = format!("{}, accessor {accessor}", self.place);
        Error::input(place, given, allowed)
    }

    /// Returns an item of a list of the file.
    ///
    /// # Errors
    /// If the index does not exist.
    pub fn item<'l, T>(&self, what: &str, list: &'l [T], index: usize) -> Result<&'l T> {
        list.get(index).ok_or_else(|| {
            let allowed = match list.len() {
                0 => format!("a file with a {what}"),
                n => format!("0 to {}", n - 1),
            };
            Error::input(self.place, format!("{what} {index}"), allowed)
        })
    }

    /// Returns the numbers of an accessor with `n` components per element.
    fn numbers(&self, index: usize, kind: &str, n: usize) -> Result<Vec<f64>> {
        let accessor = self.accessor(index)?;
        if accessor.kind != kind {
            return Err(self.refuse(index, format!("`type` {}", accessor.kind), kind));
        }
        if accessor.sparse.is_some() {
            return Err(self.refuse(index, "`sparse` values", "values in a buffer"));
        }
        // Size of a number, bytes, and the number that stands for 1 if numbers are normalised.
        let (size, largest) = match accessor.component_type {
            5120 => (1, 127.0),
            5121 => (1, 255.0),
            5122 => (2, 32_767.0),
            5123 => (2, 65_535.0),
            5125 | 5126 => (4, 1.0),
            other => {
                let given = format!("`componentType` {other}");
                return Err(self.refuse(index, given, "5120 to 5123, 5125 or 5126"));
            }
        };
        let Some(view) = accessor.buffer_view else {
            return Err(self.refuse(index, "no `bufferView`", "values in a buffer"));
        };
        let view = self.item("buffer view", &self.description.buffer_views, view)?;
        let buffer = self.item("buffer", &self.buffers, view.buffer)?;
        let view_end = view.byte_offset.checked_add(view.byte_length);
        let bytes = view_end.and_then(|end| buffer.get(view.byte_offset..end));
        let stride = view.byte_stride.unwrap_or(size * n);
        let end = accessor
            .count
            .checked_sub(1)
            .and_then(|before| before.checked_mul(stride))
            .and_then(|before| before.checked_add(size * n))
            .and_then(|length| length.checked_add(accessor.byte_offset));
        let bytes = bytes
            .zip(end)
            .and_then(|(bytes, end)| bytes.get(accessor.byte_offset..end));
        let Some(bytes) = bytes.filter(|_| stride >= size * n) else {
            let given = format!("{} elements", accessor.count);
            return Err(self.refuse(index, given, "as many as the buffer contains, at least one"));
        };
        let divisor = if accessor.normalized { largest } else { 1.0 };
        let mut numbers = Vec::with_capacity(accessor.count * n);
        for element in 0..accessor.count {
            for component in 0..n {
                let start = element * stride + component * size;
                let value = number(&bytes[start..start + size], accessor.component_type);
                if !value.is_finite() {
                    let given = format!("element {element}: {value}");
                    return Err(self.refuse(index, given, "finite numbers"));
                }
                numbers.push((value / divisor).max(if accessor.normalized { -1.0 } else { value }));
            }
        }
        Ok(numbers)
    }
}

impl Node {
    /// Returns the transform `parent_from_node`; `None` if it is not an affine map with finite numbers and a rotation of length one.
    pub fn transform(&self) -> Option<DAffine3> {
        if let Some(columns) = &self.matrix {
            let matrix = DMat4::from_cols_array(columns);
            return affine(&matrix).filter(|_| matrix.is_finite());
        }
        let rotation = DQuat::from_array(self.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]));
        let rotation = crate::geometry::written_rotation(rotation)?;
        let scale = DVec3::from(self.scale.unwrap_or([1.0; 3]));
        let translation = DVec3::from(self.translation.unwrap_or_default());
        Some(DAffine3::from_scale_rotation_translation(
            scale,
            rotation,
            translation,
        ))
    }
}

/// Returns the JSON chunk and the binary chunk of a `.glb` file.
fn chunks<'b>(place: &str, bytes: &'b [u8]) -> Result<(&'b [u8], Option<&'b [u8]>)> {
    let cut_off = |given: String| Error::input(place, given, "a whole .glb file of version 2");
    let number = |at: usize| {
        let four = bytes.get(at..at + 4)?;
        Some(u32::from_le_bytes([four[0], four[1], four[2], four[3]]))
    };
    let (Some(version), Some(length)) = (number(4), number(8)) else {
        return Err(cut_off(format!("{} bytes, cut off", bytes.len())));
    };
    if version != 2 {
        return Err(cut_off(format!("version {version}")));
    }
    if (length as usize) > bytes.len() {
        let n = bytes.len();
        return Err(cut_off(format!("{n} of {length} bytes, cut off")));
    }
    let (mut json, mut binary, mut at) = (None, None, HEADER);
    while at + 8 <= length as usize {
        let (Some(size), Some(kind)) = (number(at), number(at + 4)) else {
            break;
        };
        let start = at + 8;
        let end = start.checked_add(size as usize);
        let Some(chunk) = end.and_then(|end| bytes.get(start..end)) else {
            return Err(cut_off(format!("a chunk of {size} bytes, cut off")));
        };
        match kind {
            JSON if json.is_none() => json = Some(chunk),
            BINARY if binary.is_none() => binary = Some(chunk),
            _ => {}
        }
        at = start + (size as usize).next_multiple_of(4);
    }
    match json {
        Some(json) => Ok((json, binary)),
        None => Err(cut_off("no description".to_owned())),
    }
}

/// Returns the bytes at an address: data in the address itself, or a file beside the glTF file.
fn content_of(place: &str, place_of_buffer: &str, address: &str) -> Result<Vec<u8>> {
    if let Some(data) = address.strip_prefix("data:") {
        let text = data.split_once(";base64,").map(|(_, text)| text);
        return text.and_then(base64::decoded).ok_or_else(|| {
            let given = "data that is not Base64";
            Error::input(place_of_buffer, given, "Base64, or a file")
        });
    }
    let folder = Path::new(place).parent().unwrap_or(Path::new(""));
    let paths = spellings(address).into_iter().map(|name| folder.join(name));
    let paths: Vec<PathBuf> = paths.collect();
    let path = paths
        .iter()
        .find(|path| path.is_file())
        .unwrap_or(&paths[0]);
    crate::files::read(path).map_err(|error| {
        let given = format!("{}, which cannot be read ({error})", path.display());
        Error::input(place_of_buffer, given, "a file beside the glTF file")
    })
}

/// Returns a little-endian number; `kind` is the component type of glTF, and the slice has its size.
fn number(bytes: &[u8], kind: u32) -> f64 {
    match (kind, bytes) {
        (5120, &[a]) => f64::from(a as i8),
        (5121, &[a]) => f64::from(a),
        (5122, &[a, b]) => f64::from(i16::from_le_bytes([a, b])),
        (5123, &[a, b]) => f64::from(u16::from_le_bytes([a, b])),
        (5125, &[a, b, c, d]) => f64::from(u32::from_le_bytes([a, b, c, d])),
        (_, &[a, b, c, d]) => f64::from(f32::from_le_bytes([a, b, c, d])),
        _ => f64::NAN,
    }
}
