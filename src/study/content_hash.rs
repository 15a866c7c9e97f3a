//! SHA-256 of what things are made of, to name them by their content.

use crate::mesh::TriangleMesh;
use crate::objects::{Model, SphereUnion};
use sha2::{Digest, Sha256};

/// A hash in the making.
#[derive(Clone, Default)]
pub struct ContentHash(Sha256);

impl ContentHash {
    /// Adds bytes or a text.
    pub fn bytes(mut self, bytes: impl AsRef<[u8]>) -> Self {
        self.0.update(bytes);
        self
    }

    /// Adds numbers, bit by bit.
    pub fn numbers(mut self, numbers: impl IntoIterator<Item = f64>) -> Self {
        for number in numbers {
            self.0.update(number.to_le_bytes());
        }
        self
    }

    /// Adds vertices (metres) and triangles.
    pub fn mesh(self, mesh: &TriangleMesh) -> Self {
        let vertices = mesh.vertices();
        let counted = self.bytes((vertices.len() as u64).to_le_bytes());
        let mut hash = counted.numbers(vertices.iter().flat_map(|v| v.to_array()));
        for corner in mesh.triangles().iter().flatten() {
            hash = hash.bytes(corner.to_le_bytes());
        }
        hash
    }

    /// Adds centres and radii, metres.
    fn spheres(self, spheres: &SphereUnion) -> Self {
        let numbers = spheres.spheres().iter().flat_map(|sphere| {
            let [x, y, z] = sphere.center.to_array();
            [x, y, z, sphere.radius]
        });
        self.numbers(numbers)
    }

    /// Adds what taxels touch.
    pub fn model(self, model: &Model) -> Self {
        match model {
            Model::Spheres(spheres) => self.bytes("spheres").spheres(spheres),
            Model::Mesh(mesh) => self.bytes("mesh").mesh(mesh.mesh()),
        }
    }

    /// The hash in 64 hexadecimal digits.
    pub fn hex(self) -> String {
        let digits = self.0.finalize();
        digits.iter().map(|byte| format!("{byte:02x}")).collect()
    }
}
