//! Lines of a journal, each of which consists of a checksum, a space and JSON.
//!
//! ```text
//! 1c291ca3 {"key":"piece 0f3a, trial 0","record":{…}}
//! ```
//!
//! The checksum of the first line, which identifies the study, is the CRC-32 of its JSON. Every other checksum continues the checksum of the first line, so
//! that a line is invalid in a journal of another study.

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use std::collections::BTreeMap;

/// Journal records as JSON, by key; if several lines have one key, the record of the last line is valid.
pub type Records = BTreeMap<String, Box<RawValue>>;

/// Error message for a journal whose first line does not identify a study.
pub const NO_STUDY: &str =
    "is no record of a study: nothing says which study the finished work is of";
const CHANGED: &str = "does not match its checksum: it was changed, or is of another study than line 1 or of an earlier version";

#[derive(Serialize)]
struct Written<'a, R> {
    key: &'a str,
    record: &'a R,
}

#[derive(Deserialize)]
struct Line {
    key: String,
    record: Box<RawValue>,
}

/// Encodes a record as a journal line with a line break; also returns the checksum of the line. The checksum of the journal's first line is `first`, or 0 for
/// the first line itself.
pub fn encode(first: u32, key: &str, record: &impl Serialize) -> serde_json::Result<(u32, String)> {
    let json = serde_json::to_string(&Written { key, record })?;
    let checksum = checksum(first, &json);
    Ok((checksum, format!("{checksum:08x} {json}\n")))
}

fn checksum(first: u32, json: &str) -> u32 {
    let mut hasher = crc32fast::Hasher::new_with_initial(first);
    hasher.update(json.as_bytes());
    hasher.finalize()
}

/// Decoded content of the complete lines of a journal.
#[derive(Debug, Default)]
pub struct Decoded {
    /// Record of the first line of the journal; `None` if this line is incomplete.
    pub header: Option<Box<RawValue>>,
    /// Checksum of the first line, which enters the checksums of all other lines.
    pub first: u32,
    /// Records of all lines except the first line, by key.
    pub records: Records,
    /// Number of bytes up to the end of the last complete line.
    pub n_whole: usize,
}

/// Decodes the complete lines of a journal whose first line contains the key `header`; ignores an incomplete last line. If a line is damaged and an
/// interrupted write cannot be the cause. The error contains the number of the line (from 1) and the defect.
pub fn decode(header: &str, bytes: &[u8]) -> Result<Decoded, (usize, &'static str)> {
    let mut decoded = Decoded::default();
    for (number, line) in bytes.split_inclusive(|&byte| byte == b'\n').enumerate() {
        let read = decode_line(decoded.first, line);
        match (read, number) {
            (Some((checksum, line)), 0) if line.key == header => {
                decoded.first = checksum;
                decoded.header = Some(line.record);
            }
            (Some((_, line)), 1..) => {
                decoded.records.insert(line.key, line.record);
            }
            // An incomplete last line was interrupted; a complete line with another checksum belongs to another study.
            (None, _) if decoded.n_whole + line.len() == bytes.len() && split(line).is_none() => {
                break;
            }
            (_, 0) => return Err((1, NO_STUDY)),
            _ => return Err((number + 1, CHANGED)),
        }
        decoded.n_whole += line.len();
    }
    Ok(decoded)
}

fn decode_line(first: u32, line: &[u8]) -> Option<(u32, Line)> {
    let (written, json, line) = split(line)?;
    let checksum = checksum(first, json);
    (written == format!("{checksum:08x}")).then_some((checksum, line))
}

/// Splits a complete line of a journal into its checksum, its JSON text and the decoded content.
fn split(line: &[u8]) -> Option<(&str, &str, Line)> {
    let line = std::str::from_utf8(line.strip_suffix(b"\n")?).ok()?;
    let (written, json) = line.split_once(' ')?;
    Some((written, json, serde_json::from_str(json).ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEYS: [&str; 5] = ["study", "a", "b\n\"", "c", "a"];

    fn lines(study: &str) -> Vec<String> {
        let (first, header) = encode(0, KEYS[0], &study).unwrap();
        let line = |number: usize| {
            let record = (number, 0.1 + number as f64);
            encode(first, KEYS[number], &record).unwrap().1
        };
        [vec![header], (1..KEYS.len()).map(line).collect()].concat()
    }

    fn file() -> Vec<u8> {
        lines("one").concat().into_bytes()
    }

    fn number(decoded: &Decoded, key: &str) -> Option<(usize, f64)> {
        let record = decoded.records.get(key)?;
        Some(serde_json::from_str(record.get()).unwrap())
    }

    fn damage(bytes: &[u8]) -> Option<(usize, &'static str)> {
        decode("study", bytes).err()
    }

    #[test]
    fn records_come_back_by_key_and_the_last_of_a_key_counts() {
        let decoded = decode("study", &file()).unwrap();
        assert_eq!(number(&decoded, "a"), Some((4, 4.1)));
        assert_eq!(number(&decoded, "b\n\""), Some((2, 2.1)));
        assert_eq!(number(&decoded, "d"), None);
        assert_eq!(decoded.n_whole, file().len());
        assert_eq!(decoded.header.unwrap().get(), "\"one\"");
    }

    #[test]
    fn wherever_a_file_ends_its_whole_lines_are_read_and_the_rest_is_not() {
        let bytes = file();
        let ends: Vec<usize> = (0..bytes.len()).filter(|&k| bytes[k] == b'\n').collect();
        for n in 0..bytes.len() {
            let decoded = decode("study", &bytes[..n]).unwrap();
            let whole = ends.iter().take_while(|&&end| end < n).count();
            let expected = whole.checked_sub(1).map_or(0, |last| ends[last] + 1);
            assert_eq!(decoded.n_whole, expected, "{n} bytes");
            assert_eq!(decoded.header.is_some(), whole > 0);
            assert_eq!(decoded.records.len(), whole.saturating_sub(1));
        }
    }

    #[test]
    fn a_byte_that_changes_within_a_file_is_noticed() {
        let bytes = file();
        let last = bytes.iter().rposition(|&b| b == b'{').unwrap();
        for k in 0..last - 20 {
            let mut bytes = bytes.clone();
            bytes[k] ^= 1;
            assert!(damage(&bytes).is_some(), "byte {k}");
        }
    }

    #[test]
    fn a_line_of_another_study_or_of_none_is_told_from_the_others() {
        let (ours, theirs) = (lines("one"), lines("two"));
        for foreign in [&theirs[1..], &ours[..1], &theirs[..]] {
            let bytes = [&ours[..], foreign, &ours[1..]].concat().concat();
            let (line, said) = damage(bytes.as_bytes()).unwrap();
            assert!(line == 6 && said.contains("of another study"), "{line}");
        }
        let last = [&ours[..], &theirs[1..2]].concat().concat();
        let (line, said) = damage(last.as_bytes()).unwrap();
        assert!(line == 6 && said.contains("of another study"), "{line}");
        let nameless = damage(ours[1..].concat().as_bytes());
        assert!(matches!(nameless, Some((1, said)) if said.starts_with("is no record")));
    }
}
