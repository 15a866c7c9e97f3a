//! SHA-256 hashes that identify data by their content.

use crate::mesh::TriangleMesh;
use serde::{Serialize, Serializer};
use sha2::{Digest, Sha256};
use std::ops::Deref;
use std::sync::OnceLock;

/// Value with its hash; the hash replaces the value in identities. Its serialised form is the SHA-256 hash of its bytes, computed at first use.
#[derive(Clone, Debug)]
pub struct Hashed<T> {
    value: T,
    bytes: fn(&T) -> Vec<u8>,
    hash: OnceLock<String>,
}

impl<T> Hashed<T> {
    /// Wraps a value, which is then represented by the hash of its bytes. The function `bytes` converts the value to bytes; different values must give
    /// different bytes.
    pub fn new(value: T, bytes: fn(&T) -> Vec<u8>) -> Self {
        let hash = OnceLock::new();
        Self { value, bytes, hash }
    }
}

impl<T> Deref for Hashed<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T: PartialEq> PartialEq for Hashed<T> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl<T> Serialize for Hashed<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let hash = || sha256((self.bytes)(&self.value));
        serializer.serialize_str(self.hash.get_or_init(hash))
    }
}

/// Returns the SHA-256 hash of bytes or a text, as 64 hexadecimal digits.
pub fn sha256(bytes: impl AsRef<[u8]>) -> String {
    let digits = Sha256::digest(bytes).into_iter();
    let digits = digits.flat_map(|byte| [byte >> 4, byte & 0xf]);
    let digits = digits.map(|digit| char::from_digit(digit.into(), 16));
    digits
        .map(|digit| digit.expect("a half of a byte"))
        .collect()
}

/// Number of hexadecimal digits of an identity. With fewer digits, two inputs may get equal identities.
const IDENTITY_DIGITS: usize = 24;

/// Returns the canonical bytes (JSON) of inputs, which are equal exactly if the inputs are equal.
pub(crate) fn canonical(inputs: &impl Serialize) -> Vec<u8> {
    serde_json::to_vec(inputs).expect("inputs are plain values")
}

/// Returns the identity of inputs: the hash of their canonical bytes. Equal inputs have equal identities, and different inputs have different ones.
pub fn identity(inputs: &impl Serialize) -> String {
    short_hash(canonical(inputs), IDENTITY_DIGITS)
}

/// Returns the first `n_digits` hexadecimal digits of the SHA-256 hash of a text. If `n_digits` is small, two texts may have equal hashes.
pub fn short_hash(said: impl AsRef<[u8]>, n_digits: usize) -> String {
    let mut digits = sha256(said);
    digits.truncate(n_digits);
    digits
}

/// Converts whole numbers to bytes, preceded by their count.
pub fn bytes_of_counts<'a>(numbers: impl ExactSizeIterator<Item = &'a usize>) -> Vec<u8> {
    let n = numbers.len();
    let numbers = std::iter::once(n).chain(numbers.copied());
    numbers
        .flat_map(|number| (number as u64).to_le_bytes())
        .collect()
}

/// Converts floating-point numbers to their bytes in little-endian order.
pub fn bytes_of_numbers(numbers: impl IntoIterator<Item = f64>) -> Vec<u8> {
    numbers.into_iter().flat_map(f64::to_le_bytes).collect()
}

/// Converts the vertices (metres) and triangles of a mesh to bytes, from which a hash is computed.
pub fn bytes_of_mesh(mesh: &TriangleMesh) -> Vec<u8> {
    let vertices = mesh.vertices();
    let mut bytes = (vertices.len() as u64).to_le_bytes().to_vec();
    bytes.extend(bytes_of_numbers(vertices.iter().flat_map(|v| v.to_array())));
    let corners = mesh.triangles().iter().flatten();
    bytes.extend(corners.flat_map(|corner| corner.to_le_bytes()));
    bytes
}
