//! `bubbletouch calibrate`: estimates the signal chain of a skin from recorded frames.

use crate::command::options::recorded_args::{RecordedArgs, range};
use crate::command::terminal::{check_ending, note, write_out};
use bubbletouch::calibration::{NotIdentifiable, calibrate as estimated};
use bubbletouch::files::write_bytes;
use bubbletouch::study::{RecordedSkinFiles, UntouchedFrames};
use bubbletouch::{Error, Result};
use bubbletouch_sim::text::spelling::counted;
use std::ops::Range;
use std::path::PathBuf;

/// Estimate a sensor's noise and errors from recorded frames
///
/// The output is the [signal] table of a study. Each number has a 95 % interval. A comment states why a quantity is not identifiable. Noise,
/// smoothing and drift need frames of the untouched skin (--untouched or --untouched-frames).
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  bubbletouch calibrate frames.npy --untouched-frames 0..200,900..1000 --full-scale 4095"
)]
pub struct Args {
    /// Readings in order of time: .npy, .npz or .csv
    ///
    /// The shape is n × rows × columns or n × F × rows × columns.
    frames: PathBuf,
    #[command(flatten)]
    recorded: RecordedArgs,
    /// Read frames of the untouched skin, from the same session
    #[arg(
        long,
        value_name = "FILE.npy",
        conflicts_with = "untouched_frames",
        help_heading = "Input"
    )]
    untouched: Option<PathBuf>,
    /// Set the times of the frames of --untouched, such as 0..0.1,0.9..1
    ///
    /// The frames are at even intervals over these fractions of the session. 0..0 is before the first frame of FRAMES, 0..1 during the whole session.
    #[arg(long, value_name = "FROM..TO,...", value_delimiter = ',', value_parser = range::<f64>, requires = "untouched", help_heading = "Input")]
    untouched_times: Vec<Range<f64>>,
    /// Take these frames as untouched, such as 0..200,900..1000
    ///
    /// Frames are counted from 0. A range excludes its end.
    #[arg(long, value_name = "FROM..TO,...", value_delimiter = ',', value_parser = range::<usize>, help_heading = "Input")]
    untouched_frames: Vec<Range<usize>>,
    /// Read the force of each frame, newtons, to estimate stiffness
    #[arg(
        long,
        value_name = "FILE.npy",
        requires = "stroke_mm",
        help_heading = "Input"
    )]
    forces: Option<PathBuf>,
    /// Set the reading of an untouched taxel
    ///
    /// Default: the median of the untouched readings if nearly all have one sign, otherwise 0.
    #[arg(
        long,
        value_name = "READING",
        allow_negative_numbers = true,
        help_heading = "Sensor"
    )]
    zero: Option<f64>,
    /// Set the deflection at full scale
    #[arg(long, value_name = "MM", help_heading = "Sensor")]
    stroke_mm: Option<f64>,
    /// Set the distance between taxels
    #[arg(
        long,
        value_name = "MM",
        default_value_t = 1.0,
        help_heading = "Sensor"
    )]
    pitch_mm: f64,
    /// Write the table to this file instead of standard output
    #[arg(long, value_name = "FILE.toml", help_heading = "Output")]
    output: Option<PathBuf>,
}

pub fn calibrate(args: &Args) -> Result<()> {
    check_ending(args.output.as_deref(), "toml")?;
    let lengths = [
        ("--pitch-mm", Some(args.pitch_mm)),
        ("--stroke-mm", args.stroke_mm),
    ];
    for (option, length) in lengths {
        if let Some(length) = length.filter(|length| !(length.is_finite() && *length > 0.0)) {
            return Err(Error::input(option, length, "a positive number"));
        }
    }
    let files = RecordedSkinFiles {
        frames: args.frames.clone(),
        order: args.recorded.order.clone(),
        columns: args.recorded.columns.clone(),
        grid: args.recorded.grid,
        untouched: match &args.untouched {
            Some(path) if args.untouched_times.is_empty() => {
                let given = format!("{} without --untouched-times", path.display());
                let allowed = "--untouched-times FROM..TO, fractions of the session: 0..0 before the first frame, 0..1 at even intervals during all frames";
                return Err(Error::input("--untouched", given, allowed));
            }
            Some(path) => UntouchedFrames::File {
                path: path.clone(),
                times: args.untouched_times.clone(),
            },
            None if args.untouched_frames.is_empty() => UntouchedFrames::None,
            None => UntouchedFrames::Among(args.untouched_frames.clone()),
        },
        forces: args.forces.clone(),
        zero: args.zero,
        full_scale: args.recorded.full_scale,
        stroke_mm: args.stroke_mm,
    };
    let (skin, zero) = files.read()?;
    let mut found =
        estimated(&skin).map_err(|error| error.under(format!("{}: ", args.frames.display())))?;
    if args.recorded.full_scale.is_none()
        && found.converter.as_ref().is_ok_and(|bits| bits.value > 0.0)
    {
        let why = "the full scale of the converter is not given (--full-scale)";
        found.converter = Err(NotIdentifiable::from(why));
    }
    let (rows, columns) = skin.shape;
    let mut text = format!(
        "# {}: {} of {rows} × {columns} taxels, {} of the untouched skin. The zero is {zero}. Taxels are taken to be {} mm apart.\n",
        args.frames.display(),
        counted(skin.touched.nrows() + skin.untouched.nrows(), "frame"),
        skin.untouched.nrows(),
        args.pitch_mm
    );
    text += &found.signal_table(args.pitch_mm);
    if args.forces.is_some() {
        text += &format!("\n[skin]\n{}", found.stiffness_line());
    }
    match &args.output {
        None => write_out(text.as_bytes()),
        Some(path) => {
            write_bytes(path, text.as_bytes())?;
            note(format_args!(
                "The [signal] of this skin is in {}.",
                path.display()
            ));
            Ok(())
        }
    }
}
