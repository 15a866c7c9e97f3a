//! `bubbletouch run` of a study that reconstructs frames.

use super::about_study::study_about;
use super::listener::Listener;
use super::output::{output_folder, packings_beside, terminal_width};
use super::study_args::StudyArgs;
use bubbletouch::Result;
use bubbletouch::files::write_bytes;
use bubbletouch::random::Seed;
use bubbletouch::report::reconstruction_frames::draw_samples;
use bubbletouch::report::reconstruction_results::write_reconstruction;
use bubbletouch::report::reconstruction_text::reconstruction_summary;
use bubbletouch::study::reconstruction::reconstruct;
use bubbletouch::study::{draw_touches, load_objects, millimetres};
use std::path::Path;
use std::time::Instant;

pub fn run_reconstruction(args: &StudyArgs, listener: Listener, folder: &Path) -> Result<()> {
    let start = Instant::now();
    let plan = args.reconstruction_plan()?;
    let objects = load_objects(&plan.spec.objects, Some(&packings_beside(folder)))?;
    let touched = draw_touches(objects, &plan.placement, &Seed::new(plan.spec.seed))?;
    output_folder(folder)?;
    let progress = listener.progress();
    let outcome = reconstruct(&plan, &touched, progress.as_ref())?;
    progress.stage("report", 1);
    let grid = plan.patch.grid;
    let pitch_mm = millimetres(grid.pitch);
    let shape = (grid.ny, grid.nx);
    let frames = draw_samples(
        &outcome.tables,
        &outcome.samples,
        shape,
        pitch_mm,
        plan.quantity(),
    )?;
    let asked = (&plan.spec.question[..], &plan.spec.expected[..]);
    let about = study_about(args, asked, start)?;
    write_reconstruction(folder, &outcome.tables, &frames, &about)?;
    write_bytes(&folder.join("study.toml"), plan.spec.to_toml().as_bytes())?;
    if !listener.wrote(folder, progress.as_ref(), start) {
        return Ok(());
    }
    println!("{}", plan.spec.question);
    println!(
        "{} objects; dictionaries learned from {} clean training touches, tested on {} others\n",
        touched.len(),
        outcome.n_train,
        outcome
            .tables
            .reconstruction
            .first()
            .map_or(0, |row| row.1.n_frames)
    );
    println!(
        "{}",
        reconstruction_summary(&outcome.tables, terminal_width())
    );
    println!(
        "Results in {}; open {}",
        folder.display(),
        folder.join("report.html").display()
    );
    Ok(())
}
