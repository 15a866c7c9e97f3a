//! Object for which a command is run: a mesh file or a built-in object. The object is packed with a progress display.

use crate::command::options::unused::check_used;
use crate::command::terminal::note;
use bubbletouch::Result;
use bubbletouch::mesh::{LengthUnit, SizeLimits, Surface};
use bubbletouch::objects::{Catalogue, SphereUnion};
use bubbletouch::packing::{Body, error_of_file, pack_mesh_watched, slow_packing};
use bubbletouch::report::fit_picture::Original;
use bubbletouch::report::progress::to_stderr;
use bubbletouch::study::{load_catalogue, read_mesh};
use std::path::{Path, PathBuf};

/// Surface error relative to the size of a solid below which packing may take minutes.
const FINE: f64 = 1e-4;

#[derive(clap::Args)]
pub struct WhichObject {
    /// Mesh file (PLY, OBJ, STL, DAE, GLB), or name of an object
    object: String,
    /// Read objects from a TOML file, not the built-in ones
    #[arg(long, value_name = "FILE.toml", help_heading = "Input")]
    objects: Option<PathBuf>,
    /// Set the unit of the mesh: m, cm, mm or in
    ///
    /// Without this option, the unit is the metre, and the mesh must be 0.1 mm to 10 m large.
    #[arg(long, value_name = "UNIT", help_heading = "Input")]
    unit: Option<LengthUnit>,
    /// Treat a mesh as a surface without thickness
    ///
    /// Holes stay open. Otherwise a mesh is the solid that it encloses.
    #[arg(long, help_heading = "Input")]
    as_sheet: bool,
    /// Close holes of a mesh up to this width
    #[arg(
        long,
        value_name = "MM",
        conflicts_with = "as_sheet",
        help_heading = "Input"
    )]
    close_holes_mm: Option<f64>,
}

impl WhichObject {
    /// Loads the object; a file has priority over a built-in object with the same name.
    pub fn load(&self) -> Result<Original> {
        let path = Path::new(&self.object);
        let catalogue = catalogue(self.objects.as_deref())?;
        let entry = catalogue.object(&self.object);
        if self.objects.is_some() || (entry.is_ok() && !path.exists()) {
            self.check_used()?;
            return Ok(Original::Solid(entry?.solid.clone()));
        }
        let body = if self.as_sheet {
            Body::Sheet
        } else {
            Body::Solid
        };
        let widest = self.close_holes_mm.map(|width| width * 1e-3);
        let (mesh, _) = read_mesh(path, self.unit, &SizeLimits::ANY, widest)?;
        Ok(Original::Mesh(Box::new(Surface::new(mesh)), body))
    }

    /// Returns an error if mesh options are given for an object that is not a mesh.
    fn check_used(&self) -> Result<()> {
        for (option, is_given) in [
            ("--unit", self.unit.is_some()),
            ("--as-sheet", self.as_sheet),
            ("--close-holes-mm", self.close_holes_mm.is_some()),
        ] {
            check_used(option, is_given, false, "the file of a mesh as the object")?;
        }
        Ok(())
    }

    /// Packs an object with few spheres, whose distance from its surface is at most `tolerance` metres.
    pub fn pack(&self, object: &Original, tolerance: f64) -> Result<SphereUnion> {
        let (surface, body) = match object {
            Original::Solid(solid) => {
                if tolerance < FINE * solid.bounds().size().length() {
                    note(format_args!(
                        "note: {}: a surface error of {:e} mm is small beside the object: to pack and to measure it may take minutes",
                        self.object,
                        1e3 * tolerance
                    ));
                }
                return solid.pack(tolerance);
            }
            Original::Mesh(surface, body) => (surface, body),
        };
        if let Some(slow) = slow_packing(surface, *body, tolerance) {
            note(format_args!("note: {}: {slow}", self.object));
        }
        const STEPS: u64 = 100;
        let progress = to_stderr();
        progress.stage("pack", STEPS);
        let mut done = 0;
        let packing = pack_mesh_watched(surface, *body, tolerance, &mut |share| {
            let now = (share * STEPS as f64) as u64;
            progress.advance(now.saturating_sub(done));
            done = done.max(now);
        });
        let advice = "--close-holes-mm WIDTH closes holes up to that width, --as-sheet packs the surface without thickness";
        let packing = packing.map_err(|error| error_of_file(error, &self.object, advice))?;
        progress.finish("");
        Ok(packing.spheres)
    }

    /// Returns the file name of the object without folders and extension.
    pub fn name(&self) -> String {
        let stem = Path::new(&self.object).file_stem();
        stem.map_or_else(
            || self.object.clone(),
            |stem| stem.to_string_lossy().into_owned(),
        )
    }
}

/// Returns the objects of a TOML file, or the built-in objects if no file is given.
pub fn catalogue(file: Option<&Path>) -> Result<Catalogue> {
    file.map_or_else(Catalogue::builtin, load_catalogue)
}
