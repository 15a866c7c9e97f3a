//! The command of this program with one more kind of study. Run it from the root of the repository:
//!
//! `cargo run --release --example own_kind -- run examples/own_kind/saturation.toml`

mod saturation;

use bubbletouch::{Result, command, kinds};
use std::process::ExitCode;

fn main() -> Result<ExitCode> {
    kinds::register::<saturation::SaturationStudy>()?;
    Ok(command::run(std::env::args_os()).into())
}
