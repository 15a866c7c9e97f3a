//! Pairs of near-duplicates, which a check, a table and a picture show.

/// Touches whose distances to other touches were tested.
pub struct Comparison {
    /// Display words of the comparison.
    pub words: &'static str,
    /// Number of tested touches.
    pub n_tested: usize,
    /// Probability of at least as many pairs by chance; for touches as recorded and for exact copies, the smallest p-value of a touch times the number of tested touches.
    pub p_value: f64,
    /// Touches with a near-duplicate, the nearest touch of each, and the p-value.
    pub found: Vec<(usize, usize, f64)>,
}

/// Pairs of near-duplicates of an audit.
pub struct DuplicatePairs {
    /// Pairs of a touch and its near-duplicate, the pairs with the smallest p-values first.
    pub pairs: Vec<(usize, usize)>,
    /// p-value of the hypothesis that there are no near-duplicates.
    pub p_value: f64,
    /// Largest fraction of tested touches with a near-duplicate.
    pub share: f64,
    pub comparisons: Vec<Comparison>,
}
