//! `bubbletouch touches`: just the data set.

use super::output::output_folder;
use super::study_args::StudyArgs;
use bubbletouch::kinds::recognition::{load_study, read_plan};
use bubbletouch::random::Seed;
use bubbletouch::report::progress;
use bubbletouch::study::{Plan, ReadFrames, load_objects, millimetres, write_touches};
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
    let objects = load_objects(&plan.spec.objects, source.packings.as_deref())?;
    let drawn = (&plan.placement, &Seed::new(plan.spec.seed));
    let mut n_touches = 0;
    let arrays: Vec<_> = match &read {
        None => plan.arrays.iter().collect(),
        Some(read) => vec![&plan.arrays[read.array]],
    };
    for &array in &arrays {
        let folder = match arrays.len() {
            1 => args.out.clone(),
            _ => {
                let ((ny, nx), pitch_mm) = (array.shape(), millimetres(array.pitch()));
                args.out.join(format!("{nx}x{ny}_at_{pitch_mm}_mm"))
            }
        };
        output_folder(&folder)?;
        n_touches += write_touches(
            &folder,
            &objects,
            drawn,
            array,
            read.as_ref(),
            progress.as_ref(),
        )?;
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
    /// An error for human touches, which no object makes.
    fn check(&self, plan: &Plan) -> Result<()> {
        if plan.spec.places_objects() {
            return Ok(());
        }
        let place = self.study.study.display();
        let allowed =
            "a study that presses objects (bubbletouch features writes what others learn from)";
        let given = "a study of human touches or of recorded frames";
        Err(Error::input(place, given, allowed))
    }
}
