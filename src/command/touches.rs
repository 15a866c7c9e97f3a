//! `bubbletouch touches`: just the data set.

use super::output::output_folder;
use super::study_args::StudyArgs;
use bubbletouch::Result;
use bubbletouch::report::progress;
use bubbletouch::study::{millimetres, write_touches};
use std::path::PathBuf;

#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// Where to write frames.npy, labels.npy, poses.npy, depths.npy, touches.csv and objects.csv; one folder an array
    /// if the study has several
    #[arg(long, value_name = "FOLDER")]
    out: PathBuf,
}

pub fn touches(args: &Args) -> Result<()> {
    let loaded = args.study.load()?;
    let arrays = &loaded.plan.arrays;
    let progress = progress::to_stderr();
    for patch in arrays {
        let grid = &patch.grid;
        let pitch_mm = millimetres(grid.pitch);
        let folder = match arrays.len() {
            1 => args.out.clone(),
            _ => args
                .out
                .join(format!("{}x{}_at_{pitch_mm}_mm", grid.nx, grid.ny)),
        };
        output_folder(&folder)?;
        let name = format!("touch {}×{} at {pitch_mm} mm", grid.nx, grid.ny);
        progress.stage(&name, loaded.sweep.labels.len() as u64);
        write_touches(&folder, &loaded.touched, patch, progress.as_ref())?;
    }
    progress.finish(&format!(
        "{} touches in {}",
        loaded.sweep.labels.len(),
        args.out.display()
    ));
    Ok(())
}
