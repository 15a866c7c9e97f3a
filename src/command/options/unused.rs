//! Check of unused options: an option that has no effect is an error in all commands.
//!
//! clap's `requires` is not enough: it is not checked for an option whose required one conflicts with another that is given.

use bubbletouch::{Error, Result};

/// Returns an error if an option is given but has no effect; `user` names the command or option that would use it.
pub fn check_used(option: &str, is_given: bool, can_act: bool, user: &str) -> Result<()> {
    if !is_given || can_act {
        return Ok(());
    }
    let allowed = format!("{user}, or the command without this option");
    Err(Error::input(option, "given, but not used here", allowed))
}
