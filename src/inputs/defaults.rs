//! Default values of keys. A key declares its default by `#[serde(default = "number::<4>")]`.

/// Returns the integer N as the default of a fractional key.
pub(crate) fn number<const N: u32>() -> f64 {
    f64::from(N)
}

/// Returns N as the default of a count.
pub(crate) fn count<const N: usize>() -> usize {
    N
}

pub(crate) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}
