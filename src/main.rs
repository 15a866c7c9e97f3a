//! The `bubbletouch` command.

// The standard print macros panic if a pipe is closed; the command's own streams do not.
#![cfg_attr(not(test), deny(clippy::print_stdout, clippy::print_stderr))]

mod command;

use std::process::ExitCode;

#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
#[global_allocator]
static MEMORY: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    match command::dispatch() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            command::terminal::streams::note(format_args!("error: {error}"));
            ExitCode::from(error.exit_code())
        }
    }
}
