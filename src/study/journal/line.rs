//! A line of a journal: the checksum of what follows, a space, and JSON.
//!
//! ```text
//! 1c291ca3 {"key":"cell 0, trial 0","record":{…}}
//! ```

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use std::collections::BTreeMap;

/// Records by key, as JSON; of those with the same key the last.
pub type Records = BTreeMap<String, Box<RawValue>>;

#[derive(Serialize)]
struct Written<'a, R> {
    key: &'a str,
    record: &'a R,
}

#[derive(Deserialize)]
struct Read {
    key: String,
    record: Box<RawValue>,
}

/// One line with its end.
pub fn encode(key: &str, record: &impl Serialize) -> serde_json::Result<String> {
    let json = serde_json::to_string(&Written { key, record })?;
    Ok(format!("{:08x} {json}\n", crc32fast::hash(json.as_bytes())))
}

/// What the lines of a file say.
pub struct Decoded {
    /// Records of the whole lines.
    pub records: Records,
    /// Bytes up to the end of the last whole line.
    pub n_whole: usize,
    /// Number from 1 of a line that is broken though others follow it: no interrupted write leaves that behind.
    pub broken: Option<usize>,
}

/// Reads lines up to the first that is torn.
pub fn decode(bytes: &[u8]) -> Decoded {
    let mut decoded = Decoded {
        records: Records::new(),
        n_whole: 0,
        broken: None,
    };
    for (number, line) in bytes.split_inclusive(|&byte| byte == b'\n').enumerate() {
        let Some(read) = decode_line(line) else {
            let is_last = decoded.n_whole + line.len() == bytes.len();
            decoded.broken = (!is_last).then_some(number + 1);
            break;
        };
        decoded.records.insert(read.key, read.record);
        decoded.n_whole += line.len();
    }
    decoded
}

fn decode_line(line: &[u8]) -> Option<Read> {
    let line = std::str::from_utf8(line.strip_suffix(b"\n")?).ok()?;
    let (checksum, json) = line.split_once(' ')?;
    let is_whole = checksum == format!("{:08x}", crc32fast::hash(json.as_bytes()));
    is_whole.then(|| serde_json::from_str(json).ok())?
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file() -> Vec<u8> {
        let lines = ["a", "b\n\"", "c", "a"].iter().enumerate();
        let lines = lines.map(|(k, key)| encode(key, &(k, 0.1 + k as f64)).unwrap());
        lines.collect::<String>().into_bytes()
    }

    fn number(decoded: &Decoded, key: &str) -> Option<(usize, f64)> {
        let record = decoded.records.get(key)?;
        Some(serde_json::from_str(record.get()).unwrap())
    }

    #[test]
    fn what_is_written_is_read_and_the_last_of_a_key_counts() {
        let decoded = decode(&file());
        assert_eq!((decoded.n_whole, decoded.broken), (file().len(), None));
        assert_eq!(number(&decoded, "b\n\""), Some((1, 1.1)));
        assert_eq!(number(&decoded, "a"), Some((3, 3.1)));
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
                (decoded.n_whole, decoded.broken),
                (expected, None),
                "{n} bytes"
            );
            assert_eq!(decoded.records.len(), whole);
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
            assert!(decoded.broken.is_some(), "byte {k}");
        }
    }
}
