//! `bubbletouch plan`: what a study would do, without doing it.

use super::memory_args::CeilingArgs;
use super::streams::say;
use super::study_args::StudyArgs;
use bubbletouch::Result;
use bubbletouch::study::Estimate;

#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    #[command(flatten)]
    ceiling: CeilingArgs,
}

pub fn plan(args: &Args) -> Result<()> {
    let loaded = args.study.load_within(None, args.ceiling.bytes()?)?;
    let memory = args.ceiling.plan(&loaded)?;
    let estimate = Estimate::new(
        &loaded.plan,
        loaded.touched.as_ref(),
        &loaded.sweep,
        &memory,
    );
    say(format_args!(
        "{}: {}",
        loaded.name, loaded.plan.spec.question
    ))?;
    say(estimate)?;
    if let Some(mixed) = args.study.mixed_touches()? {
        say(format_args!("note: {mixed}"))?;
    }
    Ok(())
}
