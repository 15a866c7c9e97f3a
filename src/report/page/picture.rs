//! HTML elements for pictures on a page.

use crate::report::pictures::drawing::escape;

/// Returns an HTML element that contains a PNG file and shows it with the given width and height in pixels. The title is the text for screen readers.
pub(crate) fn png_element(png: &[u8], (width, height): (usize, usize), title: &str) -> String {
    let (data, title) = (base64(png), escape(title));
    format!(
        r#"<img src="data:image/png;base64,{data}" width="{width}" height="{height}" alt="{title}">"#
    )
}

/// Returns an HTML `<figure>` with the given attributes, which contains an `<svg>` or `<img>` element.
pub(crate) fn figure(attributes: &str, element: &str, title: &str) -> String {
    let title = escape(title);
    format!("<figure {attributes} tabindex=\"0\" aria-label=\"{title}\">{element}</figure>")
}

/// Encodes bytes as base64 (RFC 4648) with padding.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let byte = |i: usize| u32::from(group.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for place in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * place)) as usize & 63];
            text.push(if place <= group.len() {
                char::from(letter)
            } else {
                '='
            });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_agrees_with_the_examples_of_rfc_4648() {
        for (bytes, text) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }
}
