//! A property of every taxel of a patch: one for all, or one each.

/// What the taxels of a patch have, in the order of its layout.
#[derive(Clone, Debug, PartialEq)]
pub enum PerTaxel<T> {
    /// All the same.
    Equal(T),
    /// One each, in the order of the layout.
    Each(Vec<T>),
}

impl<T> From<T> for PerTaxel<T> {
    fn from(all: T) -> Self {
        Self::Equal(all)
    }
}

impl<T> PerTaxel<T> {
    /// That of one taxel.
    ///
    /// # Panics
    /// If there are not that many.
    pub fn at(&self, taxel: usize) -> &T {
        match self {
            Self::Equal(equal) => equal,
            Self::Each(each) => &each[taxel],
        }
    }

    /// Each value that there is: one, or as many as taxels.
    pub fn all(&self) -> &[T] {
        match self {
            Self::Equal(equal) => std::slice::from_ref(equal),
            Self::Each(each) => each,
        }
    }
}
