//! Decoding of texts: UTF-8, UTF-16 with a byte order mark, and Latin-1.

/// Decodes the bytes of a file as UTF-8, as UTF-16 if there is a byte order mark, otherwise as Latin-1 with a note.
pub fn decoded(place: &str, bytes: &[u8]) -> (String, Option<String>) {
    let units = |from: fn([u8; 2]) -> u16| {
        let pairs = bytes[2..].chunks_exact(2);
        let units: Vec<u16> = pairs.map(|pair| from([pair[0], pair[1]])).collect();
        String::from_utf16_lossy(&units)
    };
    let note = format!("{place}: not UTF-8; it is read as Latin-1 (ISO 8859-1)");
    match bytes {
        [0xFF, 0xFE, ..] => (units(u16::from_le_bytes), None),
        [0xFE, 0xFF, ..] => (units(u16::from_be_bytes), None),
        _ => match std::str::from_utf8(bytes) {
            Ok(text) => (text.to_owned(), None),
            Err(_) => (latin1(bytes), Some(note)),
        },
    }
}

/// Decodes bytes as UTF-8, otherwise as Latin-1 (ISO 8859-1).
pub fn utf8_or_latin1(bytes: &[u8]) -> String {
    std::str::from_utf8(bytes).map_or_else(|_| latin1(bytes), str::to_owned)
}

fn latin1(bytes: &[u8]) -> String {
    bytes.iter().map(|&byte| char::from(byte)).collect()
}
