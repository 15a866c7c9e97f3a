//! `bubbletouch run` of a study of where recognition breaks.

use super::about_study::study_about;
use super::listener::Listener;
use super::output::{output_folder, packings_beside, terminal_width};
use super::study_args::StudyArgs;
use bubbletouch::Result;
use bubbletouch::files::write_bytes;
use bubbletouch::report::breaking_points_results::{
    breaking_points_summary, write_breaking_points,
};
use bubbletouch::study::breaking_points::find_breaking_points;
use std::path::Path;
use std::time::Instant;

pub fn run_breaking_points(args: &StudyArgs, listener: Listener, folder: &Path) -> Result<()> {
    let start = Instant::now();
    let plan = args.breaking_points_plan()?;
    output_folder(folder)?;
    let progress = listener.progress();
    let packings = packings_beside(folder);
    let tables = find_breaking_points(&plan, Some(&packings), progress.as_ref())?;
    progress.stage("report", 1);
    let asked = (&plan.spec.question[..], &plan.spec.expected[..]);
    let about = study_about(args, asked, start)?;
    write_breaking_points(folder, &plan.ways, &tables, &about)?;
    write_bytes(&folder.join("study.toml"), plan.spec.to_toml().as_bytes())?;
    if !listener.wrote(folder, progress.as_ref(), start) {
        return Ok(());
    }
    println!("{}\n", plan.spec.question);
    println!("{}", breaking_points_summary(&tables, terminal_width()));
    println!(
        "Results in {}; open {}",
        folder.display(),
        folder.join("report.html").display()
    );
    Ok(())
}
