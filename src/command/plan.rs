//! `bubbletouch plan`: what a study would do, without doing it.

use super::memory_limit::MemoryLimit;
use super::streams::say;
use super::study_args::StudyArgs;
use bubbletouch::Result;

#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    #[command(flatten)]
    memory: MemoryLimit,
}

pub fn plan(Args { study, memory }: &Args) -> Result<()> {
    let loaded = study.load(&study.default_results()?, memory.bytes()?)?;
    say(format_args!("{}: {}", study.name()?, loaded.plan()?))?;
    study.mixed_touches()?.map_or(Ok(()), say)
}
