//! `bubbletouch plan`: what a study would do, without doing it.

use super::any_study::load_study;
use super::memory_args::CeilingArgs;
use super::run::results_folder;
use super::study_args::StudyArgs;
use bubbletouch::Result;

#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    #[command(flatten)]
    ceiling: CeilingArgs,
}

pub fn plan(args: &Args) -> Result<()> {
    let folder = results_folder(&args.study, None)?;
    let study = load_study(&args.study, &folder, None)?;
    let said = study.plan(&args.ceiling)?;
    println!("{}: {said}", args.study.name()?);
    Ok(())
}
