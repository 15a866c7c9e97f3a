//! Summary of a press: travel and numbers of touched and saturated taxels.

/// Summary of a press: travel of the patch and numbers of taxels. The `Workspace` of the press contains the deflections.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contact {
    /// Travel of the patch along its direction from the given pose, metres; negative if the patch moved backwards.
    pub travel: f64,
    /// Number of taxels with a deflection above zero.
    pub n_touched: usize,
    /// Number of saturated taxels, which an object pushes beyond the end of their stroke.
    pub n_saturated: usize,
}
