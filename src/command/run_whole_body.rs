//! `bubbletouch run` of a study of a whole body of skin.

use super::about_study::study_about;
use super::listener::Listener;
use super::output::{output_folder, terminal_width};
use super::study_args::StudyArgs;
use bubbletouch::Result;
use bubbletouch::files::write_bytes;
use bubbletouch::report::whole_body_results::{whole_body_summary, write_whole_body};
use bubbletouch::study::whole_body::measure_body;
use std::path::Path;
use std::time::Instant;

pub fn run_whole_body(args: &StudyArgs, listener: Listener, folder: &Path) -> Result<()> {
    let start = Instant::now();
    let plan = args.whole_body_plan()?;
    output_folder(folder)?;
    let progress = listener.progress();
    let outcome = measure_body(&plan, progress.as_ref())?;
    progress.stage("report", 1);
    let asked = (&plan.spec.question[..], &plan.spec.expected[..]);
    let about = study_about(args, asked, start)?;
    write_whole_body(folder, &outcome, &about)?;
    write_bytes(&folder.join("study.toml"), plan.spec.to_toml().as_bytes())?;
    if !listener.wrote(folder, progress.as_ref(), start) {
        return Ok(());
    }
    println!("{}\n", plan.spec.question);
    println!("{}", whole_body_summary(&outcome.tables, terminal_width()));
    println!(
        "Results in {}; open {}",
        folder.display(),
        folder.join("report.html").display()
    );
    Ok(())
}
