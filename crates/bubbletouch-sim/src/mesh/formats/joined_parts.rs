//! Polygons of several parts of a file, joined in one frame.

use crate::error::{Error, Result};
use crate::mesh::MeshFile;
use glam::{DAffine3, DVec3};

/// Largest number of polygons of a file. With a larger value, a small file whose nodes refer to each other repeatedly can fill the memory.
const MAX_POLYGONS: usize = 50_000_000;
/// Index that marks vertices that no polygon uses.
const UNUSED: u32 = u32::MAX;

/// Vertices and polygons of the parts of a file that have been added so far.
#[derive(Default)]
pub(super) struct JoinedParts {
    vertices: Vec<DVec3>,
    polygons: Vec<Vec<u32>>,
}

impl JoinedParts {
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
        polygons: &[Vec<u32>],
    ) -> Result<()> {
        if self.polygons.len() + polygons.len() > MAX_POLYGONS {
            let given = "too many polygons";
            return Err(Error::input(
                place,
                given,
                format!("at most {MAX_POLYGONS}"),
            ));
        }
        let is_mirrored = transform.matrix3.determinant() < 0.0;
        let mut new_index = vec![UNUSED; positions.len()];
        for (number, corners) in polygons.iter().enumerate() {
            let mut polygon = Vec::with_capacity(corners.len());
            for &corner in corners {
                let Some(index) = new_index.get_mut(corner as usize) else {
                    return Err(Error::input(
                        format!("{place}: face {}", number + 1),
                        format!("vertex index {corner}"),
                        match positions.len() {
                            0 => "a part with vertices".to_owned(),
                            n => format!("0 to {}, the indices of the vertices", n - 1),
                        },
                    ));
                };
                if *index == UNUSED {
                    *index = self.vertices.len() as u32;
                    self.vertices
                        .push(transform.transform_point3(positions[corner as usize]));
                }
                polygon.push(*index);
            }
            if is_mirrored {
                polygon.reverse();
            }
            self.polygons.push(polygon);
        }
        Ok(())
    }

    /// Returns all parts as the contents of one file.
    ///
    /// # Errors
    /// If there are no polygons, a polygon has fewer than three corners, or a coordinate is not finite.
    pub fn into_file(self, place: &str) -> Result<MeshFile> {
        if self.polygons.is_empty() {
            return Err(Error::input(
                place,
                "no faces",
                "a file with triangles or polygons",
            ));
        }
        MeshFile::new(place, self.vertices, self.polygons)
    }
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
