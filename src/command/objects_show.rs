//! `bubbletouch objects show`: draws an object, its spheres, and the error between them in three panels.

use crate::command::options::unused::check_used;
use crate::command::options::which_object::WhichObject;
use crate::command::terminal::output::check_ending;
use bubbletouch::Result;
use bubbletouch::files::write_bytes;
use bubbletouch::mesh::{LengthUnit, SizeLimits};
use bubbletouch::report::fit_picture::fit_picture;
use bubbletouch::study::load_spheres;
use std::path::PathBuf;

/// Draw an object, its spheres and the error between them
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  bubbletouch objects show mug --surface-error-mm 0.5 --out fit.png"
)]
pub struct Args {
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

pub fn show(args: &Args) -> Result<()> {
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
