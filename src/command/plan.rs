//! `bubbletouch plan`: what a study would do, without doing it.

use super::study_args::StudyArgs;
use bubbletouch::Result;
use bubbletouch::study::Estimate;

#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
}

pub fn plan(args: &Args) -> Result<()> {
    let loaded = args.study.load(None)?;
    let estimate = Estimate::new(&loaded.plan, loaded.touched.as_ref(), &loaded.sweep);
    println!("{}: {}", loaded.name, loaded.plan.spec.question);
    println!("{estimate}");
    Ok(())
}
