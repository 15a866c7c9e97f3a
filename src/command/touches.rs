//! `bubbletouch touches`: just the data set.

use super::output::output_folder;
use super::study_args::StudyArgs;
use bubbletouch::kinds::recognition::{load_study, read_plan};
use bubbletouch::report::progress;
use bubbletouch::study::{
    Plan, ReadFrames, load_objects, millimetres, write_human_touches, write_touches,
};
use bubbletouch::{Error, Result};
use std::path::PathBuf;

#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// Where to write frames.npy, labels.npy, poses.npy, depths.npy, touches.csv, objects.csv and recorded.toml; one folder an array
    /// and number of frames if the study has several
    #[arg(long, value_name = "FOLDER")]
    out: PathBuf,
    /// Frames as this cell of the study reads them (its number in the study's tables), with noise and whatever else its signal has;
    /// on its array alone, the deepest frame of each touch
    #[arg(long, value_name = "N")]
    cell: Option<usize>,
    /// The trial that they are read in, from 0
    #[arg(long, value_name = "T", default_value_t = 0, requires = "cell")]
    trial: usize,
}

pub fn touches(args: &Args) -> Result<()> {
    let source = args.study.source(&args.out)?;
    let progress = progress::to_stderr();
    let (plan, read) = match args.cell {
        None => (read_plan(&source)?, None),
        Some(cell) => {
            let study = load_study(&source)?;
            let part = study.part_of(cell);
            args.check(&part.plan)?;
            let which = (cell, args.trial);
            let read = ReadFrames::of_cell(part, which, progress.as_ref())?;
            (part.plan.clone(), Some(read))
        }
    };
    args.check(&plan)?;
    let objects = match &plan.spec.human_touch {
        Some(_) => Vec::new(),
        None => load_objects(&plan.spec.objects, source.packings.as_deref())?,
    };
    let mut n_touches = 0;
    let arrays: Vec<_> = match &read {
        None => plan.arrays.iter().collect(),
        Some(read) => vec![&plan.arrays[read.array]],
    };
    let counts = match &read {
        None => plan.frames.clone(),
        Some(_) => vec![1],
    };
    let sets = arrays.iter();
    let sets = sets.flat_map(|&array| counts.iter().map(move |&n_frames| (array, n_frames)));
    for (array, n_frames) in sets {
        let ((ny, nx), pitch_mm) = (array.shape(), millimetres(array.pitch()));
        let of_array = format!("{nx}x{ny}_at_{pitch_mm}_mm");
        let of_frames = format!("{n_frames}_frames");
        let folder = match (arrays.len(), counts.len()) {
            (1, 1) => args.out.clone(),
            (_, 1) => args.out.join(of_array),
            (1, _) => args.out.join(of_frames),
            _ => args.out.join(format!("{of_array}_{of_frames}")),
        };
        output_folder(&folder)?;
        let progress = progress.as_ref();
        n_touches += match &plan.spec.human_touch {
            Some(human) => write_human_touches(&folder, human, &plan, array, progress)?,
            None => {
                let on = (array, n_frames);
                write_touches(&folder, &objects, &plan, on, read.as_ref(), progress)?
            }
        };
    }
    let how = match args.cell {
        None => "without noise (--cell N writes them as cell N of the study reads them)".to_owned(),
        Some(cell) => format!("as cell {cell} reads them in trial {}", args.trial),
    };
    progress.finish(&format!(
        "{n_touches} touches, {how}, in {}",
        args.out.display()
    ));
    Ok(())
}

impl Args {
    /// An error for recorded frames, which are files already, and for frames of human touches as a cell reads them.
    fn check(&self, plan: &Plan) -> Result<()> {
        let is_human = plan.spec.human_touch.is_some() && self.cell.is_none();
        if plan.spec.places_objects() || is_human {
            return Ok(());
        }
        let place = self.study.study.display();
        let (given, allowed) = match plan.spec.recorded {
            Some(_) => (
                "a study of recorded frames",
                "a study that presses objects or simulates human touches (bubbletouch features writes what others learn from)",
            ),
            None => (
                "--cell in a study of human touches",
                "a study that presses objects (bubbletouch features writes what others learn from)",
            ),
        };
        Err(Error::input(place, given, allowed))
    }
}
