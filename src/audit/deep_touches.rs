//! Touches that lie deep in a class, which a check, a table and a picture show.

/// Touch with a doubtful label.
pub struct Doubtful {
    /// Index of the touch.
    pub touch: usize,
    /// Class that the classifier predicts.
    pub class: usize,
}

/// Touches that lie deep in a class although they have the label of another class.
pub struct DoubtfulPair {
    /// Label of the touches.
    pub label: usize,
    /// Class in which they lie.
    pub class: usize,
    /// Number of these touches.
    pub n_doubtful: usize,
    /// Number of touches with one of the two labels that lie deep in the class.
    pub n_deep: usize,
    /// Fraction of the touches of the two classes that the classifier does not exchange, without touches whose labels would be wrong.
    pub accuracy: f64,
}

/// Touches that lie deep in a class.
pub struct DeepTouches {
    /// Touches with another label than the class in which they lie, the deepest first.
    pub doubtful: Vec<Doubtful>,
    /// Number of touches that lie deep in a class, with any label.
    pub n_deep: usize,
    /// Fraction of the touches of the tested classes that the classifier recognises.
    pub accuracy: f64,
    /// Pairs of a label and a class with at least one doubtful touch.
    pub pairs: Vec<DoubtfulPair>,
    /// Number of pairs of a label and a class that were compared.
    pub n_pairs: usize,
}
