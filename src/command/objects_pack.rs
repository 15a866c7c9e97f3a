//! `bubbletouch objects pack`: a mesh or a built-in object as few spheres, and how well they fit.

use bubbletouch::files::write_whole;
use bubbletouch::mesh::{LengthUnit, Surface};
use bubbletouch::objects::{Catalogue, SphereUnion, surface_error, write_spheres};
use bubbletouch::packing::{Body, PackingError, Spread, pack_mesh_watched, packing_error};
use bubbletouch::report::progress::to_stderr;
use bubbletouch::study::read_mesh_file;
use bubbletouch::{Error, Result};
use std::path::{Path, PathBuf};

const MM: f64 = 1e-3;
/// Points of a mesh at which the error is measured.
const N_POINTS: usize = 100_000;

/// Pack a mesh or a built-in object with few spheres.
///
/// No sphere reaches more than the tolerance outside the object, and no point of its outer surface is farther than the
/// tolerance from the spheres. Both are measured and reported.
#[derive(clap::Args)]
pub struct Args {
    /// A PLY, OBJ or STL file, or the name of a built-in object
    object: String,
    /// How far the two surfaces may be apart
    #[arg(long, value_name = "MM")]
    tolerance_mm: f64,
    /// Where the spheres go: columns x, y, z, r in metres
    #[arg(long, value_name = "FILE.csv")]
    out: PathBuf,
    /// Unit of a mesh file: m, cm, mm or in
    #[arg(long, value_name = "UNIT", default_value = "m")]
    unit: LengthUnit,
    /// Pack a mesh's surface without thickness, holes and all, instead of the solid that it encloses
    #[arg(long)]
    as_sheet: bool,
}

pub fn pack(args: &Args) -> Result<()> {
    if args.out.extension().is_none_or(|ending| ending != "csv") {
        return Err(Error::input(
            args.out.display(),
            "not a .csv file",
            "a name that ends in .csv",
        ));
    }
    let catalogue = Catalogue::builtin()?;
    let is_builtin = catalogue.object(&args.object).is_ok();
    let (spheres, report) = if is_builtin && !Path::new(&args.object).exists() {
        pack_builtin(&catalogue, args)?
    } else {
        pack_file(args)?
    };
    write_whole(&args.out, |sink| write_spheres(&spheres, sink))?;
    println!("spheres     {}", spheres.n_spheres());
    println!("{report}");
    Ok(())
}

fn pack_builtin(catalogue: &Catalogue, args: &Args) -> Result<(SphereUnion, String)> {
    let tolerance = args.tolerance_mm * MM;
    let solid = &catalogue.object(&args.object)?.solid;
    let spheres = solid.pack(tolerance)?;
    let spacing = (solid.bounds().size().length() / 200.0).min(20.0 * tolerance);
    let error = surface_error(solid, &spheres, spacing);
    let report = format!(
        "gap         max {:.4} mm\nprotrusion  max {:.4} mm\nmeasured at {} points of the surface",
        error.gap / MM,
        error.protrusion / MM,
        error.n_surface_points
    );
    Ok((spheres, report))
}

fn pack_file(args: &Args) -> Result<(SphereUnion, String)> {
    let body = if args.as_sheet {
        Body::Sheet
    } else {
        Body::Solid
    };
    let mesh = read_mesh_file(Path::new(&args.object), args.unit)?.into_mesh(&args.object)?;
    let surface = Surface::new(mesh);
    const STEPS: u64 = 100;
    let progress = to_stderr();
    progress.stage("pack", STEPS);
    let mut done = 0;
    let packing = pack_mesh_watched(&surface, body, args.tolerance_mm * MM, &mut |share| {
        let now = (share * STEPS as f64) as u64;
        progress.advance(now.saturating_sub(done));
        done = done.max(now);
    })?;
    progress.stage("measure", 1);
    let error = packing_error(&surface, body, &packing.spheres, N_POINTS);
    progress.advance(1);
    progress.finish("");
    let mut report = describe(&error);
    if packing.n_unproved > 0 {
        report += &format!(
            "\nnot proved at {} places of the surface",
            packing.n_unproved
        );
    }
    Ok((packing.spheres, report))
}

fn describe(error: &PackingError) -> String {
    let line = |spread: &Spread| {
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
