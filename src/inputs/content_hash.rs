//! SHA-256 of what things are made of, to name them by their content.

use crate::mesh::TriangleMesh;
use sha2::{Digest, Sha256};

/// The hash of bytes or a text, in 64 hexadecimal digits.
pub fn sha256(bytes: impl AsRef<[u8]>) -> String {
    let digits = Sha256::digest(bytes);
    digits.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The first digits of the hash of what something says of itself. Fewer: two of them may be taken for each other.
pub fn short_hash(said: impl AsRef<[u8]>, n_digits: usize) -> String {
    let mut digits = sha256(said);
    digits.truncate(n_digits);
    digits
}

/// Numbers, bit by bit.
pub fn bytes_of_numbers(numbers: impl IntoIterator<Item = f64>) -> Vec<u8> {
    numbers.into_iter().flat_map(f64::to_le_bytes).collect()
}

/// Vertices (metres) and triangles.
pub fn bytes_of_mesh(mesh: &TriangleMesh) -> Vec<u8> {
    let vertices = mesh.vertices();
    let mut bytes = (vertices.len() as u64).to_le_bytes().to_vec();
    bytes.extend(bytes_of_numbers(vertices.iter().flat_map(|v| v.to_array())));
    let corners = mesh.triangles().iter().flatten();
    bytes.extend(corners.flat_map(|corner| corner.to_le_bytes()));
    bytes
}
