//! Lines of TOML texts.

/// Returns the line number of a byte of a text, counted from 1.
pub fn line_of(text: &str, byte: usize) -> usize {
    1 + text[..byte.min(text.len())].matches('\n').count()
}
