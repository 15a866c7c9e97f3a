//! Letters of an axis.

/// Font size of tick labels.
pub(super) const TICK_SIZE: u32 = 12;
