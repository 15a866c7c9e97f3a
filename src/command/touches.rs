//! `bubbletouch touches`: writes the touches of a study as a data set.

use crate::command::options::study_args::StudyArgs;
use crate::command::terminal::output_folder;
use bubbletouch::files::DataFolder;
use bubbletouch::inputs::content_hash::identity;
use bubbletouch::kinds::recognition::{load_study, read_plans, touch_content};
use bubbletouch::report::progress;
use bubbletouch::study::axes::AxisValues;
use bubbletouch::study::{
    Plan, ReadFrames, TOUCH_FILES, load_objects, millimetres, touch_units, write_human_touches,
    write_touches,
};
use bubbletouch::world::ImageShape;
use bubbletouch::{Error, Result};
use std::collections::HashSet;
use std::path::PathBuf;

/// Write the touches of a study as NumPy files
///
/// Frames are deflections of the press, without noise, smoothing and sensor errors. With --configuration, they are the readings of that
/// configuration.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  bubbletouch touches experiments/cans.toml --out touches")]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// Write frames, labels, poses and a manifest to this folder
    ///
    /// The files are frames.npy, shear.npy (of skins that read shear), labels.npy, poses.npy, depths.npy, touches.csv, objects.csv, recorded.toml and
    /// manifest.json (quantities and units). A study with several arrays, or with axes that change touches, has a folder for each.
    #[arg(long, value_name = "FOLDER", help_heading = "Output")]
    out: PathBuf,
    /// Write frames as configuration N reads them, with noise
    ///
    /// N is the number in the tables of the study. The frames are of its array, at the deepest position of each touch.
    #[arg(long, value_name = "N", help_heading = "Selection")]
    configuration: Option<usize>,
    /// Read the frames in trial T, counted from 0
    #[arg(
        long,
        value_name = "T",
        default_value_t = 0,
        requires = "configuration",
        help_heading = "Selection"
    )]
    trial: usize,
}

/// Touches on one array for one combination of axis values.
struct DataSet<'a> {
    plan: &'a Plan,
    n_frames: usize,
    axes: &'a AxisValues,
    /// Whether only test touches are simulated in this way.
    is_tested: bool,
    /// Folder below the output folder; empty if there is one data set.
    folder: String,
}

pub fn touches(args: &Args) -> Result<()> {
    let source = args.study.source(&args.out)?;
    let progress = progress::to_stderr();
    let (plans, read) = match args.configuration {
        None => (read_plans(&source)?, None),
        Some(configuration) => {
            // Checked before objects are packed, and again below when all files are known.
            DataFolder::claim(&args.out, "touches", TOUCH_FILES)?;
            let study = load_study(&source)?;
            let part = study.part_of(configuration);
            args.check(&part.plan)?;
            let which = (configuration, args.trial);
            let read = ReadFrames::of_cell(part, which, progress.as_ref())?;
            (vec![(AxisValues::default(), part.plan.clone())], Some(read))
        }
    };
    plans.iter().try_for_each(|(_, plan)| args.check(plan))?;
    let sets = data_sets(&plans, read.as_ref());
    let below = |set: &DataSet, name: &str| match set.folder.is_empty() {
        true => name.to_owned(),
        false => format!("{}/{name}", set.folder),
    };
    let files = sets
        .iter()
        .flat_map(|set| TOUCH_FILES.map(|name| below(set, name)));
    let files: Vec<String> = files.collect();
    let mut claimed = DataFolder::claim(&args.out, "touches", files.iter().map(String::as_str))?;
    let is_force = read.as_ref().map(|read| read.is_force);
    for set in &sets {
        for (name, units) in touch_units(&set.plan.array, is_force) {
            claimed.describe(&below(set, name), units);
        }
    }
    output_folder(&args.out)?;
    claimed.write_manifest()?;
    let mut n_touches = 0;
    for set in &sets {
        let folder = args.out.join(&set.folder);
        output_folder(&folder)?;
        let (plan, array, progress) = (set.plan, &set.plan.array, progress.as_ref());
        n_touches += match &plan.spec.human_touch {
            Some(human) => write_human_touches(&folder, human, plan, array, progress)?,
            None => {
                let objects = load_objects(&plan.spec.objects, source.packings.as_deref())?;
                let on = (array, set.n_frames);
                write_touches(&folder, &objects, plan, on, read.as_ref(), progress)?
            }
        };
    }
    let how = match args.configuration {
        None => "without noise (--configuration N writes them as configuration N of the study reads them)".to_owned(),
        Some(configuration) => format!("as configuration {configuration} reads them in trial {}", args.trial),
    };
    progress.finish(&format!(
        "{n_touches} touches, {how}, in {}",
        args.out.display()
    ));
    Ok(())
}

/// Returns the distinct sets of touches on each array; their folder names state the settings that differ.
fn data_sets<'a>(plans: &'a [(AxisValues, Plan)], read: Option<&ReadFrames>) -> Vec<DataSet<'a>> {
    let mut sets = Vec::new();
    let mut known = HashSet::new();
    let own = |(axes, plan): &'a (AxisValues, Plan)| {
        let tested = plan.tested.as_deref().filter(|_| read.is_none());
        let tested = tested.map(|tested| (axes, tested, true));
        std::iter::once((axes, plan, false)).chain(tested)
    };
    for (axes, plan, is_tested) in plans.iter().flat_map(own) {
        let counts = match read {
            None => plan.frames.clone(),
            Some(_) => vec![1],
        };
        for n_frames in counts {
            if known.insert((touch_content(plan), identity(&plan.array), n_frames)) {
                sets.push(DataSet {
                    plan,
                    n_frames,
                    axes,
                    is_tested,
                    folder: String::new(),
                });
            }
        }
    }
    let parts: Vec<Vec<String>> = sets.iter().map(folder_parts).collect();
    let Some(first) = parts.first().filter(|_| parts.len() > 1) else {
        return sets;
    };
    let differs: Vec<bool> = (0..first.len())
        .map(|part| parts.iter().any(|other| other[part] != first[part]))
        .collect();
    for (set, parts) in sets.iter_mut().zip(&parts) {
        let named = parts.iter().zip(&differs).filter(|(_, differs)| **differs);
        let named: Vec<&str> = named.map(|(part, _)| part.as_str()).collect();
        set.folder = named.join("_");
    }
    number_equal_names(&mut sets);
    sets
}

/// Returns the parts of a folder name: the array, followed by each axis with its value.
fn folder_parts(set: &DataSet) -> Vec<String> {
    let (ImageShape { ny, nx }, pitch_mm) =
        (set.plan.array.shape(), millimetres(set.plan.array.pitch()));
    let array = format!("{nx}x{ny}_at_{pitch_mm}_mm");
    let axes = set.axes.values.iter().map(|axis| {
        let value = match &axis.value {
            None => "none".to_owned(),
            Some(toml::Value::Float(number)) => number.to_string(),
            Some(toml::Value::String(text)) => text.clone(),
            Some(value) => value.to_string(),
        };
        let plain = |c: char| {
            if c.is_alphanumeric() || "._-".contains(c) {
                c
            } else {
                '_'
            }
        };
        let name = format!("{}_{value}", axis.column.name);
        name.chars().map(plain).collect()
    });
    let frames = format!("{}_frames", set.n_frames);
    let side = if set.is_tested { "test" } else { "training" };
    [array, frames, side.to_owned()]
        .into_iter()
        .chain(axes)
        .collect()
}

/// Appends a number to folder names that several sets of touches share.
fn number_equal_names(sets: &mut [DataSet]) {
    let names: Vec<String> = sets.iter().map(|set| set.folder.clone()).collect();
    for (place, set) in sets.iter_mut().enumerate() {
        let n_before = names[..place]
            .iter()
            .filter(|name| **name == names[place])
            .count();
        if names.iter().filter(|name| **name == names[place]).count() > 1 {
            set.folder = format!("{}_{}", names[place], n_before + 1)
                .trim_start_matches('_')
                .to_owned();
        }
    }
}

impl Args {
    /// Returns an error for recorded frames, which are files already, and for human touches after the signal chain.
    fn check(&self, plan: &Plan) -> Result<()> {
        let is_human = plan.spec.human_touch.is_some() && self.configuration.is_none();
        if plan.spec.places_objects() || is_human {
            return Ok(());
        }
        let place = self.study.study.display();
        let (given, allowed) = match plan.spec.recorded {
            Some(_) => (
                "a study of recorded frames",
                "a study that presses objects or simulates human touches (bubbletouch features writes features for other programs)",
            ),
            None => (
                "--configuration in a study of human touches",
                "a study that presses objects (bubbletouch features writes features for other programs)",
            ),
        };
        Err(Error::input(place, given, allowed))
    }
}
