//! Check of unused options: an option that has no effect is an error in all commands.
//!
//! The attribute `requires` of clap is not sufficient: clap does not check it if the required option conflicts with a given option.

use bubbletouch::{Error, Result};

/// Returns an error if an option is given but has no effect; `user` names the command or option that would use it.
pub fn check_used(option: &str, is_given: bool, can_act: bool, user: &str) -> Result<()> {
    if !is_given || can_act {
        return Ok(());
    }
    let allowed = format!("{user}, or the command without this option");
    Err(Error::input(option, "given, but not used here", allowed))
}
