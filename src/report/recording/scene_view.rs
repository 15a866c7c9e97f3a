//! View of a recorded scene in a film: the skin of all patches and the objects, shaded, and a strip with the total force over time.

use super::cells::Cells;
use super::reader::RecordingFile;
use crate::error::Result;
use crate::geometry::Pose;
use crate::objects::{Model, Sphere};
use crate::report::pictures::{
    Area, ColourScale, Drawing, INK, LINES, PAINT, Picture, Point, Side, Stroke, draw_axis,
};
use crate::signal::Quantity;
use bubbletouch_sim::raster::{Canvas, Hit, Lighting, Rgb, three_quarter_view};
use glam::{DVec2, DVec3};

/// Side of the view, pixels of the film.
const VIEW: usize = 640;
/// Height of the strip, pixels of a drawing; the film has two pixels for each.
const STRIP: f64 = 108.0;
/// Number of points along the largest side of a mesh by which the view shows the mesh. With fewer points, its faces look rough; with more, films take longer.
const MESH_POINTS: f64 = 80.0;
/// Colour of the skin of other patches than the shown one.
const BARE: Rgb = [226, 214, 200];

/// Scene of a recording around one patch.
pub(super) struct SceneView {
    canvas: Canvas,
    patch: usize,
    /// Taxels of each patch in its frame, and parts of each object in its frame; each set with the name of its poses.
    bodies: Vec<(String, Vec<Sphere>)>,
    /// Strip without the mark of the time, and the area of its graph in pixels of the film.
    strip: (Picture, Area),
    ends: (f64, f64),
}

impl SceneView {
    /// Prepares the view of a scene whose film is `width` pixels wide without it. Objects without a model are not shown.
    ///
    /// # Errors
    /// If the recording cannot be read, or the strip cannot be rendered.
    pub fn new(
        recording: &mut RecordingFile,
        patch: usize,
        models: &[(String, Model)],
        width: usize,
    ) -> Result<Self> {
        let skins = recording.header().patches.iter().map(|patch| {
            let cells = Cells::new(patch);
            let radius = 1.2 * cells.radius / cells.pixels_per_metre;
            let taxel = |&center| Sphere { center, radius };
            (
                patch.name.clone(),
                patch.centers.iter().map(taxel).collect(),
            )
        });
        let objects = models
            .iter()
            .filter(|(name, _)| recording.header().objects.contains(name));
        let objects = objects.map(|(name, model)| (name.clone(), parts(model)));
        let bodies: Vec<(String, Vec<Sphere>)> = skins.chain(objects).collect();
        let n_frames = recording.time().len();
        let mut all = Vec::new();
        for frame in [0, n_frames / 2, n_frames - 1] {
            all.extend(spheres(&bodies, recording, frame)?);
        }
        let room = DVec2::splat(0.9 * VIEW as f64);
        let mut force = Vec::new();
        recording.each_frame(patch, Quantity::Force, |_, forces| {
            force.push(forces.iter().sum())
        })?;
        let time = recording.time();
        Ok(Self {
            canvas: Canvas::new(three_quarter_view(), &all, [VIEW; 2], room),
            patch,
            bodies,
            strip: strip(time, &force, 0.5 * (width + VIEW) as f64)?,
            ends: (time[0], time[n_frames - 1]),
        })
    }

    /// Returns a frame of the film: the picture of the skin, the scene beside it, and the strip below with a mark at the time of the frame.
    ///
    /// # Errors
    /// If the recording cannot be read.
    pub fn beside(
        &self,
        skin: &Picture,
        (recording, frame): (&mut RecordingFile, usize),
        (values, scale): (&[f64], ColourScale),
    ) -> Result<Picture> {
        let height = skin.height.max(VIEW);
        let (strip, area) = &self.strip;
        let mut film = Picture::blank(skin.width + VIEW, height + strip.height)?;
        film.rgb.fill(u8::MAX);
        film.paste(skin, [0, 0]);
        let n_parts = |n_bodies: usize| -> usize {
            let bodies = self.bodies[..n_bodies].iter();
            bodies.map(|(_, parts)| parts.len()).sum()
        };
        let first = n_parts(self.patch);
        let n_skin = n_parts(recording.header().patches.len());
        let colour = |_: usize, hit: &Hit| match hit.part.checked_sub(first) {
            Some(taxel) if taxel < values.len() => scale.colour(values[taxel]),
            _ if hit.part < n_skin => BARE,
            _ => PAINT,
        };
        let hits = self.canvas.hits(&spheres(&self.bodies, recording, frame)?);
        let corner = [skin.width, 0];
        film.paint(&self.canvas, corner, &hits, Lighting::Smoothed, &colour);
        film.paste(strip, [0, height]);
        let (first, last) = self.ends;
        let part = (recording.time()[frame] - first) / (last - first).max(f64::MIN_POSITIVE);
        let column = (area.x + part * area.width) as usize;
        for row in height + area.y as usize..height + (area.y + area.height) as usize {
            let pixel = 3 * (row * film.width + column);
            film.rgb[pixel..pixel + 6].copy_from_slice([INK; 2].as_flattened());
        }
        Ok(film)
    }
}

/// Returns the spheres of all bodies at their poses in a frame, in the world frame.
fn spheres(
    bodies: &[(String, Vec<Sphere>)],
    recording: &mut RecordingFile,
    frame: usize,
) -> Result<Vec<Sphere>> {
    let mut all = Vec::new();
    for (name, parts) in bodies {
        let pose: Pose = recording.pose(name, frame)?;
        all.extend(parts.iter().map(|part| Sphere {
            center: pose.transform_point(part.center),
            ..*part
        }));
    }
    Ok(all)
}

/// Returns the spheres of a model; for a mesh, small spheres along its triangles.
fn parts(model: &Model) -> Vec<Sphere> {
    let Model::Mesh(model) = model else {
        return model
            .spheres()
            .map_or(Vec::new(), |union| union.spheres().to_vec());
    };
    let mesh = model.mesh();
    let radius = mesh.bounds().size().max_element() / MESH_POINTS;
    let of_triangle = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|corner| mesh.vertices()[corner as usize]);
        let n = (a.distance(b).max(a.distance(c)).max(b.distance(c)) / radius).ceil();
        let steps = 0..=n as usize;
        let place = move |i: usize, j: usize| a + (i as f64 * (b - a) + j as f64 * (c - a)) / n;
        let centers = steps.flat_map(move |i| (0..=n as usize - i).map(move |j| place(i, j)));
        centers
            .map(move |center: DVec3| Sphere { center, radius })
            .collect::<Vec<_>>()
    };
    mesh.triangles().iter().flat_map(of_triangle).collect()
}

/// Draws the total force over time in a strip of the given width; returns the picture and the area of its graph, pixels.
fn strip(time: &[f64], force: &[f64], width: f64) -> Result<(Picture, Area)> {
    let mut drawing = Drawing::new(width, STRIP);
    let area = Area::new((70.0, 10.0), (width - 100.0, STRIP - 54.0));
    let most = force.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let (first, last) = (
        time[0],
        time[time.len() - 1].max(time[0] + f64::MIN_POSITIVE),
    );
    let at = |(time, force): (&f64, &f64)| area.at((time - first) / (last - first), force / most);
    let line: Vec<Point> = time.iter().zip(force).map(at).collect();
    draw_axis(&mut drawing, area, Side::Below, (first, last), "time (s)");
    draw_axis(&mut drawing, area, Side::Left, (0.0, most), "force (N)");
    drawing.frame(area, Stroke::new(INK, 1.0));
    drawing.polyline(&line, Stroke::new(LINES[0], 2.0));
    let picture = drawing.picture()?;
    let fine = picture.width as f64 / width;
    let [x, y, width, height] = [area.x, area.y, area.width, area.height].map(|side| fine * side);
    Ok((picture, Area::new((x, y), (width, height))))
}
