//! `bubbletouch objects`: lists, draws, inspects and packs the objects that can be touched.

use crate::command::options::unused::check_used;
use crate::command::options::which_object::{WhichObject, catalogue};
use crate::command::terminal::{check_ending, say};
use crate::inputs::units::MM;
use bubbletouch::Result;
use bubbletouch::files::{write_bytes, write_whole};
use bubbletouch::mesh::{LengthUnit, MeshReport, SizeLimits};
use bubbletouch::objects::{
    Catalogue, Entry, Object, Solid, SphereUnion, surface_error, write_spheres,
};
use bubbletouch::packing::{DistanceStatistics, PackingError, packing_error};
use bubbletouch::report::fit_picture::{Original, fit_picture};
use bubbletouch::report::object_picture::contact_sheet;
use bubbletouch::report::terminal::rows_text;
use bubbletouch::study::{ModelSpec, ObjectsSpec, load_mesh, load_spheres, read_mesh_file};
use rayon::prelude::*;
use std::path::PathBuf;

/// Number of points on a mesh at which the surface error is measured.
const N_POINTS: usize = 100_000;
/// Approximate maximum number of points of the box around a solid at which the distance to its surface is measured. Larger: gigabytes at tolerances of a
/// micrometre.
const MAX_POINTS: f64 = 1e6;

/// Side length of the picture of one object, pixels.
const PICTURE: usize = 640;
/// Side length of an object's picture in an overview of many objects, pixels.
const TILE: usize = 240;
/// Number of objects in a row of the overview picture.
const COLUMNS: usize = 6;

/// List or draw objects; inspect, pack and show meshes
///
/// Without a name, the command lists all built-in objects, or those of a set. Sizes are in millimetres, x × y × z.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  bubbletouch objects mug --out mug.png")]
#[command(args_conflicts_with_subcommands = true)]
pub struct Args {
    #[command(subcommand)]
    action: Option<Action>,
    /// Names of objects [default: all]
    names: Vec<String>,
    /// Select a set: household, balls, boxes, cans or hands
    #[arg(
        long,
        value_name = "SET",
        conflicts_with = "names",
        help_heading = "Input"
    )]
    set: Option<String>,
    /// Read objects from a TOML file, not the built-in ones
    #[arg(long, value_name = "FILE.toml", conflicts_with_all = ["set", "mesh"], help_heading = "Input")]
    objects: Option<PathBuf>,
    /// Draw a mesh, packed with spheres
    #[arg(long, value_name = "FILE", conflicts_with_all = ["names", "set"], help_heading = "Input")]
    mesh: Option<PathBuf>,
    /// Set the unit of the mesh: m, cm, mm or in
    ///
    /// Without this option, the unit is the metre, and the mesh must be 0.1 mm to 10 m large.
    #[arg(long, value_name = "UNIT", conflicts_with_all = ["names", "set", "objects"], help_heading = "Input")]
    unit: Option<LengthUnit>,
    /// Limit the distance between spheres and surface [default: 0.25]
    #[arg(
        long,
        value_name = "MM",
        conflicts_with = "mesh",
        help_heading = "Input"
    )]
    surface_error_mm: Option<f64>,
    /// Draw the objects to this file instead of listing them
    ///
    /// One object gives a single picture; several objects are arranged in a grid.
    #[arg(long, value_name = "FILE.png", help_heading = "Output")]
    out: Option<PathBuf>,
}

#[derive(clap::Subcommand)]
enum Action {
    Mesh(MeshArgs),
    Pack(PackArgs),
    Show(ShowArgs),
}

/// Print the size, closedness and faults of a mesh
#[derive(clap::Args)]
#[command(after_help = "Example:\n  bubbletouch objects mesh scan.ply --unit mm")]
struct MeshArgs {
    /// PLY, OBJ, STL, Collada or glTF file
    file: PathBuf,
    /// Set the unit of the mesh: m, cm, mm or in
    ///
    /// Without this option, the unit is the metre, and the mesh must be 0.1 mm to 10 m large.
    #[arg(long, value_name = "UNIT", help_heading = "Input")]
    unit: Option<LengthUnit>,
}

/// Pack an object with few spheres to a surface error
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  bubbletouch objects pack mug --surface-error-mm 0.5 --out mug.csv"
)]
struct PackArgs {
    #[command(flatten)]
    object: WhichObject,
    /// Limit the distance between spheres and surface
    #[arg(long, value_name = "MM", help_heading = "Packing")]
    surface_error_mm: f64,
    /// Write the spheres: columns x, y, z, r, metres
    #[arg(long, value_name = "FILE.csv", help_heading = "Output")]
    out: PathBuf,
}

/// Draw an object, its spheres and the error between them
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  bubbletouch objects show mug --surface-error-mm 0.5 --out fit.png"
)]
struct ShowArgs {
    #[command(flatten)]
    object: WhichObject,
    /// Pack to this surface error
    #[arg(
        long,
        value_name = "MM",
        default_value_t = 0.5,
        help_heading = "Packing"
    )]
    surface_error_mm: f64,
    /// Show the spheres of a CSV file (columns x,y,z,r)
    #[arg(
        long,
        value_name = "FILE.csv",
        conflicts_with = "surface_error_mm",
        help_heading = "Packing"
    )]
    spheres: Option<PathBuf>,
    /// Set the unit of --spheres: m, cm, mm or in [default: m]
    #[arg(long, value_name = "UNIT", help_heading = "Packing")]
    spheres_unit: Option<LengthUnit>,
    /// Write the picture to this file
    #[arg(long, value_name = "FILE.png", help_heading = "Output")]
    out: PathBuf,
    /// Set the side of each of three panels, 200 to 6000 pixels
    #[arg(
        long,
        value_name = "PIXELS",
        default_value_t = 560,
        help_heading = "Output"
    )]
    panel_px: usize,
}

/// Object, preceded by the name of its set.
type Listed = (String, Object);

pub fn objects(args: &Args) -> Result<()> {
    match &args.action {
        Some(Action::Mesh(args)) => return report(args),
        Some(Action::Pack(args)) => return pack(args),
        Some(Action::Show(args)) => return show(args),
        None => {}
    }
    let (unit, is_mesh) = (args.unit, args.mesh.is_some());
    check_used("--unit", unit.is_some(), is_mesh, "--mesh")?;
    let listed = args.build()?;
    let Some(path) = &args.out else {
        return say(table(&listed));
    };
    check_ending(Some(path), "png")?;
    let tiles: Vec<_> = listed
        .iter()
        .map(|(_, object)| (object.name.as_str(), spheres(object)))
        .collect();
    let tile = if tiles.len() == 1 { PICTURE } else { TILE };
    let picture = contact_sheet(&tiles, COLUMNS, tile)?;
    write_bytes(path, &picture.png()?)
}

fn report(args: &MeshArgs) -> Result<()> {
    let place = args.file.display().to_string();
    let mesh = read_mesh_file(&args.file, args.unit, &SizeLimits::ANY)?.into_mesh(&place)?;
    say(MeshReport::new(&mesh))
}

fn spheres(object: &Object) -> &SphereUnion {
    let spheres = object.model.spheres();
    spheres.expect("solids and packed meshes are drawn as spheres")
}

impl Args {
    fn build(&self) -> Result<Vec<Listed>> {
        if let Some(path) = &self.mesh {
            let spec = ObjectsSpec {
                unit: self.unit,
                model: self.out.is_some().then_some(ModelSpec::Packed),
                ..ObjectsSpec::default()
            };
            return Ok(vec![("mesh".to_owned(), load_mesh(path, &spec, None)?)]);
        }
        let surface_error = self.surface_error_mm.unwrap_or(0.25) * 1e-3;
        let built = |entry: &Entry| Ok((entry.set.clone(), entry.build(surface_error)?));
        let catalogue = catalogue(self.objects.as_deref())?;
        let chosen = self.chosen(&catalogue)?.into_par_iter();
        chosen.map(built).collect()
    }

    fn chosen<'a>(&self, catalogue: &'a Catalogue) -> Result<Vec<&'a Entry>> {
        if let Some(set) = &self.set {
            return catalogue.set(set);
        }
        if self.names.is_empty() {
            return Ok(catalogue.entries().iter().collect());
        }
        let named = self.names.iter().map(|name| catalogue.object(name));
        named.collect()
    }
}

fn table(listed: &[Listed]) -> String {
    let header = ["set", "name", "parts", "spheres", "size (mm)"];
    let rows = listed.iter().map(|(set, object)| {
        let size = object.model.bounds().size() * 1e3;
        vec![
            set.clone(),
            object.name.clone(),
            object.n_parts.to_string(),
            match object.model.n_triangles() {
                0 => object.model.n_spheres().to_string(),
                n => format!("{n} triangles"),
            },
            format!("{:.0} × {:.0} × {:.0}", size.x, size.y, size.z),
        ]
    });
    rows_text(&header, &[0, 1, 4], rows)
}

/// Packs a mesh or a built-in object with few spheres, and measures the surface error.
fn pack(args: &PackArgs) -> Result<()> {
    check_ending(Some(&args.out), "csv")?;
    let object = args.object.load()?;
    let tolerance = args.surface_error_mm * MM;
    let spheres = args.object.pack(&object, tolerance)?;
    write_whole(&args.out, |sink| write_spheres(&spheres, sink))?;
    say(format_args!("spheres     {}", spheres.n_spheres()))?;
    match object {
        Original::Solid(solid) => say(describe_solid(&solid, &spheres, tolerance))?,
        Original::Mesh(surface, body) => {
            say(describe(&packing_error(&surface, body, &spheres, N_POINTS)))?;
        }
    }
    Ok(())
}

fn describe_solid(solid: &Solid, spheres: &SphereUnion, tolerance: f64) -> String {
    let size = solid.bounds().size();
    let around = 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x);
    let finest = (around / MAX_POINTS).sqrt();
    let spacing = (size.length() / 200.0).min(20.0 * tolerance).max(finest);
    let error = surface_error(solid, spheres, spacing);
    format!(
        "gap         max {:.4} mm\nprotrusion  max {:.4} mm\nmeasured at {} points of the surface",
        error.gap / MM,
        error.protrusion / MM,
        error.n_surface_points
    )
}

fn describe(error: &PackingError) -> String {
    let line = |spread: &DistanceStatistics| {
        let [mean, p95, max] = [spread.mean, spread.p95, spread.max].map(|length| length / MM);
        format!("mean {mean:.4}, 95 % {p95:.4}, max {max:.4} mm")
    };
    format!(
        "gap         {}\nprotrusion  {}\nmeasured at {} points of the outer surface; {:.2} % of all lie inside other parts",
        line(&error.gap),
        line(&error.protrusion),
        error.n_points,
        100.0 * error.buried_share
    )
}

/// Draws an object, its spheres, and the error between them in three panels.
fn show(args: &ShowArgs) -> Result<()> {
    check_ending(Some(&args.out), "png")?;
    let (unit, has_spheres) = (args.spheres_unit, args.spheres.is_some());
    check_used("--spheres-unit", unit.is_some(), has_spheres, "--spheres")?;
    let object = args.object.load()?;
    let spheres = match &args.spheres {
        Some(path) => load_spheres(path, args.spheres_unit, &SizeLimits::ANY)?,
        None => args.object.pack(&object, args.surface_error_mm * 1e-3)?,
    };
    let name = args.object.name();
    let picture = fit_picture(&name, &object, &spheres, args.panel_px)?;
    write_bytes(&args.out, &picture.png()?)
}
