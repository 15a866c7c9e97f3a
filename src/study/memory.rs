//! Bytes: what there are, what is asked for, and in words.

use super::plan::Plan;
use crate::error::{Error, Result};
use crate::recognition::svm::DEFAULT_MEMORY_BYTES;
use std::{fmt, fs};

/// Bytes of a gibibyte.
pub const GIB: f64 = (1u64 << 30) as f64;

/// Bytes of a touch: where it is, its label, how it is read.
const TOUCH_BYTES: f64 = 400.0;
/// Bytes of a touch in the split of a trial.
const SPLIT_BYTES: f64 = 8.0;

/// Most bytes of kernel values that a solver holds.
pub fn solver_memory(gib: Option<f64>) -> usize {
    gib.map_or(DEFAULT_MEMORY_BYTES, |gib| (gib * GIB) as usize)
}

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
pub(super) fn check_memory(
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

/// An error unless the touches of a study of so many classes, with a split a trial, are within `ceiling` bytes (`None`: no ceiling).
/// To be asked before any is drawn.
///
/// # Errors
/// They take more; the error names the key that says how many they are.
pub fn check_touches(plan: &Plan, n_classes: usize, ceiling: Option<u64>) -> Result<()> {
    let (key, n_each) = match &plan.spec.human_touch {
        Some(human) => ("human_touch.per_kind", human.per_kind as f64),
        None => ("touches.per_object", plan.placement.n_touches()),
    };
    let n_touches = n_each * n_classes as f64;
    let bytes = n_touches * (TOUCH_BYTES + SPLIT_BYTES * plan.spec.trials as f64);
    let what = format!("{n_touches} touches and their splits");
    check_memory(bytes, ceiling, &what)
        .map_err(|allowed| Error::input(format!("key {key}"), n_each, allowed))
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
