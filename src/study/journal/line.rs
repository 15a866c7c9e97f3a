//! A line of a journal: the checksum of what follows, a space, and JSON.
//!
//! ```text
//! 1c291ca3 {"of":"5d41402abc4b2a76","key":"cell 0, trial 0","record":{…}}
//! ```
//!
//! `of` is the same in every line: what it says of the study ([`Identity`](super::Identity)) keeps lines of two studies apart.

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use std::collections::BTreeMap;

/// Records by key, as JSON; of those with the same key the last.
pub type Records = BTreeMap<String, Box<RawValue>>;

#[derive(Serialize)]
struct Written<'a, R> {
    of: &'a str,
    key: &'a str,
    record: &'a R,
}

/// A whole line.
#[derive(Deserialize)]
pub struct Line {
    /// What binds it to its study; nothing in journals of older programs.
    #[serde(default)]
    pub of: String,
    /// What was kept.
    pub key: String,
    /// The same, as JSON.
    pub record: Box<RawValue>,
}

/// One line with its end.
pub fn encode(of: &str, key: &str, record: &impl Serialize) -> serde_json::Result<String> {
    let json = serde_json::to_string(&Written { of, key, record })?;
    Ok(format!("{:08x} {json}\n", crc32fast::hash(json.as_bytes())))
}

/// What the lines of a file say.
#[derive(Default)]
pub struct Decoded {
    /// The first line, if it is whole.
    pub first: Option<Line>,
    /// Records of the other whole lines.
    pub records: Records,
    /// Bytes up to the end of the last whole line.
    pub n_whole: usize,
    /// Number from 1 of a line that no interrupted write leaves behind, and what is wrong with it.
    pub damage: Option<(usize, &'static str)>,
}

/// Reads lines up to the first that is torn, or foreign.
pub fn decode(bytes: &[u8]) -> Decoded {
    let mut decoded = Decoded::default();
    for (number, line) in bytes.split_inclusive(|&byte| byte == b'\n').enumerate() {
        let Some(read) = decode_line(line) else {
            let is_last = decoded.n_whole + line.len() == bytes.len();
            let given = "does not match its checksum, though lines follow it";
            decoded.damage = (!is_last).then_some((number + 1, given));
            break;
        };
        match &decoded.first {
            None => decoded.first = Some(read),
            Some(first) if read.key == first.key || read.of != first.of => {
                let given = "is of another study than line 1, or begins one anew";
                decoded.damage = Some((number + 1, given));
                break;
            }
            Some(_) => {
                decoded.records.insert(read.key, read.record);
            }
        }
        decoded.n_whole += line.len();
    }
    decoded
}

fn decode_line(line: &[u8]) -> Option<Line> {
    let line = std::str::from_utf8(line.strip_suffix(b"\n")?).ok()?;
    let (checksum, json) = line.split_once(' ')?;
    let is_whole = checksum == format!("{:08x}", crc32fast::hash(json.as_bytes()));
    is_whole.then(|| serde_json::from_str(json).ok())?
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(of: &str, key: &str, number: usize) -> String {
        encode(of, key, &(number, 0.1 + number as f64)).unwrap()
    }

    fn file() -> Vec<u8> {
        let lines = ["study", "a", "b\n\"", "c", "a"].iter().enumerate();
        let lines = lines.map(|(number, key)| line("1f", key, number));
        lines.collect::<String>().into_bytes()
    }

    fn number(decoded: &Decoded, key: &str) -> Option<(usize, f64)> {
        let record = decoded.records.get(key)?;
        Some(serde_json::from_str(record.get()).unwrap())
    }

    #[test]
    fn what_is_written_is_read_and_the_last_of_a_key_counts() {
        let decoded = decode(&file());
        assert_eq!((decoded.n_whole, decoded.damage), (file().len(), None));
        assert_eq!(decoded.first.as_ref().unwrap().key, "study");
        assert_eq!(number(&decoded, "b\n\""), Some((2, 2.1)));
        assert_eq!(number(&decoded, "a"), Some((4, 4.1)));
    }

    #[test]
    fn wherever_a_file_ends_its_whole_lines_are_read_and_the_rest_is_not() {
        let bytes = file();
        let ends: Vec<usize> = (0..bytes.len()).filter(|&k| bytes[k] == b'\n').collect();
        for n in 0..bytes.len() {
            let decoded = decode(&bytes[..n]);
            let whole = ends.iter().take_while(|&&end| end < n).count();
            let expected = whole.checked_sub(1).map_or(0, |last| ends[last] + 1);
            assert_eq!(
                (decoded.n_whole, decoded.damage),
                (expected, None),
                "{n} bytes"
            );
            assert_eq!(decoded.first.is_some(), whole > 0);
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
            let decoded = decode(&bytes);
            assert!(decoded.damage.is_some(), "byte {k}");
        }
    }

    #[test]
    fn a_line_of_another_study_is_told_from_the_others() {
        for foreign in [line("2e", "d", 5), line("1f", "study", 5)] {
            let bytes = [file(), foreign.into_bytes(), file()].concat();
            let decoded = decode(&bytes);
            assert!(matches!(decoded.damage, Some((6, said)) if said.starts_with("is of another")));
        }
    }
}
