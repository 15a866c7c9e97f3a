//! `bubbletouch plan`: what a study would do, without doing it.

use super::any_study::load_study;
use super::memory_args::MemoryArgs;
use super::run::results_folder;
use super::streams::say;
use super::study_args::StudyArgs;
use bubbletouch::Result;

#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    #[command(flatten)]
    memory: MemoryArgs,
}

pub fn plan(args: &Args) -> Result<()> {
    let folder = results_folder(&args.study, None)?;
    let study = load_study(args.study.clone(), &folder, args.memory.bytes()?)?;
    let said = study.plan()?;
    say(format_args!("{}: {said}", args.study.name()?))?;
    if let Some(mixed) = args.study.mixed_touches()? {
        say(format_args!("note: {mixed}"))?;
    }
    Ok(())
}
