//! Polygons of several parts of a file, joined in one frame.

use crate::error::{Error, Result};
use crate::mesh::MeshFile;
use crate::mesh::triangle_mesh::check_indices;
use glam::{DAffine3, DMat3, DMat4, DVec3, DVec4};

/// Largest number of polygons of a file. With a larger value, a small file whose nodes refer to each other repeatedly can fill the memory.
const MAX_POLYGONS: usize = 50_000_000;
/// Largest depth of the tree of nodes. A deeper tree indicates nodes that contain each other.
const MAX_DEPTH: usize = 100;
/// Largest number of nodes, of which each counts as often as other nodes refer to it. With a larger value, a small file whose nodes refer to each other
/// repeatedly takes hours; with a smaller value, large scenes are refused.
const MAX_NODES: usize = 1_000_000;
/// Index that marks positions that no polygon uses.
const UNUSED: u32 = u32::MAX;

/// Vertices and polygons of the parts of a file that have been added so far.
#[derive(Default)]
pub(super) struct JoinedParts {
    vertices: Vec<DVec3>,
    polygons: Vec<Vec<u32>>,
    n_nodes: usize,
}

impl JoinedParts {
    /// Counts a node of the tree of nodes, with its depth in the tree.
    ///
    /// # Errors
    /// If the node is so deep in the tree that nodes contain each other, or if there are too many nodes.
    pub fn enter_node(&mut self, place: &str, depth: usize) -> Result<()> {
        self.n_nodes += 1;
        let given = match self.n_nodes > MAX_NODES {
            true => format!("more than {MAX_NODES} nodes, counted as often as others contain them"),
            false if depth > MAX_DEPTH => format!("nodes inside each other, {MAX_DEPTH} deep"),
            false => return Ok(()),
        };
        Err(Error::input(place, given, "a tree of nodes"))
    }

    /// Adds polygons, which contain indices of `positions`, under a transform. If the transform mirrors, the polygons are turned. Positions that no polygon uses
    /// are omitted.
    ///
    /// # Errors
    /// If an index does not exist, or the file has too many polygons; errors begin with `place`, the location of the part.
    pub fn add(
        &mut self,
        place: &str,
        transform: &DAffine3,
        positions: &[DVec3],
        mut polygons: Vec<Vec<u32>>,
    ) -> Result<()> {
        if self.polygons.len() + polygons.len() > MAX_POLYGONS {
            let allowed = format!("at most {MAX_POLYGONS}");
            return Err(Error::input(place, "too many polygons", allowed));
        }
        check_indices(place, &polygons, positions.len())?;
        let first = self.vertices.len() as u32;
        let used = used_positions(positions, &mut polygons).into_iter();
        self.vertices
            .extend(used.map(|position| transform.transform_point3(position)));
        let is_mirrored = transform.matrix3.determinant() < 0.0;
        for polygon in &mut polygons {
            polygon.iter_mut().for_each(|corner| *corner += first);
            if is_mirrored {
                polygon.reverse();
            }
        }
        self.polygons.append(&mut polygons);
        Ok(())
    }

    /// Returns all parts as the contents of one file.
    ///
    /// # Errors
    /// If there are no polygons, a polygon has fewer than three corners, or a coordinate is not finite.
    pub fn into_file(self, place: &str) -> Result<MeshFile> {
        if self.polygons.is_empty() {
            let allowed = "a file with triangles or polygons";
            return Err(Error::input(place, "no faces", allowed));
        }
        MeshFile::new(place, self.vertices, self.polygons)
    }
}

/// Returns the positions that polygons use, in the order of their first use, and replaces the indices in the polygons. All indices must exist.
pub(super) fn used_positions(positions: &[DVec3], polygons: &mut [Vec<u32>]) -> Vec<DVec3> {
    let mut new_indices = vec![UNUSED; positions.len()];
    let mut used = Vec::new();
    for corner in polygons.iter_mut().flatten() {
        let index = &mut new_indices[*corner as usize];
        if *index == UNUSED {
            *index = used.len() as u32;
            used.push(positions[*corner as usize]);
        }
        *corner = *index;
    }
    used
}

/// Returns the affine map of a matrix; `None` if its last row is not 0, 0, 0, 1.
pub(super) fn affine(matrix: &DMat4) -> Option<DAffine3> {
    let is_affine = matrix.row(3) == DVec4::W;
    let linear = DMat3::from_mat4(*matrix);
    is_affine.then(|| DAffine3::from_mat3_translation(linear, matrix.w_axis.truncate()))
}

/// Returns the triangles of a list with three corners each.
///
/// # Errors
/// If the number of corners is no multiple of three; the error begins with `place`.
pub(super) fn triangles_of_list(place: &str, corners: &[u32]) -> Result<Vec<Vec<u32>>> {
    if !corners.len().is_multiple_of(3) {
        let given = format!("{} corners of triangles", corners.len());
        return Err(Error::input(place, given, "three for each triangle"));
    }
    Ok(corners.chunks_exact(3).map(<[u32]>::to_vec).collect())
}

/// Returns the triangles of a strip; every second one is turned.
pub(super) fn triangles_of_strip(strip: &[u32]) -> Vec<Vec<u32>> {
    let triangles = strip.windows(3).enumerate();
    let turned = triangles.map(|(index, corners)| match index % 2 {
        0 => corners.to_vec(),
        _ => vec![corners[1], corners[0], corners[2]],
    });
    turned.collect()
}

/// Returns the triangles of a fan around its first corner.
pub(super) fn triangles_of_fan(fan: &[u32]) -> Vec<Vec<u32>> {
    let pairs = fan.get(1..).unwrap_or_default().windows(2);
    pairs.map(|pair| vec![fan[0], pair[0], pair[1]]).collect()
}
