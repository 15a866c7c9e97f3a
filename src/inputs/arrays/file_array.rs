//! Arrays as stored in files: shape, element kind and elements.

/// Kind of the elements of an array file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ElementKind {
    /// Floating-point numbers with the given relative spacing.
    Float(f64),
    /// Signed or unsigned integers.
    Integer,
    /// Boolean values.
    Truth,
    /// Unicode texts or ASCII texts.
    Text,
}

/// Elements of an array file in row-major order.
#[derive(Clone, Debug, PartialEq)]
pub enum Elements {
    /// Numbers; false is stored as 0, and true as 1.
    Numbers(Vec<f64>),
    /// Texts without their padding.
    Texts(Vec<String>),
}

/// Array as stored in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct FileArray {
    /// Name of the file and of the archive member, for error messages.
    pub place: String,
    /// Lengths of the array's axes.
    pub shape: Vec<usize>,
    /// Kind of the elements.
    pub kind: ElementKind,
    /// Elements in row-major order.
    pub elements: Elements,
}
