//! Sizes of the blocks of class pairs whose binary problems are solved together.

/// Dimension of the subspace in which screening first selects rows near the decision boundaries. With a larger value, the selection is better but slower; with
/// a smaller value, more rounds follow.
pub(crate) const FEW_DIMENSIONS: usize = 64;

/// Number of classes per block of screening; the pairs of these classes with [`OTHERS_AT_ONCE`] other classes are solved together. With a larger value, their
/// products exceed the cache; with a smaller value, the tiles of matrix products are incomplete.
pub(crate) const CLASSES_AT_ONCE: usize = 8;

/// Number of classes per block with which each of [`CLASSES_AT_ONCE`] classes is paired in screening. With a larger value, the rows near their margins exceed
/// the second-level cache; with a smaller value, there are more blocks.
pub(crate) const OTHERS_AT_ONCE: usize = 4;
