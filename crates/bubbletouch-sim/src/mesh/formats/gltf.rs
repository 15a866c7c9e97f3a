//! Meshes from glTF 2.0 files (`.glb`, `.gltf`). Positions, triangles and the tree of nodes are read; materials, normals, texture and animations are ignored.

use super::gltf_file::{GltfFile, Primitive};
use super::joined_parts::{JoinedParts, triangles_of_fan, triangles_of_strip};
use crate::error::{Error, Result};
use crate::mesh::MeshFile;
use glam::DAffine3;
use std::io::BufRead;

/// Largest depth of the tree of nodes. A deeper tree indicates nodes that contain each other.
const MAX_DEPTH: usize = 100;
/// Modes of primitives with triangles.
const TRIANGLES: u32 = 4;
const STRIP: u32 = 5;
const FAN: u32 = 6;

/// Reads the mesh in a glTF file, metres. All meshes of the scene form one mesh; without a scene, all meshes of the file. Skins are read in their bind pose.
///
/// # Errors
/// If the file is truncated or not glTF 2.0, has no triangles, or contains wrong counts, indices out of range or numbers that are not finite. The error
/// begins with `place`, the path of the file; buffers in other files are searched beside this path.
pub fn read_gltf(place: &str, mut source: impl BufRead) -> Result<MeshFile> {
    let mut bytes = Vec::new();
    source
        .read_to_end(&mut bytes)
        .map_err(|e| Error::io(place, "read", e))?;
    let file = GltfFile::new(place, &bytes)?;
    let mut parts = JoinedParts::default();
    let description = &file.description;
    match description.scenes.get(description.scene.unwrap_or(0)) {
        Some(scene) => {
            for &node in &scene.nodes {
                add_node(place, &file, node, &DAffine3::IDENTITY, 0, &mut parts)?;
            }
        }
        None if description.scene.is_some() => {
            let index = description.scene.unwrap_or(0);
            return Err(file.missing("scene", index, description.scenes.len()));
        }
        None => {
            for mesh in 0..description.meshes.len() {
                add_mesh(place, &file, mesh, &DAffine3::IDENTITY, &mut parts)?;
            }
        }
    }
    parts.into_file(place)
}

fn add_node(
    place: &str,
    file: &GltfFile,
    index: usize,
    above: &DAffine3,
    depth: usize,
    parts: &mut JoinedParts,
) -> Result<()> {
    let nodes = &file.description.nodes;
    let Some(node) = nodes.get(index) else {
        return Err(file.missing("node", index, nodes.len()));
    };
    let place_of_node = format!("{place}, node {index}");
    if depth > MAX_DEPTH {
        let given = format!("nodes inside each other, {MAX_DEPTH} deep");
        return Err(Error::input(place_of_node, given, "a tree of nodes"));
    }
    let Some(own) = node.transform() else {
        let allowed = "a matrix with the last row 0, 0, 0, 1, or a rotation of length one";
        return Err(Error::input(
            place_of_node,
            "a transform that is not affine",
            allowed,
        ));
    };
    let transform = *above * own;
    if let Some(mesh) = node.mesh {
        // The vertices of a skin are in the frame of the scene.
        let frame = if node.skin.is_some() {
            DAffine3::IDENTITY
        } else {
            transform
        };
        add_mesh(place, file, mesh, &frame, parts)?;
    }
    for &child in &node.children {
        add_node(place, file, child, &transform, depth + 1, parts)?;
    }
    Ok(())
}

fn add_mesh(
    place: &str,
    file: &GltfFile,
    index: usize,
    transform: &DAffine3,
    parts: &mut JoinedParts,
) -> Result<()> {
    let meshes = &file.description.meshes;
    let Some(mesh) = meshes.get(index) else {
        return Err(file.missing("mesh", index, meshes.len()));
    };
    for (number, primitive) in mesh.primitives.iter().enumerate() {
        let mode = primitive.mode.unwrap_or(TRIANGLES);
        if ![TRIANGLES, STRIP, FAN].contains(&mode) {
            continue;
        }
        let place = format!("{place}, mesh {index}, primitive {number}");
        let Some(position) = primitive.attributes.position else {
            return Err(Error::input(
                place,
                "no `POSITION`",
                "positions of the vertices",
            ));
        };
        let positions = file.positions(position)?;
        let corners = match primitive.indices {
            Some(indices) => file.indices(indices)?,
            None => (0..positions.len() as u32).collect(),
        };
        let triangles = triangles(&place, primitive, &corners)?;
        parts.add(&place, transform, &positions, &triangles)?;
    }
    Ok(())
}

/// Returns the triangles of a primitive with the given corners.
fn triangles(place: &str, primitive: &Primitive, corners: &[u32]) -> Result<Vec<Vec<u32>>> {
    Ok(match primitive.mode {
        Some(STRIP) => triangles_of_strip(corners),
        Some(FAN) => triangles_of_fan(corners),
        _ if !corners.len().is_multiple_of(3) => {
            let given = format!("{} corners of triangles", corners.len());
            return Err(Error::input(place, given, "three for each triangle"));
        }
        _ => corners.chunks_exact(3).map(<[u32]>::to_vec).collect(),
    })
}
