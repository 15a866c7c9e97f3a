//! Colours of pixels from the hits of rays: light, outlines, and paint.

use super::canvas::{Canvas, Hit};
use super::pixels::halved;
use glam::DVec3;
use rayon::prelude::*;

/// Colour, given by red, green and blue, 0 to 255.
pub type Rgb = [u8; 3];

/// Brightness of pixels where a ray hits nothing, 0 to 255.
pub const BACKGROUND: u8 = 250;

/// Lighting of a surface in a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lighting {
    /// Smoothed normals, which show the shape instead of the single spheres.
    Smoothed,
    /// Exact normals, which show every sphere and every face.
    Plain,
    /// No shading, for colours that represent values.
    Unlit,
}

impl Canvas {
    /// Returns the pixels of the canvas, rows from the top, 3 bytes each. `paint` takes the index of a ray and its hit, and returns the colour of the surface.
    pub fn paint(
        &self,
        hits: &[Option<Hit>],
        lighting: Lighting,
        paint: &(dyn Fn(usize, &Hit) -> Rgb + Sync),
    ) -> Vec<u8> {
        let normals = match lighting {
            Lighting::Smoothed => self.smooth_normals(hits),
            Lighting::Plain | Lighting::Unlit => normals_of(hits),
        };
        let ray = |index: usize| {
            let Some(hit) = &hits[index] else {
                return [BACKGROUND; 3];
            };
            let light = match lighting {
                Lighting::Unlit => 1.0,
                Lighting::Smoothed | Lighting::Plain => lit(normals[index]),
            };
            let outline = if self.is_outline(hits, index, hit) {
                0.45
            } else {
                1.0
            };
            // The conversion limits values above 255 to 255.
            paint(index, hit).map(|value| (f64::from(value) * light * outline).round() as u8)
        };
        let rays: Vec<Rgb> = (0..hits.len()).into_par_iter().map(ray).collect();
        halved(rays.as_flattened(), self.width)
    }

    /// Returns whether the ray is at an inner or outer outline of the object. At an outline, a neighbouring ray hits a point far behind.
    fn is_outline(&self, hits: &[Option<Hit>], index: usize, hit: &Hit) -> bool {
        // A slope of 80° between rays does not count as an outline.
        let step = 8.0 / self.scale;
        let is_behind = |ray: Option<usize>| match ray.and_then(|ray| hits.get(ray)) {
            None => false,
            Some(None) => true,
            Some(Some(other)) => hit.height - other.height > step,
        };
        [1, self.width]
            .into_iter()
            .any(|stride| is_behind(index.checked_sub(stride)) || is_behind(Some(index + stride)))
    }

    /// Returns the surface normals for all rays, averaged over neighbouring rays of similar depth.
    fn smooth_normals(&self, hits: &[Option<Hit>]) -> Vec<DVec3> {
        let reach = (self.width.min(self.height) / 150).max(1);
        let mut normals = normals_of(hits);
        for stride in [1, self.width] {
            let smoothed = |index: usize| {
                let Some(hit) = hits[index] else {
                    return DVec3::ZERO;
                };
                let is_like = |other: &Hit| {
                    (other.height - hit.height).abs() * self.scale < 3.0 * reach as f64
                };
                let before = (1..=reach).filter_map(|n| index.checked_sub(n * stride));
                let after = (0..=reach).map(|n| index + n * stride);
                let near = before.chain(after).filter(|&near| {
                    let other = hits.get(near).and_then(Option::as_ref);
                    other.is_some_and(is_like)
                });
                let sum: DVec3 = near.map(|near| normals[near]).sum();
                sum.normalize_or(hit.normal)
            };
            normals = (0..hits.len()).into_par_iter().map(smoothed).collect();
        }
        normals
    }
}

/// Returns the brightness of a surface with this normal, under a main light and a weaker fill light.
fn lit(normal: DVec3) -> f64 {
    let lamp = DVec3::new(-0.45, 0.65, 0.62).normalize();
    let fill = DVec3::new(0.8, 0.1, 0.6).normalize();
    0.30 + 0.62 * normal.dot(lamp).max(0.0) + 0.16 * normal.dot(fill).max(0.0)
}

fn normals_of(hits: &[Option<Hit>]) -> Vec<DVec3> {
    let normal = |hit: &Option<Hit>| hit.map_or(DVec3::ZERO, |hit| hit.normal);
    hits.iter().map(normal).collect()
}
