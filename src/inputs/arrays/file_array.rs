//! Arrays as stored in files.

/// Kind of the elements of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ElementKind {
    /// Floating-point numbers with this relative spacing.
    Float(f64),
    /// Integers.
    Integer,
    /// Booleans.
    Truth,
    /// Texts.
    Text,
}

/// Elements of a file in row-major order.
#[derive(Clone, Debug, PartialEq)]
pub enum Elements {
    /// Numbers; false is 0, and true is 1.
    Numbers(Vec<f64>),
    /// Texts without their padding.
    Texts(Vec<String>),
}

/// Array as stored in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct FileArray {
    /// Name of the file, and of the member of an archive, for error messages.
    pub place: String,
    /// Lengths of the axes.
    pub shape: Vec<usize>,
    /// Kind of the elements.
    pub kind: ElementKind,
    /// The elements in row-major order.
    pub elements: Elements,
}
