//! Memory sizes in bytes: available, used and required memory, and their text format.

use std::{fmt, fs};

/// Number of bytes in a gibibyte.
pub const GIB: f64 = (1u64 << 30) as f64;

/// Returns the memory available to this process, bytes: the smaller of the machine's memory and the limit of the control group. Returns `None` if the system
/// does not report it.
pub fn machine_memory() -> Option<u64> {
    let of_machine = kilobytes("/proc/meminfo", "MemTotal")?;
    let group = fs::read_to_string("/sys/fs/cgroup/memory.max").ok();
    let of_group = group.and_then(|text| text.trim().parse::<u64>().ok());
    Some(of_group.map_or(of_machine, |bytes| bytes.min(of_machine)))
}

/// Returns the peak memory of this process, bytes; `None` if the system does not report it.
pub fn peak_memory() -> Option<u64> {
    kilobytes("/proc/self/status", "VmHWM")
}

/// Returns the memory that this process uses now, bytes; `None` if the system does not report it.
pub(crate) fn memory_in_use() -> Option<u64> {
    kilobytes("/proc/self/status", "VmRSS")
}

/// Checks that a required memory (bytes) is at most the limit (`None` for no limit); the error states the limit.
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

/// Reads a line of the form `Key:  123 kB` from a file, and returns the value in bytes.
fn kilobytes(path: &str, key: &str) -> Option<u64> {
    let text = fs::read_to_string(path).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    let number = line.trim_start_matches(':').trim().strip_suffix("kB")?;
    Some(number.trim().parse::<u64>().ok()? * 1024)
}

/// Number of bytes that is displayed with a suitable unit, such as 12 MiB or 1.5 GiB.
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
