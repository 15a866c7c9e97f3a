//! Summary of a press: travel and numbers of taxels.

/// Summary of a press; its deflections are in the [`Workspace`](super::Workspace).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contact {
    /// Travel of the patch along its direction from the given pose, metres; negative if the patch went backwards.
    pub travel: f64,
    /// Number of taxels with a deflection above zero.
    pub n_touched: usize,
    /// Number of taxels at their stroke that an object would push further.
    pub n_saturated: usize,
}
