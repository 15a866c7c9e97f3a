//! Linear algebra: products of rows and factors of symmetric matrices.

pub(crate) mod centered_row;
pub(crate) mod factors;
pub(crate) mod few_dimensions;
pub(crate) mod lanes;
pub(crate) mod products;
pub(crate) mod row_products;
pub(crate) mod row_tiles;
pub(crate) mod scalar;
pub(crate) mod transposed;
#[cfg(target_arch = "x86_64")]
pub(crate) mod vector_registers;
