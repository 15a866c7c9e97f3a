//! `bubbletouch press`: presses one object on one patch and prints the reading.

use super::classify::word;
use crate::command::options::unused::check_used;
use crate::command::options::which_object::catalogue;
use crate::command::terminal::{check_ending, note, say, terminal_width, write_out};
use crate::inputs::units::MM;
use crate::numbers_csv::NumberTable;
use bubbletouch::contact::{Contact, Press, Until, Workspace};
use bubbletouch::files::{check_single_output, open};
use bubbletouch::geometry::Pose;
use bubbletouch::mesh::{LengthUnit, SizeLimits};
use bubbletouch::objects::Model;
use bubbletouch::report::frame_files::write_frame;
use bubbletouch::report::pressure_map::pressure_text;
use bubbletouch::report::terminal::Ink;
use bubbletouch::signal::Quantity;
use bubbletouch::study::{ModelSpec, ObjectsSpec, load_mesh, load_spheres, millimetres, write_npy};
use bubbletouch::world::{Grid, Patch, RestPose, RestPoses, Taxel, Touch};
use bubbletouch::{Error, Result};
use glam::{DQuat, DVec3};
use ndarray::{Array2, Array3, ArrayView2};
use std::path::{Path, PathBuf};

/// Press one object on one array; draw or write deflections
///
/// The object lies on a table. The patch approaches from above along its own axis, to first contact and then further by the depth, or until the
/// springs carry the force.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  bubbletouch press --object mug --depth-mm 3 --out mug.png")]
pub struct Args {
    #[command(flatten)]
    source: Source,
    /// Read objects from a TOML file, not the built-in ones
    #[arg(long, value_name = "FILE.toml", conflicts_with_all = ["mesh", "spheres"], help_heading = "Object")]
    objects: Option<PathBuf>,
    /// Press this deep past first contact [default: 3; spheres stay in place]
    ///
    /// Taxels that reach their stroke are saturated.
    #[arg(long, value_name = "MM", help_heading = "Press")]
    depth_mm: Option<f64>,
    /// Press until all springs together carry this force
    #[arg(
        long,
        visible_alias = "force",
        value_name = "N",
        conflicts_with = "depth_mm",
        help_heading = "Press"
    )]
    force_n: Option<f64>,
    #[command(flatten)]
    place: Place,
    /// Press the object at every pose of a CSV file
    ///
    /// Columns x, y, z in metres and qw, qx, qy, qz: the object in the patch frame (taxels rest in the plane z = 0, axes along +z). With --depth-mm,
    /// each pose is moved to that depth past first contact; otherwise it is used as given. With --out FILE.npy, the array has n × ny × nx deflections
    /// in metres.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["Place", "force_n"], help_heading = "Press")]
    poses: Option<PathBuf>,
    /// Represent a mesh as mesh, packed or vertex_spheres [default: mesh]
    #[arg(long, value_name = "MODEL", value_parser = word::<ModelSpec>, conflicts_with_all = ["object", "spheres"], help_heading = "Object")]
    model: Option<ModelSpec>,
    /// Set the unit of the file: m, cm, mm or in
    ///
    /// Without this option, the unit is the metre, and a file of a size that the array cannot measure is refused.
    #[arg(
        long,
        value_name = "UNIT",
        conflicts_with = "object",
        help_heading = "Object"
    )]
    unit: Option<LengthUnit>,
    /// Limit the distance between spheres and surface [default: 0.25; pitch / 10 for meshes]
    #[arg(long, value_name = "MM", help_heading = "Object")]
    surface_error_mm: Option<f64>,
    /// Set the columns and rows of the array
    #[arg(long, value_name = "NXxNY", default_value = "64x64", value_parser = parse_taxels, help_heading = "Array")]
    taxels: (usize, usize),
    /// Set the distance between taxels
    #[arg(long, value_name = "MM", default_value_t = 2.0, help_heading = "Array")]
    pitch_mm: f64,
    /// Set the radius of a taxel [default: half the pitch]
    #[arg(long, value_name = "MM", help_heading = "Array")]
    taxel_radius_mm: Option<f64>,
    /// Set the largest deflection of a taxel
    #[arg(long, value_name = "MM", default_value_t = 5.0, help_heading = "Array")]
    stroke_mm: f64,
    /// Set the spring constant of a taxel, for --force-n [default: 100]
    #[arg(long, value_name = "N/M", help_heading = "Array")]
    stiffness_n_per_m: Option<f64>,
    /// Write deflections to .csv, .npz or .png; do not draw
    ///
    /// The array has ny × nx deflections in metres.
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    out: Option<PathBuf>,
}

#[derive(clap::Args)]
#[group(required = true, multiple = false)]
struct Source {
    /// Press a built-in object, or one of --objects
    #[arg(long, value_name = "NAME", help_heading = "Object")]
    object: Option<String>,
    /// Press a PLY, OBJ, STL, Collada or glTF mesh
    #[arg(long, value_name = "FILE", help_heading = "Object")]
    mesh: Option<PathBuf>,
    /// Press spheres of a CSV file (columns x,y,z,r)
    ///
    /// The columns are in the patch frame: taxels rest in the plane z = 0, axes along +z.
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with = "Place",
        help_heading = "Object"
    )]
    spheres: Option<PathBuf>,
}

#[derive(clap::Args)]
#[group(id = "Place", multiple = true)]
struct Place {
    /// Lay the object in stable pose N, 0 the likeliest [default: as modelled]
    #[arg(long, value_name = "N", help_heading = "Press")]
    rest: Option<usize>,
    /// Shift the patch along x from the object's middle
    #[arg(long, value_name = "MM", allow_negative_numbers = true, default_value_t = 0.0, value_parser = finite, help_heading = "Press")]
    offset_x_mm: f64,
    /// Shift the patch along y from the object's middle
    #[arg(long, value_name = "MM", allow_negative_numbers = true, default_value_t = 0.0, value_parser = finite, help_heading = "Press")]
    offset_y_mm: f64,
    /// Turn the object about the vertical
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, default_value_t = 0.0, value_parser = finite, help_heading = "Press")]
    yaw_deg: f64,
    /// Tilt the patch about its x axis
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, default_value_t = 0.0, value_parser = finite, help_heading = "Press")]
    tilt_x_deg: f64,
    /// Tilt the patch about its y axis
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, default_value_t = 0.0, value_parser = finite, help_heading = "Press")]
    tilt_y_deg: f64,
}

fn finite(text: &str) -> std::result::Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| "expected a finite number".to_owned())
}

fn parse_taxels(text: &str) -> std::result::Result<(usize, usize), String> {
    const MOST: usize = 4096;
    let parsed = text
        .split_once(['x', '×'])
        .and_then(|(nx, ny)| Some((nx.parse().ok()?, ny.parse().ok()?)));
    match parsed {
        Some((nx, ny)) if (1..=MOST).contains(&nx) && (1..=MOST).contains(&ny) => Ok((nx, ny)),
        _ => Err(format!(
            "expected columns x rows, each from 1 to {MOST}, such as 64x64"
        )),
    }
}

pub fn press(args: &Args) -> Result<()> {
    args.check_used()?;
    args.out.as_deref().map_or(Ok(()), check_single_output)?;
    let patch = args.patch()?;
    let (model, pose) = args.placed_object()?;
    let objects = [model];
    let goal = match (args.force_n, args.depth(patch.taxels().at(0))?) {
        (Some(force), _) => Until::Force(force),
        (_, Some(depth)) => Until::Depth(depth),
        (None, None) => Until::Pose,
    };
    if let Some(path) = &args.poses {
        return args.press_poses(path, (&patch, &objects), goal);
    }
    let mut workspace = Workspace::new();
    let contact = Press::new(&patch, &objects, &[pose], goal).run(&mut workspace)?;
    // An object that is not moved may be clear of the array.
    let untouched = (goal == Until::Pose).then(Contact::default);
    let contact = contact.or(untouched).ok_or_else(|| {
        let allowed = "an offset that brings some of it over a taxel";
        Error::input("press", "the object is not over the array", allowed)
    })?;
    let (nx, ny) = args.taxels;
    let frame = Array2::from_shape_vec((ny, nx), workspace.deflections().to_vec())
        .expect("a press gives one deflection a taxel");
    if let Some(path) = &args.out {
        write_frame(path, &frame, &args.grid())?;
    } else {
        let (pitch_mm, ink) = (args.pitch_mm, Ink::of_stdout());
        let (quantity, width) = (Quantity::Deflection, terminal_width());
        let text = pressure_text(&frame, pitch_mm, quantity, ink, width)?;
        write_out(text.as_bytes())?;
    }
    let deepest = frame.iter().fold(0.0_f64, |a, &b| a.max(b));
    let force = args.force_n.map_or(String::new(), |_| {
        let force = patch.taxels().at(0).stiffness * frame.sum();
        format!("; {force:.3} N together")
    });
    note(format_args!(
        "{} of {} taxels touched, {} saturated; deepest {:.3} mm{force}",
        contact.n_touched,
        frame.len(),
        contact.n_saturated,
        1e3 * deepest
    ));
    Ok(())
}

impl Args {
    /// Returns an error if options are given that have no effect.
    fn check_used(&self) -> Result<()> {
        let is_packed = self.model == Some(ModelSpec::Packed);
        let has_error = self.source.object.is_some() || is_packed;
        let user = "--object, or --mesh with --model packed";
        let given = self.surface_error_mm.is_some();
        check_used("--surface-error-mm", given, has_error, user)?;
        let (stiffness, force) = (self.stiffness_n_per_m, self.force_n);
        let user = "--force-n";
        check_used(
            "--stiffness-n-per-m",
            stiffness.is_some(),
            force.is_some(),
            user,
        )
    }

    /// Presses the object in each pose of the file at `path`, and writes the deflections to a file.
    fn press_poses(
        &self,
        path: &Path,
        (patch, objects): (&Patch, &[Model; 1]),
        goal: Until,
    ) -> Result<()> {
        check_ending(self.out.as_deref(), "npy")?;
        let poses = read_poses(path)?;
        let (nx, ny) = self.taxels;
        let mut frames = Array3::zeros((poses.len(), ny, nx));
        let mut n_missed = 0;
        let mut workspace = Workspace::new();
        for (pose, mut frame) in poses.iter().zip(frames.outer_iter_mut()) {
            let contact = Press::new(patch, objects, &[*pose], goal).run(&mut workspace)?;
            n_missed += usize::from(contact.is_none_or(|contact| contact.n_touched == 0));
            let read = ArrayView2::from_shape(frame.dim(), workspace.deflections());
            frame.assign(&read.expect("a press gives one deflection a taxel"));
        }
        if let Some(out) = &self.out {
            write_npy(out, &frames)?;
        }
        let n = poses.len();
        say(format_args!("{n} poses, {n_missed} without contact"))
    }

    fn grid(&self) -> Grid {
        let (nx, ny) = self.taxels;
        let pitch = self.pitch_mm * MM;
        Grid { nx, ny, pitch }
    }

    fn patch(&self) -> Result<Patch> {
        let taxel = Taxel {
            radius: self.taxel_radius(),
            stiffness: self.stiffness_n_per_m.unwrap_or(100.0),
            damping: 0.0,
            stroke: self.stroke_mm * MM,
        };
        Patch::grid(self.grid(), taxel)
    }

    /// Metres.
    fn taxel_radius(&self) -> f64 {
        self.taxel_radius_mm.unwrap_or(0.5 * self.pitch_mm) * MM
    }

    /// Returns the object and its initial pose `patch_from_object`.
    fn placed_object(&self) -> Result<(Model, Pose)> {
        let (nx, ny) = self.taxels;
        let side = nx.max(ny) as f64 * self.pitch_mm * MM;
        let can_feel = SizeLimits::of_arrays([(side, self.taxel_radius())]);
        let model = self.model.unwrap_or_default();
        let default_error_mm = || model.default_surface_error_mm(self.pitch_mm);
        let surface_error_mm = self.surface_error_mm.unwrap_or_else(default_error_mm);
        let Source {
            object,
            mesh,
            spheres,
        } = &self.source;
        let model = if let Some(path) = spheres {
            let spheres = load_spheres(path, self.unit, &can_feel)?;
            return Ok((spheres.into(), Pose::IDENTITY));
        } else if let Some(path) = mesh {
            let spec = ObjectsSpec {
                unit: self.unit,
                sizes: Some(can_feel),
                model: self.model,
                pitch: Some(self.pitch_mm * MM),
                surface_error_mm: Some(surface_error_mm),
                ..ObjectsSpec::default()
            };
            load_mesh(path, &spec, None)?.model
        } else {
            let catalogue = catalogue(self.objects.as_deref())?;
            let name = object.as_deref().unwrap_or_default();
            catalogue.object(name)?.build(MM * surface_error_mm)?.model
        };
        let rest = self.place.rest(&model)?;
        let pose = self.place.touch().patch_from_object(&rest);
        Ok((model, pose))
    }

    /// Returns the press depth past first contact, metres; `None` for a press to a force, or for an object that is not moved. Prints a note if the depth
    /// exceeds the stroke of the taxels.
    fn depth(&self, taxel: &Taxel) -> Result<Option<f64>> {
        let is_placed = self.source.spheres.is_some() || self.poses.is_some();
        let default = (!is_placed && self.force_n.is_none()).then_some(3.0);
        let Some(depth_mm) = self.depth_mm.or(default) else {
            return Ok(None);
        };
        if !(depth_mm.is_finite() && depth_mm > 0.0) {
            let allowed = "a positive number of millimetres";
            return Err(Error::input("--depth-mm", depth_mm, allowed));
        }
        let depth = depth_mm * MM;
        if depth > taxel.stroke {
            note(format_args!(
                "note: a depth of {} mm is beyond the stroke of {} mm: taxels that would go further than it are saturated",
                millimetres(depth),
                millimetres(taxel.stroke)
            ));
        }
        Ok(Some(depth))
    }
}

impl Place {
    /// Returns the touch; its depth is 0.
    fn touch(&self) -> Touch {
        Touch {
            rest: 0,
            offset: [self.offset_x_mm, self.offset_y_mm].map(|mm| mm * MM),
            yaw: self.yaw_deg.to_radians(),
            tilt: [self.tilt_x_deg, self.tilt_y_deg].map(f64::to_radians),
            depth: 0.0,
            indices: [None; 7],
        }
    }

    /// Returns the stable pose in which the object lies; returns an error if the object does not have the requested pose.
    fn rest(&self, model: &Model) -> Result<RestPose> {
        let Some(number) = self.rest else {
            return Ok(RestPoses::AsModelled.poses(model).swap_remove(0));
        };
        let mut poses = RestPoses::Stable.poses(model);
        if number >= poses.len() {
            let last = poses.len() - 1;
            let allowed = format!("0 to {last}, the stable poses of this object");
            return Err(Error::input("--rest", number, allowed));
        }
        Ok(poses.swap_remove(number))
    }
}

/// Reads a CSV file of poses: positions in metres, and quaternions of any length above 0.
fn read_poses(path: &Path) -> Result<Vec<Pose>> {
    const COLUMNS: [&str; 7] = ["x", "y", "z", "qw", "qx", "qy", "qz"];
    let allowed = "a CSV file with columns x, y, z, qw, qx, qy, qz of finite numbers";
    let place = path.display().to_string();
    let file = open(path).map_err(|error| Error::unreadable(&place, allowed, error))?;
    let table = NumberTable::read(&place, file, allowed)?;
    let columns = COLUMNS.map(|name| {
        let missing = || table.refuse_header(format!("no column `{name}`"), allowed);
        table.position(name).ok_or_else(missing)
    });
    let [x, y, z, qw, qx, qy, qz] = columns;
    let columns = [x?, y?, z?, qw?, qx?, qy?, qz?];
    if table.lines.is_empty() {
        return Err(Error::input(place, "no poses", "at least one"));
    }
    let pose = |(row, line)| {
        let [x, y, z, qw, qx, qy, qz] = columns.map(|column| table.columns[column][row]);
        let turn = DQuat::from_xyzw(qx, qy, qz, qw);
        if !(turn.length().is_finite() && turn.length() > 0.0) {
            let place = format!("{place}, line {line}");
            return Err(Error::input(place, turn, allowed));
        }
        Ok(Pose::new(turn.normalize(), DVec3::new(x, y, z)))
    };
    table.lines.iter().enumerate().map(pose).collect()
}
