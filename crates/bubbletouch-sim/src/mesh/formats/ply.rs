//! Meshes from PLY files, ASCII or binary with either byte order.
//!
//! A file must have an element `vertex` with scalar properties x, y, z (metres). The element `face` is read if its list has the name `vertex_indices` or
//! `vertex_index`. Other elements and properties are skipped.

use super::text_lines::BYTE_ORDER_MARK;
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
pub fn read_ply(place: &str, mut source: impl BufRead) -> Result<MeshFile> {
    check_magic(place, &mut source)?;
    let mut reader = Reader::new(source);
    let header = Parser::<Vertex>::new()
        .read_header(&mut reader)
        .map_err(|e| malformed(place, &e))?;
    check_header(place, header.elements.values())?;
    let mut vertices = Vec::new();
    let mut faces = Vec::new();
    for element in header.elements.values() {
        match element.name.as_str() {
            "vertex" => {
                vertices = Parser::<Vertex>::new()
                    .read_payload_for_element(&mut reader, element, &header)
                    .map_err(|e| malformed(place, &e))?;
            }
            "face" => {
                faces = Parser::<Face>::new()
                    .read_payload_for_element(&mut reader, element, &header)
                    .map_err(|e| malformed(place, &e))?;
            }
            _ => {
                Parser::<Skipped>::new()
                    .read_payload_for_element(&mut reader, element, &header)
                    .map_err(|e| malformed(place, &e))?;
            }
        }
    }
    let vertices = vertices.into_iter().map(|v| v.0).collect();
    MeshFile::new(place, vertices, polygons(place, &faces)?)
}

/// Converts the vertex indices of the faces from signed numbers. Invalid indices are rejected here or when the surface is created.
fn polygons(place: &str, faces: &[Face]) -> Result<Vec<Vec<u32>>> {
    let index = |face: usize, corner: i64| {
        u32::try_from(corner).map_err(|_| {
            Error::input(
                format!("{place}: face {}", face + 1),
                format!("vertex index {corner}"),
                "at least three vertex indices, from 0",
            )
        })
    };
    let polygon = |(face, Face(corners)): (usize, &Face)| {
        let indices = corners.iter().map(|&corner| index(face, corner));
        indices.collect()
    };
    faces.iter().enumerate().map(polygon).collect()
}

fn check_magic(place: &str, source: &mut impl BufRead) -> Result<()> {
    let read = |e| Error::io(place, "read", e);
    if source
        .fill_buf()
        .map_err(read)?
        .starts_with(&BYTE_ORDER_MARK)
    {
        source.consume(BYTE_ORDER_MARK.len());
    }
    let start = source.fill_buf().map_err(read)?;
    if start.starts_with(b"ply") {
        return Ok(());
    }
    let given = if start.is_empty() {
        "an empty file"
    } else {
        "not a PLY file"
    };
    Err(Error::input(place, given, "a file that begins with `ply`"))
}

/// Returns an error for unsupported elements before the reader reads data or allocates memory.
fn check_header<'a>(place: &str, elements: impl Iterator<Item = &'a ElementDef>) -> Result<()> {
    let mut has_vertices = false;
    for element in elements {
        // Otherwise the size of the file would not limit the number of elements without content.
        if element.properties.is_empty() && element.count > 0 {
            return Err(Error::input(
                place,
                format!("element `{}` without properties", element.name),
                "at least one property an element",
            ));
        }
        match element.name.as_str() {
            "vertex" => {
                has_vertices = true;
                check_vertex(place, element)?;
            }
            "face" => check_face(place, element)?,
            _ => {}
        }
    }
    if has_vertices {
        return Ok(());
    }
    Err(Error::input(
        place,
        "no element `vertex`",
        "vertices with x, y, z",
    ))
}

fn check_vertex(place: &str, element: &ElementDef) -> Result<()> {
    for name in ["x", "y", "z"] {
        let property = element.properties.get(name).map(|p| &p.data_type);
        if !matches!(property, Some(PropertyType::Scalar(_))) {
            return Err(Error::input(
                place,
                format!("vertices without a number `{name}`"),
                "vertices with x, y, z",
            ));
        }
    }
    Ok(())
}

fn check_face(place: &str, element: &ElementDef) -> Result<()> {
    let names = ["vertex_indices", "vertex_index"];
    let lists = names.map(|name| element.properties.get(name).map(|p| &p.data_type));
    let is_index = |t: &ScalarType| !matches!(t, ScalarType::Float | ScalarType::Double);
    let usable = lists.iter().flatten().any(
        |t| matches!(t, PropertyType::List(count, index) if is_index(count) && is_index(index)),
    );
    if usable || element.count == 0 {
        return Ok(());
    }
    Err(Error::input(
        place,
        "faces without a list of whole numbers `vertex_indices`",
        "faces that list their vertices",
    ))
}

fn malformed(place: &str, error: &ParseError) -> Error {
    // The crate's messages contain the input over several lines; the first line contains the reason.
    let text = error.to_string();
    let first = text.lines().next().unwrap_or_default().trim();
    match error.kind() {
        ErrorKind::UnexpectedEof => Error::input(
            place,
            format!("cut off: {first}"),
            "as many elements as the header says",
        ),
        _ => Error::input(
            place,
            format!("not readable as PLY: {first}"),
            "finite numbers as the header describes them",
        ),
    }
}

struct Vertex(DVec3);

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self(DVec3::NAN)
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let value = match property {
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
        match name {
            "x" => self.0.x = value,
            "y" => self.0.y = value,
            "z" => self.0.z = value,
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

struct Face(Vec<i64>);

impl PropertyAccess for Face {
    fn new() -> Self {
        Self(Vec::new())
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !matches!(name, "vertex_indices" | "vertex_index") {
            return PropertyAccessResult::Ignored;
        }
        self.0 = match property {
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

/// Element of a PLY file that the reader skips.
struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}
