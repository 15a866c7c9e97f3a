//! `bubbletouch run` of a study of where contact methods break.

use super::about_study::study_about;
use super::listener::Listener;
use super::output::{output_folder, terminal_width};
use super::study_args::StudyArgs;
use bubbletouch::files::write_bytes;
use bubbletouch::report::stability_results::{stability_summary, write_stability};
use bubbletouch::study::stability::measure_stability;
use bubbletouch::{Error, Result};
use std::path::Path;
use std::time::Instant;

pub fn run_stability(args: &StudyArgs, listener: Listener, folder: &Path) -> Result<()> {
    let start = Instant::now();
    if args.objects.is_some() || args.seed.is_some() {
        let allowed = "neither: nothing is drawn at random, and a ball is what touches";
        return Err(Error::input("--objects, --seed", "given", allowed));
    }
    let plan = args.stability_plan()?;
    output_folder(folder)?;
    let progress = listener.progress();
    let tables = measure_stability(&plan, progress.as_ref())?;
    progress.stage("report", 1);
    let asked = (&plan.spec.question[..], &plan.spec.expected[..]);
    let about = study_about(args, asked, start)?;
    write_stability(folder, &tables, &about)?;
    write_bytes(&folder.join("study.toml"), plan.spec.to_toml().as_bytes())?;
    if !listener.wrote(folder, progress.as_ref(), start) {
        return Ok(());
    }
    println!("{}\n", plan.spec.question);
    println!("{}", stability_summary(&tables, terminal_width()));
    if !cfg!(feature = "rapier") {
        println!("Without rapier's rows: this command was built without --features rapier");
    }
    println!(
        "Results in {}; open {}",
        folder.display(),
        folder.join("report.html").display()
    );
    Ok(())
}
