//! Picture of a layout: a map of the taxels with their numbers, and an oblique view with their axes.

use crate::error::{Error, Result};
use crate::files::write_bytes;
use crate::report::pictures::{
    Align, Area, Drawing, GRID, INK, LINES, MUTED, PAINT, Point, Rgb, Stroke, TextStyle,
    draw_scale_bar, round_up, text_on,
};
use crate::report::recording::cells::{Cells, typical_spacing, view_from};
use crate::report::recording::{ForceKind, RecordedPatch};
use crate::report::text_width::text_width;
use crate::world::Layout;
use bubbletouch_sim::raster::pixels::CellShape;
use glam::{DMat3, DVec2, DVec3};
use std::path::Path;

/// Side of the oblique view, pixels.
const VIEW: f64 = 420.0;
/// Space between the map and the oblique view, and beside them, pixels.
const GAP: f64 = 40.0;
/// Maximum number of taxels that are drawn. If there are more taxels, every second, third, … taxel is drawn. With a larger number, a file takes megabytes.
const MAX_DRAWN: usize = 20_000;
/// Maximum number of taxel numbers on the map if the taxels are too small to have one number each.
const MAX_NUMBERS: usize = 60;
/// Smallest font size at which a number can be read, pixels.
const MIN_FONT: f64 = 7.0;
/// Colour of the axes of taxels.
const AXIS: Rgb = LINES[1];
/// Colour of taxels whose axes point away from the viewer.
const BEHIND: Rgb = [0xc9, 0xcd, 0xd2];

/// Writes a picture of a layout as `.svg` or `.png`, as the file extension requires. The heading of the picture is `name`.
///
/// The map shows each taxel with its number, from 0. Curved layouts are seen from one or two sides, as in pictures of recordings. The oblique view shows the
/// taxels and their axes in the frame of the layout.
///
/// # Errors
/// If the extension is another one, the picture cannot be rendered, or the file cannot be written.
pub fn write_layout_picture(path: &Path, name: &str, layout: &Layout) -> Result<()> {
    let ending = path.extension().and_then(|ending| ending.to_str());
    match ending.map(str::to_ascii_lowercase).as_deref() {
        Some("svg") => write_bytes(path, layout_drawing(name, layout).svg(name).as_bytes()),
        Some("png") => write_bytes(path, &layout_drawing(name, layout).png()?),
        _ => {
            let allowed = "a name that ends in .svg or .png";
            Err(Error::input(path.display(), "another picture", allowed))
        }
    }
}

/// Draws a layout as [`write_layout_picture`] describes.
pub fn layout_drawing(name: &str, layout: &Layout) -> Drawing {
    let step = layout.n_taxels().div_ceil(MAX_DRAWN);
    let every = |vectors: &[DVec3]| vectors.iter().step_by(step).copied().collect();
    let patch = RecordedPatch {
        centers: every(layout.centers()),
        axes: every(layout.axes()),
        grid: layout.as_grid().filter(|_| step == 1).copied(),
        ..RecordedPatch::empty(name, ForceKind::Normal)
    };
    let cells = Cells::new(&patch);
    let view = Area::new(
        (cells.area.x + cells.area.width + GAP, cells.area.y),
        (VIEW, VIEW),
    );
    let mut sentence = cells.sentence.clone();
    if step > 1 {
        let n_taxels = layout.n_taxels();
        sentence = format!("every {step}th of {n_taxels} taxels; {sentence}");
    }
    let text_right = cells.area.x + text_width(&sentence, 11.0) + GAP;
    let width = (view.x + view.width + 0.5 * GAP).max(text_right);
    let height = cells.area.height.max(view.height) + cells.area.y + 54.0;
    let mut drawing = Drawing::new(width, height);
    let x = cells.area.x;
    drawing.bold_text((x, 22.0), name, TextStyle::new(13));
    let style = TextStyle::new(11).colour(MUTED);
    drawing.text((x, 40.0), &sentence, style);
    draw_map(&mut drawing, &cells, (&patch, step));
    draw_view(&mut drawing, view, &patch);
    drawing
}

/// Draws the map of the taxels; the number of a taxel is its place in the list times `step`.
fn draw_map(drawing: &mut Drawing, cells: &Cells, (patch, step): (&RecordedPatch, usize)) {
    cells.draw_frame(drawing, patch.grid.is_some());
    let n = cells.places.len();
    let largest = (n - 1) * step;
    let room = 1.7 * cells.radius;
    let font = (room / text_width(&largest.to_string(), 1.0)).min(0.9 * cells.radius);
    let has_all = font.min(14.0) >= MIN_FONT && cells.block == 1;
    let every = if has_all {
        1
    } else {
        round_up(n.div_ceil(MAX_NUMBERS) as f64) as usize
    };
    let is_numbered = |taxel: usize| taxel.is_multiple_of(every) && cells.block == 1;
    // Marked taxels are drawn last, so that no other taxel covers them.
    for is_marked in [false, true] {
        let fill = if is_marked { AXIS } else { PAINT };
        for (taxel, place) in cells.places.iter().enumerate() {
            if (is_numbered(taxel) && !has_all) != is_marked {
                continue;
            }
            let (at, radius) = ((place.x, place.y), cells.radius);
            match cells.shape {
                CellShape::Square => {
                    let gap = if radius > 3.0 { 0.92 } else { 1.0 };
                    drawing.area(
                        Area::around(at, (2.0 * gap * radius, 2.0 * gap * radius)),
                        fill,
                    );
                }
                CellShape::Disc if radius > 4.0 => drawing.marker(0, at, radius, fill),
                CellShape::Disc => drawing.disc(at, radius, fill),
            }
        }
    }
    for (taxel, place) in cells.places.iter().enumerate() {
        if !is_numbered(taxel) {
            continue;
        }
        let text = (taxel * step).to_string();
        let (size, colour) = match has_all {
            true => (font.min(14.0), text_on(PAINT)),
            false => (9.0, INK),
        };
        let style = TextStyle::new(size as u32).align(Align::Middle);
        let below = match has_all {
            true => 0.36 * size,
            false => -cells.radius - 2.0,
        };
        drawing.text((place.x, place.y + below), &text, style.colour(colour));
    }
}

/// Draws the taxels and their axes in an oblique view, with the directions of the frame and a scale bar.
fn draw_view(drawing: &mut Drawing, area: Area, patch: &RecordedPatch) {
    let eye = oblique(&patch.axes);
    let seen: Vec<DVec3> = patch.centers.iter().map(|center| eye * *center).collect();
    let spacing = typical_spacing(&patch.centers);
    let tips = patch.axes.iter().map(|axis| eye * *axis * (1.2 * spacing));
    let tips: Vec<DVec3> = seen
        .iter()
        .zip(tips)
        .map(|(center, tip)| center + tip)
        .collect();
    let all = || seen.iter().chain(&tips).map(|place| place.truncate());
    let low = all().fold(DVec2::INFINITY, DVec2::min) - 0.6 * spacing;
    let high = all().fold(DVec2::NEG_INFINITY, DVec2::max) + 0.6 * spacing;
    let size = (high - low).max(DVec2::splat(1e-9));
    let scale = (area.width / size.x).min(area.height / size.y);
    let middle = area.at(0.5, 0.5);
    let at = |place: DVec3| -> Point {
        let offset = scale * (place.truncate() - 0.5 * (low + high));
        (middle.0 + offset.x, middle.1 - offset.y)
    };
    drawing.area(area, GRID);
    let radius = (0.42 * scale * spacing).clamp(1.0, 16.0);
    let mut order: Vec<usize> = (0..seen.len()).collect();
    order.sort_by(|&a, &b| seen[a].z.total_cmp(&seen[b].z));
    for taxel in order {
        let towards = (eye * patch.axes[taxel]).z;
        let (fill, colour) = match towards > 0.0 {
            true => (PAINT, AXIS),
            false => (BEHIND, MUTED),
        };
        let axis = Stroke::new(colour, if radius > 3.0 { 1.4 } else { 0.8 });
        // An axis that points away begins behind its taxel.
        if towards <= 0.0 {
            drawing.line(at(seen[taxel]), at(tips[taxel]), axis);
        }
        drawing.disc(at(seen[taxel]), radius, fill);
        if towards > 0.0 {
            drawing.line(at(seen[taxel]), at(tips[taxel]), axis);
        }
    }
    draw_directions(drawing, (area.x + 34.0, area.y + area.height - 34.0), &eye);
    let below = (area.x + 0.5 * area.width, area.y + area.height + 26.0);
    draw_scale_bar(drawing, below, scale, 0.3 * area.width);
    let style = TextStyle::new(11).colour(MUTED).align(Align::Middle);
    let at = (below.0, area.y - 8.0);
    drawing.text(at, "oblique view with the axes of the taxels", style);
}

/// Draws the directions x, y and z of the frame, around a point.
fn draw_directions(drawing: &mut Drawing, (x, y): Point, eye: &DMat3) {
    for (axis, name) in DVec3::AXES.into_iter().zip(["x", "y", "z"]) {
        let tip = 22.0 * (*eye * axis).truncate();
        drawing.line((x, y), (x + tip.x, y - tip.y), Stroke::new(INK, 1.2));
        let label = 1.35 * tip;
        let style = TextStyle::new(10).align(Align::Middle);
        drawing.text((x + label.x, y - label.y + 3.5), name, style);
    }
}

/// Returns the rotation matrix from the frame of the layout to the axes right, up and towards the viewer. The direction towards the viewer is 40° from the mean
/// axis of the taxels.
fn oblique(axes: &[DVec3]) -> DMat3 {
    let mean = axes.iter().sum::<DVec3>() / axes.len() as f64;
    // If the axes point in all directions, z is up and the view is from −y.
    let front = if mean.length() > 0.2 {
        mean.normalize()
    } else {
        DVec3::NEG_Y
    };
    let (sin, cos) = 40f64.to_radians().sin_cos();
    // Horizontal skins are drawn from a viewpoint below on the page, vertical skins from above.
    let above = if front.z.abs() > 0.7 { -0.84 } else { 0.84 };
    let upright = view_from(front);
    let aside = (0.55 * upright.row(0) + above * upright.row(1)).normalize();
    view_from(cos * front + sin * aside)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::Grid;

    fn texts(layout: &Layout) -> String {
        layout_drawing("skin", layout).svg("skin")
    }

    #[test]
    fn each_taxel_of_a_small_layout_has_a_disc_its_number_and_an_axis() {
        let cap = Layout::sphere_cap(9e-3, 1.4, 2e-3).unwrap();
        let n = cap.n_taxels();
        let svg = texts(&cap);
        // A disc on the map with its rim, and a disc in the oblique view.
        assert_eq!(svg.matches("<circle").count(), 3 * n);
        for taxel in 0..n {
            assert!(svg.contains(&format!(">{taxel}</text>")), "{taxel}");
        }
        assert!(svg.contains("seen from"));
        assert_eq!(svg, texts(&cap));
    }

    #[test]
    fn large_layouts_have_few_numbers_and_few_elements() {
        for (nx, ny) in [(64, 64), (500, 400)] {
            let grid = Grid {
                nx,
                ny,
                pitch: 1e-3,
            };
            let layout = Layout::grid(&grid).unwrap();
            let drawing = layout_drawing("skin", &layout);
            let svg = drawing.svg("skin");
            assert!(svg.matches("</text>").count() < 100, "{nx}");
            assert!(svg.len() < 8_000_000, "{} bytes", svg.len());
        }
    }

    #[test]
    fn a_picture_is_svg_or_png() {
        let folder = tempfile::tempdir().unwrap();
        let layout = Layout::new(vec![DVec3::ZERO], vec![DVec3::NEG_Z]).unwrap();
        for (name, start) in [("a.svg", &b"<"[..]), ("a.PNG", b"\x89PNG")] {
            let path = folder.path().join(name);
            write_layout_picture(&path, "one", &layout).unwrap();
            assert!(std::fs::read(&path).unwrap().starts_with(start));
        }
        let error = write_layout_picture(&folder.path().join("a.pdf"), "one", &layout);
        assert!(
            error
                .unwrap_err()
                .to_string()
                .contains("a name that ends in .svg or .png")
        );
    }
}
