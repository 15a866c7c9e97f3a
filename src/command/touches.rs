//! `bubbletouch touches`: just the data set.

use super::output::{output_folder, packings_beside};
use super::study_args::StudyArgs;
use bubbletouch::random::Seed;
use bubbletouch::report::progress;
use bubbletouch::study::{load_objects, millimetres, write_touches};
use bubbletouch::{Error, Result};
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
    let plan = args.study.plan()?;
    if plan.human_touch.is_some() {
        let place = args.study.study.display();
        let allowed =
            "a study that presses objects (bubbletouch features writes what others learn from)";
        return Err(Error::input(place, "a study of human touches", allowed));
    }
    let objects = load_objects(&plan.spec.objects, Some(&packings_beside(&args.out)))?;
    let seed = Seed::new(plan.spec.seed);
    let progress = progress::to_stderr();
    let mut n_touches = 0;
    for patch in &plan.arrays {
        let grid = &patch.grid;
        let folder = match plan.arrays.len() {
            1 => args.out.clone(),
            _ => {
                let pitch_mm = millimetres(grid.pitch);
                args.out
                    .join(format!("{}x{}_at_{pitch_mm}_mm", grid.nx, grid.ny))
            }
        };
        output_folder(&folder)?;
        n_touches += write_touches(
            &folder,
            &objects,
            &plan.placement,
            &seed,
            patch,
            progress.as_ref(),
        )?;
    }
    progress.finish(&format!("{n_touches} touches in {}", args.out.display()));
    Ok(())
}
