//! `bubbletouch layout`: describes a layout file, draws it, and writes it in another format.

use crate::command::terminal::{note, say};
use bubbletouch::Result;
use bubbletouch::geometry::Aabb;
use bubbletouch::inputs::layout_file::{LayoutFile, LayoutFormat, LayoutOptions};
use bubbletouch::inputs::object_files::read_surface;
use bubbletouch::mesh::{LengthUnit, SizeLimits};
use bubbletouch::report::layout_picture::write_layout_picture;
use glam::DVec3;
use std::path::PathBuf;

/// Describe, draw and convert a file of taxel positions and normals
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  bubbletouch layout objects/skins/fingertip.csv --out fingertip.svg"
)]
pub struct Args {
    /// Layout: .csv, .npz, .txt or .ini (iCub), .json (PaXini) or .urdf
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Take the normals from the surface of this mesh
    #[arg(long, value_name = "FILE", help_heading = "Input")]
    mesh: Option<PathBuf>,
    /// Set the unit of --mesh: m, cm, mm or in [default: m]
    #[arg(long, value_name = "UNIT", requires = "mesh", help_heading = "Input")]
    mesh_unit: Option<LengthUnit>,
    /// Set the unit of the file: m, cm, mm or in
    #[arg(long, value_name = "UNIT", help_heading = "Input")]
    unit: Option<LengthUnit>,
    /// Read the sensor of this name in a robot's file
    #[arg(long, value_name = "NAME", help_heading = "Input")]
    sensor: Option<String>,
    /// Draw to .svg or .png, or write a layout file
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    out: Option<PathBuf>,
    /// Write csv, npz, dex-01, icub, paxini or urdf [default: by extension]
    #[arg(long, value_name = "FORMAT", requires = "out", help_heading = "Output")]
    format: Option<LayoutFormat>,
}

pub fn layout(args: &Args) -> Result<()> {
    let sizes = SizeLimits {
        option: "--mesh-unit",
        ..SizeLimits::ANY
    };
    let mesh = args.mesh.as_ref();
    let mesh = mesh.map(|path| read_surface(path, args.mesh_unit, &sizes));
    let mesh = mesh.transpose()?;
    let options = LayoutOptions {
        mesh: mesh.as_ref(),
        unit: args.unit,
        sensor: args.sensor.as_deref(),
    };
    let file = LayoutFile::read(&args.file, options)?;
    file.notes.iter().for_each(note);
    if let Some(out) = &args.out {
        let ending = out.extension().and_then(|ending| ending.to_str());
        let is_picture =
            ending.is_some_and(|ending| ["svg", "png"].contains(&&ending.to_ascii_lowercase()[..]));
        match is_picture && args.format.is_none() {
            true => {
                let name = args.file.file_stem().unwrap_or_default().to_string_lossy();
                write_layout_picture(out, &name, &file.layout)?;
            }
            false => file.write(out, args.format)?.iter().for_each(note),
        }
    }
    describe(&file)
}

fn describe(file: &LayoutFile) -> Result<()> {
    let layout = &file.layout;
    let points = layout.centers().iter().map(|&point| Aabb {
        min: point,
        max: point,
    });
    let size = 1e3 * Aabb::around(points).map_or(DVec3::ZERO, |bounds| bounds.size());
    say(format_args!(
        "{} taxels within {:.1} × {:.1} × {:.1} mm",
        layout.n_taxels(),
        size.x,
        size.y,
        size.z
    ))?;
    say(match &file.radii {
        Some(radii) => {
            let least = 1e3 * radii.iter().copied().fold(f64::INFINITY, f64::min);
            let largest = 1e3 * radii.iter().copied().fold(0.0, f64::max);
            match least == largest {
                true => format!("radius {least:.3} mm"),
                false => format!("radii {least:.3} to {largest:.3} mm"),
            }
        }
        None => {
            let radius = 1e3 * file.default_radius();
            format!("no radii; by default {radius:.3} mm, half the distance between neighbours")
        }
    })?;
    match (layout.sides(), file.image()) {
        (Some([rows, columns]), _) => say(format_args!("image of {rows} × {columns} pixels"))?,
        (None, Some(pixels)) => {
            let sides = [0, 1].map(|side| pixels.iter().map(move |pixel| pixel[side] + 1));
            let [rows, columns] = sides.map(|side| side.max().unwrap_or_default());
            say(format_args!(
                "image of {rows} × {columns} pixels, of which {} are taxels",
                pixels.len()
            ))?;
        }
        (None, None) => {}
    }
    match &file.link {
        Some(link) => say(format_args!("in the frame of link `{link}`")),
        None => Ok(()),
    }
}
