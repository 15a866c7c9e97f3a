//! Summary of a press: travel and numbers of touched and saturated taxels.

/// Summary of a press: travel and numbers of taxels. The workspace of the press contains the deflections.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contact {
    /// Travel of the patch along its direction from the given pose, metres; negative if the patch moved backwards.
    pub travel: f64,
    /// Number of taxels with a deflection above zero.
    pub n_touched: usize,
    /// Number of saturated taxels, that is, taxels at their stroke that an object would push further.
    pub n_saturated: usize,
}
