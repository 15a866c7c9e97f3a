//! Sizes of the blocks of class pairs that are solved together.

/// Dimension of the subspace in which the first rows are selected. If larger, the selection is better but slower; if smaller, more rounds follow.
pub(crate) const FEW_DIMENSIONS: usize = 64;

/// Number of classes per block; their pairs with [`OTHERS_AT_ONCE`] other classes are solved together. If larger, their products exceed the cache; if smaller,
/// the tiles of matrix products are incomplete.
pub(crate) const CLASSES_AT_ONCE: usize = 8;

/// Number of other classes per block, with which [`CLASSES_AT_ONCE`] classes are paired. If larger, their rows near margins exceed the second-level cache; if
/// smaller, there are more blocks.
pub(crate) const OTHERS_AT_ONCE: usize = 4;
