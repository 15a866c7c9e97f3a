//! `bubbletouch objects`: lists or draws the objects that can be touched.

use super::{objects_pack, objects_show};
use crate::command::options::unused::check_used;
use crate::command::options::which_object::catalogue;
use crate::command::terminal::output::check_ending;
use crate::command::terminal::streams::say;
use bubbletouch::Result;
use bubbletouch::files::write_bytes;
use bubbletouch::mesh::{LengthUnit, MeshReport, SizeLimits};
use bubbletouch::objects::{Catalogue, Entry, Object, SphereUnion};
use bubbletouch::report::object_picture::contact_sheet;
use bubbletouch::report::terminal::rows_text;
use bubbletouch::study::{ModelSpec, ObjectsSpec, load_mesh, read_mesh_file};
use rayon::prelude::*;
use std::path::PathBuf;

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
    Pack(objects_pack::Args),
    Show(objects_show::Args),
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

/// Object, preceded by the name of its set.
type Listed = (String, Object);

pub fn objects(args: &Args) -> Result<()> {
    match &args.action {
        Some(Action::Mesh(args)) => return report(args),
        Some(Action::Pack(args)) => return objects_pack::pack(args),
        Some(Action::Show(args)) => return objects_show::show(args),
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
