//! Meshes from PLY files, ASCII or binary with either byte order.
//!
//! A file must have an element `vertex` with scalar properties x, y, z (metres). The element `face` is read if its list has the name `vertex_indices` or
//! `vertex_index`. Other elements and properties are skipped.

use super::text_lines::{BYTE_ORDER_MARK, all_bytes};
use crate::error::{Error, Result};
use crate::mesh::MeshFile;
use glam::DVec3;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType,
};
use std::io::{BufRead, ErrorKind};

/// Reads the mesh in a PLY file; errors begin with `place`, the name of the file.
///
/// # Errors
/// If the file has another format, is truncated, has no vertices, or contains a coordinate that is not finite or an invalid vertex index.
pub fn read_ply(place: &str, source: impl BufRead) -> Result<MeshFile> {
    let content = ascii_header(place, all_bytes(place, source)?)?;
    let mut reader = Reader::new(&content[..]);
    let header = Parser::<Item>::new()
        .read_header(&mut reader)
        .map_err(|e| malformed(place, &e))?;
    check_header(place, header.elements.values())?;
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for element in header.elements.values() {
        let items = Parser::<Item>::new()
            .read_payload_for_element(&mut reader, element, &header)
            .map_err(|e| malformed(place, &e))?;
        match element.name.as_str() {
            "vertex" => vertices = items.into_iter().map(|item| item.point).collect(),
            "face" => faces = items,
            _ => {}
        }
    }
    MeshFile::new(place, vertices, polygons(place, &faces)?)
}

/// Converts the vertex indices of the faces from signed numbers. Invalid indices are rejected here or when the surface is created.
fn polygons(place: &str, faces: &[Item]) -> Result<Vec<Vec<u32>>> {
    let index = |face: usize, corner: i64| {
        u32::try_from(corner).map_err(|_| {
            Error::input(
                format!("{place}: face {}", face + 1),
                format!("vertex index {corner}"),
                "at least three vertex indices, from 0",
            )
        })
    };
    let polygon = |(face, item): (usize, &Item)| {
        let corners = item.corners.iter();
        corners.map(|&corner| index(face, corner)).collect()
    };
    faces.iter().enumerate().map(polygon).collect()
}

/// Returns the content of a file without a byte order mark, and with `?` in place of the bytes of its header that are not ASCII. Comments of a header may be in
/// any encoding.
fn ascii_header(place: &str, mut content: Vec<u8>) -> Result<Vec<u8>> {
    if content.starts_with(&BYTE_ORDER_MARK) {
        content.drain(..BYTE_ORDER_MARK.len());
    }
    if !content.starts_with(b"ply") {
        let given = match content.is_empty() {
            true => "an empty file",
            false => "not a PLY file",
        };
        return Err(Error::input(place, given, "a file that begins with `ply`"));
    }
    const END: &[u8] = b"end_header";
    let end = content.windows(END.len()).position(|bytes| bytes == END);
    let header = &mut content[..end.unwrap_or(0)];
    for byte in header.iter_mut().filter(|byte| !byte.is_ascii()) {
        *byte = b'?';
    }
    Ok(content)
}

/// Returns an error for unsupported elements before the reader reads data or allocates memory.
fn check_header<'a>(place: &str, elements: impl Iterator<Item = &'a ElementDef>) -> Result<()> {
    let refuse = |given: &str, allowed: &str| Err(Error::input(place, given, allowed));
    let mut has_vertices = false;
    for element in elements {
        // Otherwise the size of the file would not limit the number of elements without content.
        if element.properties.is_empty() && element.count > 0 {
            let given = format!("element `{}` without properties", element.name);
            return refuse(&given, "at least one property an element");
        }
        match element.name.as_str() {
            "vertex" => {
                has_vertices = true;
                let is_number = |name: &&str| {
                    let property = element.properties.get(*name);
                    property.is_some_and(|p| matches!(p.data_type, PropertyType::Scalar(_)))
                };
                if let Some(name) = ["x", "y", "z"].iter().find(|name| !is_number(name)) {
                    let given = format!("vertices without a number `{name}`");
                    return refuse(&given, "vertices with x, y, z");
                }
            }
            "face" if element.count > 0 && !has_indices(element) => {
                let given = "faces without a list of whole numbers `vertex_indices`";
                return refuse(given, "faces that list their vertices");
            }
            _ => {}
        }
    }
    match has_vertices {
        true => Ok(()),
        false => refuse("no element `vertex`", "vertices with x, y, z"),
    }
}

/// Returns whether an element has a list of vertex indices.
fn has_indices(element: &ElementDef) -> bool {
    let is_index = |t: &ScalarType| !matches!(t, ScalarType::Float | ScalarType::Double);
    ["vertex_indices", "vertex_index"].iter().any(|name| {
        matches!(
            element.properties.get(*name).map(|p| &p.data_type),
            Some(PropertyType::List(count, index)) if is_index(count) && is_index(index)
        )
    })
}

fn malformed(place: &str, error: &ParseError) -> Error {
    // The crate's messages contain the input over several lines; the first line contains the reason.
    let text = error.to_string();
    let first = text.lines().next().unwrap_or_default().trim();
    let (given, allowed) = match error.kind() {
        ErrorKind::UnexpectedEof => ("cut off", "as many elements as the header says"),
        _ => (
            "not readable as PLY",
            "finite numbers as the header describes them",
        ),
    };
    Error::input(place, format!("{given}: {first}"), allowed)
}

/// Item of an element: its position, and the vertex indices of its polygon. Other properties are skipped.
struct Item {
    point: DVec3,
    corners: Vec<i64>,
}

impl PropertyAccess for Item {
    fn new() -> Self {
        Self {
            point: DVec3::NAN,
            corners: Vec::new(),
        }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let axis = match name {
            "x" => 0,
            "y" => 1,
            "z" => 2,
            "vertex_indices" | "vertex_index" => return self.set_corners(property),
            _ => return PropertyAccessResult::Ignored,
        };
        self.point[axis] = match property {
            Property::Char(v) => f64::from(v),
            Property::UChar(v) => f64::from(v),
            Property::Short(v) => f64::from(v),
            Property::UShort(v) => f64::from(v),
            Property::Int(v) => f64::from(v),
            Property::UInt(v) => f64::from(v),
            Property::Float(v) => f64::from(v),
            Property::Double(v) => v,
            _ => return PropertyAccessResult::Ignored,
        };
        PropertyAccessResult::Set
    }
}

impl Item {
    fn set_corners(&mut self, property: Property) -> PropertyAccessResult {
        self.corners = match property {
            Property::ListChar(v) => v.into_iter().map(i64::from).collect(),
            Property::ListUChar(v) => v.into_iter().map(i64::from).collect(),
            Property::ListShort(v) => v.into_iter().map(i64::from).collect(),
            Property::ListUShort(v) => v.into_iter().map(i64::from).collect(),
            Property::ListInt(v) => v.into_iter().map(i64::from).collect(),
            Property::ListUInt(v) => v.into_iter().map(i64::from).collect(),
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}
