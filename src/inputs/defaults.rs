//! Default values of keys, declared at the key: `#[serde(default = "number::<4>")]`.

/// Integer default of a fractional key.
pub(crate) fn number<const N: u32>() -> f64 {
    f64::from(N)
}

/// Default of a count.
pub(crate) fn count<const N: usize>() -> usize {
    N
}

pub(crate) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}
