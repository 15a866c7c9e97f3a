//! The `bubbletouch` command.

mod command;

use std::process::ExitCode;

fn main() -> ExitCode {
    match command::dispatch() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}
