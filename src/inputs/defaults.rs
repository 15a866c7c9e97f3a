//! Functions that return the default values of keys. A key declares its default by `#[serde(default = "number::<4>")]`.

/// Returns the default `N` of a key with a floating-point value.
pub(crate) fn number<const N: u32>() -> f64 {
    f64::from(N)
}

/// Returns the default `N` of a key with a whole number.
pub(crate) fn count<const N: usize>() -> usize {
    N
}

pub(crate) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}
