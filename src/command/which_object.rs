//! Which object a command is about: a mesh file or a built-in one; and its packing, with progress shown.

use bubbletouch::mesh::{LengthUnit, Surface, TriangleMesh};
use bubbletouch::objects::{Catalogue, Solid, SphereUnion, read_spheres};
use bubbletouch::packing::{Body, error_of_file, pack_mesh_watched};
use bubbletouch::report::fit_picture::Original;
use bubbletouch::report::progress::to_stderr;
use bubbletouch::study::read_mesh_file;
use bubbletouch::{Error, Result};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

#[derive(clap::Args)]
pub struct WhichObject {
    /// A PLY, OBJ or STL file, or the name of a built-in object
    object: String,
    /// Unit of a mesh file: m, cm, mm or in
    #[arg(long, value_name = "UNIT", default_value = "m")]
    unit: LengthUnit,
    /// Take a mesh as its surface without thickness, holes and all, not as the solid that it encloses
    #[arg(long)]
    as_sheet: bool,
    /// Close holes of a mesh that are at most this wide, and say so
    #[arg(long, value_name = "MM", conflicts_with = "as_sheet")]
    close_holes_mm: Option<f64>,
}

/// An object before it is packed.
pub enum Loaded {
    Mesh {
        file: String,
        surface: Box<Surface>,
        body: Body,
    },
    Solid(Solid),
}

impl WhichObject {
    /// A file goes before a built-in object of the same name.
    pub fn load(&self) -> Result<Loaded> {
        let path = Path::new(&self.object);
        let catalogue = Catalogue::builtin()?;
        if let Ok(entry) = catalogue.object(&self.object)
            && !path.exists()
        {
            return Ok(Loaded::Solid(entry.solid.clone()));
        }
        let body = if self.as_sheet {
            Body::Sheet
        } else {
            Body::Solid
        };
        let mesh = read_mesh_file(path, self.unit)?.into_mesh(&self.object)?;
        let surface = Box::new(Surface::new(self.closed(mesh)?));
        Ok(Loaded::Mesh {
            file: self.object.clone(),
            surface,
            body,
        })
    }

    /// The mesh without the holes that are to be closed.
    fn closed(&self, mesh: TriangleMesh) -> Result<TriangleMesh> {
        let Some(widest_mm) = self.close_holes_mm else {
            return Ok(mesh);
        };
        let closed = mesh
            .with_holes_closed(widest_mm * 1e-3)
            .map_err(|error| error.under("--close-holes-mm: "))?;
        eprintln!("note: {}: {closed}", self.object);
        Ok(closed.mesh)
    }

    /// Without folders and ending.
    pub fn name(&self) -> String {
        let stem = Path::new(&self.object).file_stem();
        stem.map_or_else(
            || self.object.clone(),
            |stem| stem.to_string_lossy().into_owned(),
        )
    }
}

impl Loaded {
    /// Few spheres within a tolerance (metres) of the object.
    pub fn pack(&self, tolerance: f64) -> Result<SphereUnion> {
        let (file, surface, body) = match self {
            Self::Solid(solid) => return solid.pack(tolerance),
            Self::Mesh {
                file,
                surface,
                body,
            } => (file, surface, *body),
        };
        const STEPS: u64 = 100;
        let progress = to_stderr();
        progress.stage("pack", STEPS);
        let mut done = 0;
        let packing = pack_mesh_watched(surface, body, tolerance, &mut |share| {
            let now = (share * STEPS as f64) as u64;
            progress.advance(now.saturating_sub(done));
            done = done.max(now);
        });
        let advice = "--close-holes-mm WIDTH closes holes up to that width, --as-sheet packs the surface without thickness";
        let packing = packing.map_err(|error| error_of_file(error, file, advice))?;
        progress.finish("");
        Ok(packing.spheres)
    }

    pub fn original(&self) -> Original<'_> {
        match self {
            Self::Mesh { surface, body, .. } => Original::Mesh(surface, *body),
            Self::Solid(solid) => Original::Solid(solid),
        }
    }
}

/// Spheres of a CSV file with columns x, y, z, r in metres.
pub fn spheres_file(path: &Path) -> Result<SphereUnion> {
    let place = path.display().to_string();
    let file = File::open(path).map_err(|error| {
        Error::input(
            &place,
            format!("cannot be opened ({error})"),
            "a CSV of spheres",
        )
    })?;
    read_spheres(&place, BufReader::new(file))
}
