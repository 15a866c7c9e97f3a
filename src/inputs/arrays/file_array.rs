//! Contents of array files: shape, element type and elements.

/// Kind of the elements of an array file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ElementKind {
    /// Floating-point numbers; the value is the relative spacing of neighbouring numbers.
    Float(f64),
    /// Signed or unsigned integers.
    Integer,
    /// Truth values (booleans).
    Truth,
    /// Texts in Unicode or ASCII.
    Text,
}

/// Elements of an array in row-major order.
#[derive(Clone, Debug, PartialEq)]
pub enum Elements {
    /// Numbers; false is stored as 0, and true as 1.
    Numbers(Vec<f64>),
    /// Texts without the padding zeros of fixed-length texts.
    Texts(Vec<String>),
}

/// Array as it is stored in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct FileArray {
    /// Name of the file and of the archive member, for error messages.
    pub place: String,
    /// Lengths of the array's axes.
    pub shape: Vec<usize>,
    /// Kind of the elements: floating-point numbers, integers, truth values or texts.
    pub kind: ElementKind,
    /// Elements of the array in row-major order.
    pub elements: Elements,
    /// Names of the columns of a table; `None` for other files and for a table without names.
    pub columns: Option<Vec<String>>,
    /// Place, given and allowed content of the error of the first text in a table; `None` for other files.
    pub refusal: Option<[String; 3]>,
}
