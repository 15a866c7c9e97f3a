//! Values of keys that are left out, said beside the key: `#[serde(default = "number::<4>")]`.

/// A whole number of something that may be a fraction.
pub(crate) fn number<const N: u32>() -> f64 {
    f64::from(N)
}

/// A count.
pub(crate) fn count<const N: usize>() -> usize {
    N
}

pub(crate) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}
