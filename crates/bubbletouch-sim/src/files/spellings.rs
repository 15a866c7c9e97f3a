//! Spellings of file names in the files of other programs.

/// Returns the spellings of a file name that are searched: as written, with `/` in place of Windows' `\`, and with decoded escapes such as `%20`.
pub(crate) fn spellings(path: &str) -> Vec<String> {
    let mut all = vec![path.to_owned()];
    if path.contains('\\') {
        all.push(path.replace('\\', "/"));
    }
    if let Some(decoded) = percent_decoded(path) {
        all.push(decoded);
    }
    all
}

/// Returns a path with decoded bytes such as `%20`; `None` if it contains none, or if the result is not UTF-8.
fn percent_decoded(path: &str) -> Option<String> {
    let mut parts = path.split('%');
    let mut bytes = parts.next()?.as_bytes().to_vec();
    for part in parts {
        let is_hexadecimal = |code: &&str| code.bytes().all(|byte| byte.is_ascii_hexdigit());
        let code = part.get(..2).filter(is_hexadecimal);
        let (byte, rest) = match code.and_then(|code| u8::from_str_radix(code, 16).ok()) {
            Some(byte) => (byte, &part[2..]),
            None => (b'%', part),
        };
        bytes.push(byte);
        bytes.extend_from_slice(rest.as_bytes());
    }
    let decoded = String::from_utf8(bytes).ok();
    decoded.filter(|decoded| decoded != path)
}
