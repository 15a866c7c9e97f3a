//! `bubbletouch recording`: shows a recording as a table, a picture or an animation.

use super::classify::word;
use crate::command::options::unused::check_used;
use crate::command::terminal::{check_ending, note, terminal_width, write_out};
use bubbletouch::files::write_bytes;
use bubbletouch::objects::Model;
use bubbletouch::report::pressure_map::pressure_text;
use bubbletouch::report::recording::animation::{
    Playback, colour_scale, frame_note, write_animation,
};
use bubbletouch::report::recording::skin_picture::SkinPicture;
use bubbletouch::report::recording::{RecordingFile, recording_table};
use bubbletouch::report::terminal::Ink;
use bubbletouch::scene::ScenePlan;
use bubbletouch::signal::Quantity;
use bubbletouch::{Error, Result};
use bubbletouch_sim::text::spelling::counted;
use ndarray::Array2;
use std::path::{Path, PathBuf};

/// Describe a recording of a scene, or draw it
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  bubbletouch recording results/ball/recording.npz --patch forearm --animate ball.png"
)]
pub struct Args {
    /// Recording that bubbletouch simulate wrote
    file: PathBuf,
    /// Select the patch to draw, if there are several
    #[arg(long, value_name = "NAME", help_heading = "Selection")]
    patch: Option<String>,
    /// Draw deflection or force [default: deflection]
    #[arg(long, value_name = "WHAT", value_parser = word::<Quantity>, help_heading = "Selection")]
    quantity: Option<Quantity>,
    /// Draw frame K, counted from 0
    ///
    /// The picture is written to --out, or drawn here if the patch is a grid.
    #[arg(
        long,
        value_name = "K",
        conflicts_with = "animate",
        help_heading = "Selection"
    )]
    frame: Option<usize>,
    /// Write the picture of --frame to this file
    #[arg(long, value_name = "FILE.png", help_heading = "Output")]
    out: Option<PathBuf>,
    /// Write an animated PNG, for browsers
    ///
    /// The animation has at most 600 frames of the recording, evenly in time. Beside the skin, it shows all patches and the objects of scene.toml; a strip shows
    /// the total force.
    #[arg(long, value_name = "FILE.png", help_heading = "Output")]
    animate: Option<PathBuf>,
    /// Limit the pictures per second of the animation (at most 50) [default: 25]
    #[arg(long, value_name = "N", help_heading = "Output")]
    fps: Option<f64>,
    /// Play the recording at X times its speed [default: 1]
    #[arg(long, value_name = "X", help_heading = "Output")]
    speed: Option<f64>,
}

pub fn recording(args: &Args) -> Result<()> {
    check_ending(args.out.as_deref(), "png")?;
    check_ending(args.animate.as_deref(), "png")?;
    args.check_used()?;
    let mut file = RecordingFile::open(&args.file)?;
    match (args.frame, &args.animate) {
        (Some(frame), _) => draw_frame(args, &mut file, frame),
        (None, Some(path)) => animate(args, &mut file, path),
        (None, None) => {
            let table = recording_table(&mut file)?;
            write_out(table.as_bytes())
        }
    }
}

impl Args {
    fn quantity(&self) -> Quantity {
        self.quantity.unwrap_or(Quantity::Deflection)
    }

    /// Returns an error if options are given that have no effect.
    fn check_used(&self) -> Result<()> {
        let is_animated = self.animate.is_some();
        let draws = is_animated || self.frame.is_some();
        check_used("--fps", self.fps.is_some(), is_animated, "--animate")?;
        check_used("--speed", self.speed.is_some(), is_animated, "--animate")?;
        check_used("--out", self.out.is_some(), self.frame.is_some(), "--frame")?;
        let user = "--frame or --animate";
        check_used("--quantity", self.quantity.is_some(), draws, user)?;
        check_used("--patch", self.patch.is_some(), draws, user)
    }
}

/// Returns the number of the patch that is drawn.
fn chosen_patch(args: &Args, file: &RecordingFile) -> Result<usize> {
    let patches = &file.header().patches;
    let named = |name: &String| patches.iter().position(|patch| patch.name == *name);
    let (found, given) = match &args.patch {
        Some(name) => (named(name), format!("no patch {name}")),
        None if patches.len() == 1 => return Ok(0),
        None => (None, format!("{} patches", patches.len())),
    };
    found.ok_or_else(|| {
        let names: Vec<&str> = patches.iter().map(|patch| &patch.name[..]).collect();
        let allowed = format!("--patch NAME, one of {}", names.join(", "));
        Error::input(args.file.display(), given, allowed)
    })
}

fn draw_frame(args: &Args, file: &mut RecordingFile, frame: usize) -> Result<()> {
    let number = chosen_patch(args, file)?;
    let values = file.frame(number, args.quantity(), frame)?;
    let scale = colour_scale(file, number, args.quantity())?;
    let patch = &file.header().patches[number];
    let said = frame_note(file.time(), frame);
    match (&args.out, patch.grid) {
        (Some(path), _) => {
            let skin = SkinPicture::new(patch, scale)?;
            write_bytes(path, &skin.frame(&values, &said)?.png()?)?;
        }
        (None, Some(grid)) => {
            let frame = Array2::from_shape_vec((grid.ny, grid.nx), values)
                .expect("a grid has one value a taxel");
            let (pitch_mm, ink) = (grid.pitch * 1e3, Ink::of_stdout());
            let text = pressure_text(&frame, pitch_mm, args.quantity(), ink, terminal_width())?;
            write_out(text.as_bytes())?;
        }
        (None, None) => {
            let name = &patch.name;
            let given = format!("patch {name} is not a grid; the terminal shows grids only");
            return Err(Error::input(
                "--frame",
                given,
                "--frame with --out FILE.png",
            ));
        }
    }
    note(format_args!("{}: {said}", patch.name));
    Ok(())
}

fn animate(args: &Args, file: &mut RecordingFile, path: &Path) -> Result<()> {
    let patch = chosen_patch(args, file)?;
    let usual = Playback::default();
    let playback = Playback {
        speed: args.speed.unwrap_or(usual.speed),
        fps: args.fps.unwrap_or(usual.fps),
    };
    // The scene that bubbletouch simulate wrote beside the recording has the shapes of the objects.
    let scene = args.file.with_file_name("scene.toml");
    let models: Vec<(String, Model)> = match scene.exists() {
        true => {
            let plan = ScenePlan::read(&scene)?;
            let names = plan.objects.into_iter().map(|object| object.name);
            names.zip(plan.models).collect()
        }
        false => Vec::new(),
    };
    let shown = write_animation(path, file, patch, (args.quantity(), &models), &playback)?;
    let milliseconds: u64 = shown.iter().map(|frame| frame.milliseconds).sum();
    note(format_args!(
        "{} of {} in {:.1} s, at {} × the speed of the recording",
        shown.len(),
        counted(file.time().len(), "frame"),
        milliseconds as f64 * 1e-3,
        playback.speed
    ));
    Ok(())
}
