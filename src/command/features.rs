//! `bubbletouch features`: writes the feature rows with which a configuration of a study is trained and tested.

use crate::command::options::study_args::StudyArgs;
use crate::command::terminal::output_folder;
use bubbletouch::Result;
use bubbletouch::files::DataFolder;
use bubbletouch::kinds::recognition::load_study;
use bubbletouch::report::progress;
use bubbletouch::study::FEATURE_FILES;
use std::path::PathBuf;

/// Write the features of one configuration as NumPy files
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  bubbletouch features experiments/cans.toml --configuration 3 --out features"
)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// Select the configuration by its number in the study's tables
    #[arg(
        long,
        value_name = "N",
        default_value_t = 0,
        help_heading = "Selection"
    )]
    configuration: usize,
    /// Select the trial, counted from 0
    #[arg(
        long,
        value_name = "T",
        default_value_t = 0,
        help_heading = "Selection"
    )]
    trial: usize,
    /// Write features, labels and split to this folder
    ///
    /// The files are features.npy, labels.npy, train.npy, test.npy, objects.csv and configuration.toml.
    #[arg(long, value_name = "FOLDER", help_heading = "Output")]
    out: PathBuf,
}

pub fn features(args: &Args) -> Result<()> {
    // Checked before objects are packed, and again below when the files that the study reads are known.
    DataFolder::claim(&args.out, "features", FEATURE_FILES)?;
    let loaded = load_study(&args.study.source(&args.out)?)?;
    let (part, which) = (
        loaded.part_of(args.configuration),
        (args.configuration, args.trial),
    );
    part.check_features(which)?;
    let progress = progress::to_stderr();
    let claimed = DataFolder::claim(&args.out, "features", FEATURE_FILES)?;
    output_folder(&args.out)?;
    let set = part.write_features((&args.out, &claimed), which, progress.as_ref())?;
    let (n_touches, n_measurements) = set.data.records.dim();
    progress.finish(&format!(
        "{n_touches} touches of {n_measurements} measurements, {} to train on and {} to test, in {}",
        set.split.train.len(),
        set.split.test.len(),
        args.out.display()
    ));
    Ok(())
}
