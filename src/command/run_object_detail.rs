//! `bubbletouch run` of a study of how detailed objects are.

use super::about_study::study_about;
use super::listener::Listener;
use super::output::{output_folder, packings_beside, terminal_width};
use super::study_args::StudyArgs;
use bubbletouch::Result;
use bubbletouch::files::write_bytes;
use bubbletouch::report::object_detail_results::{object_detail_summary, write_object_detail};
use bubbletouch::study::load_named_meshes;
use bubbletouch::study::object_detail::measure_detail;
use std::path::Path;
use std::time::Instant;

pub fn run_object_detail(args: &StudyArgs, listener: Listener, folder: &Path) -> Result<()> {
    let start = Instant::now();
    let plan = args.object_detail_plan()?;
    let objects = &plan.spec.objects;
    let meshes = load_named_meshes(plan.meshes(), objects)?;
    let n_objects = meshes.len();
    output_folder(folder)?;
    let progress = listener.progress();
    let packings = packings_beside(folder);
    let tables = measure_detail(&plan, meshes, Some(&packings), progress.as_ref())?;
    progress.stage("report", 1);
    let asked = (&plan.spec.question[..], &plan.spec.expected[..]);
    let about = study_about(args, asked, start)?;
    write_object_detail(folder, &tables, &about)?;
    write_bytes(&folder.join("study.toml"), plan.spec.to_toml().as_bytes())?;
    if !listener.wrote(folder, progress.as_ref(), start) {
        return Ok(());
    }
    println!("{}", plan.spec.question);
    println!("{n_objects} meshes, {} models of each\n", plan.n_models());
    println!("{}", object_detail_summary(&tables, terminal_width()));
    println!(
        "Results in {}; open {}",
        folder.display(),
        folder.join("report.html").display()
    );
    Ok(())
}
