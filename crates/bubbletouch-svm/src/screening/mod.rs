//! Screening: one-vs-one linear problems are solved on the rows near their decision boundaries.

pub(crate) mod block_sizes;
pub(crate) mod first_rows;
pub(crate) mod margin_pair;
pub(crate) mod margin_rows;
pub(crate) mod near_margin;
