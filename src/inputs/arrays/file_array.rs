//! An array as it stands in a file.

/// What the elements of a file are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ElementKind {
    /// Floating-point numbers with this spacing relative to their size.
    Float(f64),
    /// Integers.
    Integer,
    /// False and true.
    Truth,
    /// Texts.
    Text,
}

/// The elements of a file in row-major order.
#[derive(Clone, Debug, PartialEq)]
pub enum Elements {
    /// Numbers; false is 0, true is 1.
    Numbers(Vec<f64>),
    /// Texts without their padding.
    Texts(Vec<String>),
}

/// An array as it stands in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct FileArray {
    /// The name of the file, and of its member if it is an archive, for errors.
    pub place: String,
    /// Lengths of the axes.
    pub shape: Vec<usize>,
    /// What the elements are.
    pub kind: ElementKind,
    /// The elements in row-major order.
    pub elements: Elements,
}
