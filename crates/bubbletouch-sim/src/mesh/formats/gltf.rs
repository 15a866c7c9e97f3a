//! Meshes from glTF 2.0 files (`.glb`, `.gltf`). Positions, triangles and the tree of nodes are read; materials, normals, texture and animations are ignored.

use super::gltf_file::GltfFile;
use super::joined_parts::{JoinedParts, triangles_of_fan, triangles_of_list, triangles_of_strip};
use super::text_lines::all_bytes;
use crate::error::{Error, Result};
use crate::mesh::MeshFile;
use glam::DAffine3;
use std::io::BufRead;

/// Modes of primitives with triangles.
const TRIANGLES: u32 = 4;
const STRIP: u32 = 5;
const FAN: u32 = 6;

/// Reads the mesh in a glTF file, metres. All meshes of the scene form one mesh; without a scene, all meshes of the file. Skins are read in their bind pose.
///
/// # Errors
/// If the file is truncated or not glTF 2.0, has no triangles, or contains wrong counts, indices out of range or numbers that are not finite. The error
/// begins with `place`, the path of the file; buffers in other files are searched beside this path.
pub fn read_gltf(place: &str, source: impl BufRead) -> Result<MeshFile> {
    let file = GltfFile::new(place, &all_bytes(place, source)?)?;
    let mut reading = Reading {
        place,
        file: &file,
        parts: JoinedParts::default(),
    };
    let description = &file.description;
    if description.scene.is_none() && description.scenes.is_empty() {
        for mesh in 0..description.meshes.len() {
            reading.add_mesh(mesh, &DAffine3::IDENTITY)?;
        }
    } else {
        let scene = description.scene.unwrap_or(0);
        for &node in &file.item("scene", &description.scenes, scene)?.nodes {
            reading.add_node(node, &DAffine3::IDENTITY, 0)?;
        }
    }
    reading.parts.into_file(place)
}

/// Meshes that have been read so far.
struct Reading<'a> {
    place: &'a str,
    file: &'a GltfFile<'a>,
    parts: JoinedParts,
}

impl Reading<'_> {
    /// Adds the meshes of a node and of the nodes in it.
    fn add_node(&mut self, index: usize, above: &DAffine3, depth: usize) -> Result<()> {
        let node = self
            .file
            .item("node", &self.file.description.nodes, index)?;
        let place = format!("{}, node {index}", self.place);
        self.parts.enter_node(&place, depth)?;
        let Some(own) = node.transform() else {
            let given = "a transform that is not affine";
            let allowed = "a matrix with the last row 0, 0, 0, 1, or a rotation of length one";
            return Err(Error::input(place, given, allowed));
        };
        let transform = *above * own;
        if let Some(mesh) = node.mesh {
            // The vertices of a skin are in the frame of the scene.
            let is_skin = node.skin.is_some();
            self.add_mesh(
                mesh,
                if is_skin {
                    &DAffine3::IDENTITY
                } else {
                    &transform
                },
            )?;
        }
        for &child in &node.children {
            self.add_node(child, &transform, depth + 1)?;
        }
        Ok(())
    }

    fn add_mesh(&mut self, index: usize, transform: &DAffine3) -> Result<()> {
        let file = self.file;
        let mesh = file.item("mesh", &file.description.meshes, index)?;
        for (number, primitive) in mesh.primitives.iter().enumerate() {
            let mode = primitive.mode.unwrap_or(TRIANGLES);
            if ![TRIANGLES, STRIP, FAN].contains(&mode) {
                continue;
            }
            let place = format!("{}, mesh {index}, primitive {number}", self.place);
            let Some(position) = primitive.attributes.position else {
                let allowed = "positions of the vertices";
                return Err(Error::input(place, "no `POSITION`", allowed));
            };
            let positions = file.positions(position)?;
            let corners = match primitive.indices {
                Some(indices) => file.indices(indices)?,
                None => (0..positions.len() as u32).collect(),
            };
            let triangles = match mode {
                STRIP => triangles_of_strip(&corners),
                FAN => triangles_of_fan(&corners),
                _ => triangles_of_list(&place, &corners)?,
            };
            self.parts.add(&place, transform, &positions, triangles)?;
        }
        Ok(())
    }
}
