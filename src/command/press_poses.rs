//! `bubbletouch press --poses`: presses one object in many poses and measures the time of each reading.

use crate::command::options::unused::check_used;
use crate::command::terminal::output::check_ending;
use crate::command::terminal::streams::say;
use bubbletouch::contact::{self, Contact, Goal, Workspace};
use bubbletouch::files::table_error;
use bubbletouch::geometry::Pose;
use bubbletouch::objects::Model;
use bubbletouch::quantile::quantile;
use bubbletouch::study::write_npy;
use bubbletouch::world::Patch;
use bubbletouch::{Error, Result};
use glam::{DQuat, DVec3};
use ndarray::{Array3, ArrayView2};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Maximum number of stored times per pose, from which the median is computed.
const MAX_REPEATS: usize = 1_000_000;

#[derive(clap::Args)]
#[group(id = "Poses", multiple = true)]
pub struct Args {
    /// Press the object at every pose of a CSV file
    ///
    /// Columns x, y, z in metres and qw, qx, qy, qz: the object in the patch frame (taxels rest in the plane z = 0, axes along +z). With --depth-mm,
    /// each pose is moved to that depth past first contact; otherwise it is used as given. With --out FILE.npy, the array has n × ny × nx deflections
    /// in metres.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["Place", "force_n"], help_heading = "Press")]
    pub poses: Option<PathBuf>,
    /// Press each pose N times for timing [default: 1]
    #[arg(long, value_name = "N", help_heading = "Press")]
    repeat: Option<usize>,
    /// Print travel, taxels and time of each pose as JSON
    #[arg(long, help_heading = "Output")]
    json: bool,
}

impl Args {
    /// Returns an error if options for poses are given but have no effect.
    pub fn check_used(&self) -> Result<()> {
        let has_poses = self.poses.is_some();
        check_used("--repeat", self.repeat.is_some(), has_poses, "--poses")?;
        check_used("--json", self.json, has_poses, "--poses")
    }
}

/// Row of the CSV file of poses: position in metres, and unit quaternion.
#[derive(Deserialize)]
struct Row {
    x: f64,
    y: f64,
    z: f64,
    qw: f64,
    qx: f64,
    qy: f64,
    qz: f64,
}

/// Values that are printed about a pose.
#[derive(Serialize)]
struct Reading {
    /// Travel of the patch, mm.
    travel_mm: f64,
    n_touched: usize,
    n_saturated: usize,
    /// Median computing time over the repetitions of one press, µs.
    us: f64,
}

/// Presses the object in each pose of the file at `path`.
pub fn press_poses(
    args: &Args,
    path: &Path,
    (patch, objects): (&Patch, &[Model; 1]),
    goal: Goal,
    out: Option<&Path>,
) -> Result<()> {
    let n_repeats = args.repeat.unwrap_or(1);
    if !(1..=MAX_REPEATS).contains(&n_repeats) {
        let allowed = format!("1 to {MAX_REPEATS}");
        return Err(Error::input("--repeat", n_repeats, allowed));
    }
    check_ending(out, "npy")?;
    let poses = read_poses(path)?;
    let grid = patch.layout().as_grid();
    let (ny, nx) = grid.map_or((1, patch.n_taxels()), |grid| (grid.ny, grid.nx));
    let mut frames = Array3::zeros((poses.len(), ny, nx));
    let mut workspace = Workspace::new();
    let press = |pose: &Pose, workspace: &mut Workspace| {
        contact::press(patch, objects, &[*pose], goal, workspace)
    };
    let mut contacts: Vec<Option<Contact>> = Vec::with_capacity(poses.len());
    for (pose, mut frame) in poses.iter().zip(frames.outer_iter_mut()) {
        contacts.push(press(pose, &mut workspace)?);
        let read = ArrayView2::from_shape(frame.dim(), workspace.deflections());
        frame.assign(&read.expect("a press gives one deflection a taxel"));
    }
    // All poses are pressed in turn, because an immediate repetition of one pose would use warm caches.
    let mut times = vec![Vec::new(); poses.len()];
    for _ in 0..args.repeat.unwrap_or(1) {
        for (pose, times) in poses.iter().zip(&mut times) {
            let start = Instant::now();
            press(pose, &mut workspace)?;
            times.push(1e6 * start.elapsed().as_secs_f64());
        }
    }
    if let Some(out) = out {
        write_npy(out, &frames)?;
    }
    let readings = contacts.iter().zip(&mut times);
    let readings = readings.map(|(contact, times)| Reading {
        travel_mm: contact.map_or(0.0, |contact| 1e3 * contact.travel),
        n_touched: contact.map_or(0, |contact| contact.n_touched),
        n_saturated: contact.map_or(0, |contact| contact.n_saturated),
        us: quantile(times, 0.5),
    });
    tell(args, &objects[0], &readings.collect::<Vec<_>>())
}

fn tell(args: &Args, model: &Model, readings: &[Reading]) -> Result<()> {
    let mut us: Vec<f64> = readings.iter().map(|reading| reading.us).collect();
    let us = quantile(&mut us, 0.5);
    if args.json {
        let said = serde_json::json!({
            "n_spheres": model.n_spheres(),
            "n_triangles": model.n_triangles(),
            "us": us,
            "presses": readings,
        });
        return say(said);
    }
    let n_missed = readings.iter().filter(|r| r.n_touched == 0).count();
    say(format_args!(
        "{} poses, {n_missed} without contact; {us:.2} µs a press (median)",
        readings.len()
    ))
}

fn read_poses(path: &Path) -> Result<Vec<Pose>> {
    let place = path.display().to_string();
    let allowed = "a CSV file with columns x, y, z, qw, qx, qy, qz of finite numbers";
    let failed = table_error(path, allowed);
    let mut poses = Vec::new();
    let mut reader =
        csv::Reader::from_reader(bubbletouch::files::open(path).map_err(|e| failed(e.into()))?);
    for (number, row) in reader.deserialize().enumerate() {
        let row: Row = row.map_err(&failed)?;
        let turn = DQuat::from_xyzw(row.qx, row.qy, row.qz, row.qw);
        let at = DVec3::new(row.x, row.y, row.z);
        if !(at.is_finite() && turn.length().is_finite() && turn.length() > 0.0) {
            let place = format!("{place}, row {}", number + 1);
            return Err(Error::input(place, format!("{at}, {turn}"), allowed));
        }
        poses.push(Pose::new(turn.normalize(), at));
    }
    match poses.is_empty() {
        true => Err(Error::input(place, "no poses", "at least one")),
        false => Ok(poses),
    }
}
