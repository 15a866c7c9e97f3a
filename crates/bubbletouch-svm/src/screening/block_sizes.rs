//! Sizes of the blocks of pairs that are solved together.

/// Dimensions in which the first rows are searched. Larger: the first rows are better, and cost more; smaller: more rounds follow.
pub(crate) const FEW_DIMENSIONS: usize = 64;

/// Classes whose pairs with [`OTHERS_AT_ONCE`] others are solved together. Larger: their products do not stay in the cache; smaller: the tiles of
/// products are not filled.
pub(crate) const CLASSES_AT_ONCE: usize = 8;

/// Other classes of a block, see [`CLASSES_AT_ONCE`]. Larger: their rows near margins do not stay in the second-level cache; smaller: more blocks.
pub(crate) const OTHERS_AT_ONCE: usize = 4;
