//! `bubbletouch objects pack`: packs a mesh or a built-in object with few spheres, and measures the surface error.

use crate::command::options::which_object::WhichObject;
use crate::command::terminal::output::check_ending;
use crate::command::terminal::streams::say;
use bubbletouch::Result;
use bubbletouch::files::write_whole;
use bubbletouch::objects::{Solid, SphereUnion, surface_error, write_spheres};
use bubbletouch::packing::{DistanceStatistics, PackingError, packing_error};
use bubbletouch::report::fit_picture::Original;
use std::path::PathBuf;

const MM: f64 = 1e-3;
/// Number of points on a mesh at which the surface error is measured.
const N_POINTS: usize = 100_000;
/// Approximate maximum number of points of the box around a solid at which the distance to its surface is measured. Larger: gigabytes at tolerances of a
/// micrometre.
const MAX_POINTS: f64 = 1e6;

/// Pack an object with few spheres to a surface error
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  bubbletouch objects pack mug --surface-error-mm 0.5 --out mug.csv"
)]
pub struct Args {
    #[command(flatten)]
    object: WhichObject,
    /// Limit the distance between spheres and surface
    #[arg(long, value_name = "MM", help_heading = "Packing")]
    surface_error_mm: f64,
    /// Write the spheres: columns x, y, z, r, metres
    #[arg(long, value_name = "FILE.csv", help_heading = "Output")]
    out: PathBuf,
}

pub fn pack(args: &Args) -> Result<()> {
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
