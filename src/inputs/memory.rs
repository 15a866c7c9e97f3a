//! Bytes: what there are, what is asked for, and in words.

use std::{fmt, fs};

/// Bytes of a gibibyte.
pub const GIB: f64 = (1u64 << 30) as f64;

/// Bytes of memory that this process may use: the machine's, or its control group's if that is less; `None` where the system
/// does not tell.
pub fn machine_memory() -> Option<u64> {
    let of_machine = kilobytes("/proc/meminfo", "MemTotal")?;
    let group = fs::read_to_string("/sys/fs/cgroup/memory.max").ok();
    let of_group = group.and_then(|text| text.trim().parse::<u64>().ok());
    Some(of_group.map_or(of_machine, |bytes| bytes.min(of_machine)))
}

/// Most bytes that this process has held so far; `None` where the system does not tell.
pub fn peak_memory() -> Option<u64> {
    kilobytes("/proc/self/status", "VmHWM")
}

/// What is allowed in place of something that takes more bytes than the ceiling (`None`: there is none).
pub(crate) fn check_memory(
    bytes: f64,
    ceiling: Option<u64>,
    what: &str,
) -> std::result::Result<(), String> {
    match ceiling.map(|ceiling| ceiling as f64) {
        Some(ceiling) if bytes > ceiling => Err(format!(
            "fewer: {what} would take {}, and there are {}",
            Bytes(bytes),
            Bytes(ceiling)
        )),
        _ => Ok(()),
    }
}

/// A line `Key:  123 kB` of a file, in bytes.
fn kilobytes(path: &str, key: &str) -> Option<u64> {
    let text = fs::read_to_string(path).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    let number = line.trim_start_matches(':').trim().strip_suffix("kB")?;
    Some(number.trim().parse::<u64>().ok()? * 1024)
}

/// A number of bytes in words: 12 MiB, 1.5 GiB.
pub struct Bytes(pub f64);

impl fmt::Display for Bytes {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let mib = self.0 / f64::from(1 << 20);
        match mib {
            _ if mib < 1.0 => write!(f, "1 MiB"),
            _ if mib < 1024.0 => write!(f, "{mib:.0} MiB"),
            _ => write!(f, "{:.1} GiB", mib / 1024.0),
        }
    }
}
