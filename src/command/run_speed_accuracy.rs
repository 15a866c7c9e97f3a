//! `bubbletouch run` of a study of what accuracy costs.

use super::about_study::study_about;
use super::listener::Listener;
use super::output::{output_folder, packings_beside, terminal_width};
use super::study_args::StudyArgs;
use bubbletouch::Result;
use bubbletouch::files::write_bytes;
use bubbletouch::report::speed_accuracy::{speed_accuracy_summary, write_speed_accuracy};
use bubbletouch::study::speed_accuracy::measure_speed_accuracy;
use std::path::Path;
use std::time::Instant;

pub fn run_speed_accuracy(args: &StudyArgs, listener: Listener, folder: &Path) -> Result<()> {
    let start = Instant::now();
    let plan = args.speed_accuracy_plan()?;
    output_folder(folder)?;
    let progress = listener.progress();
    let packings = packings_beside(folder);
    let tables = measure_speed_accuracy(&plan, Some(&packings), progress.as_ref())?;
    progress.stage("report", 1);
    let asked = (&plan.spec.question[..], &plan.spec.expected[..]);
    let about = study_about(args, asked, start)?;
    write_speed_accuracy(folder, &tables, &about)?;
    write_bytes(&folder.join("study.toml"), plan.spec.to_toml().as_bytes())?;
    if !listener.wrote(folder, progress.as_ref(), start) {
        return Ok(());
    }
    println!("{}\n", plan.spec.question);
    println!("{}", speed_accuracy_summary(&tables, terminal_width()));
    if let Some(contact) = &plan.contact {
        if let Some(path) = contact.peers.as_ref().filter(|path| !path.exists()) {
            println!("Without other programs: there is no {}", path.display());
        }
        if let Some(scans) = contact.spec.scans.as_ref().filter(|s| !s.meshes.is_dir()) {
            let folder = scans.meshes.display();
            println!("Without scans: there is no folder {folder}; --objects names one");
        }
    }
    println!(
        "Results in {}; open {}",
        folder.display(),
        folder.join("report.html").display()
    );
    Ok(())
}
