//! Memory limit of a study.

use bubbletouch::study::memory::{GIB, machine_memory};
use bubbletouch::{Error, Result};

#[derive(clap::Args)]
pub struct MemoryLimit {
    /// Limit the memory, GiB [default: the machine's memory]
    ///
    /// Below a small limit, fewer work items run at the same time. If a single one does not fit, the study is refused.
    #[arg(long, value_name = "GIB", help_heading = "Run")]
    memory_gib: Option<f64>,
}

impl MemoryLimit {
    /// Returns the memory limit in bytes: the value of `--memory-gib`, or the machine's memory if the option is not given.
    pub fn bytes(&self) -> Result<Option<u64>> {
        match self.memory_gib {
            None => Ok(machine_memory()),
            Some(gib) if gib.is_finite() && gib > 0.0 => Ok(Some((gib * GIB) as u64)),
            Some(gib) => {
                let allowed = "a positive number of gibibytes";
                Err(Error::input("--memory-gib", gib, allowed))
            }
        }
    }
}
