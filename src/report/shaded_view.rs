//! Objects drawn for the eye: orthographic, softly lit, with outlines and a shadow on the floor.

use super::canvas::{BACKGROUND, Canvas, Hit, View, extent};
use crate::objects::Sphere;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Rays a pixel, each way.
const SUPERSAMPLING: usize = 2;

/// Slate blue, for objects without colours of their own.
pub(crate) const PAINT: [u8; 3] = [142, 178, 214];

/// What light makes of a surface.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Lighting {
    /// Bumps are smoothed away, so that the eye sees the shape and not its spheres.
    Smoothed,
    /// Every sphere and every face shows.
    Plain,
    /// Paint as it is: colours mean values.
    Unlit,
}

/// Floor, lamp and eye set up around an object.
pub(crate) struct Stage {
    pub canvas: Canvas,
    shadow: Vec<f32>,
    /// Scale of the picture.
    pub pixels_per_metre: f64,
}

/// An object as it is seen and lit, pixel by pixel.
pub(crate) struct ShadedView {
    /// Rays a row.
    width: usize,
    rays: Vec<Ray>,
}

/// What a ray brings back.
struct Ray {
    light: f64,
    paint: [u8; 3],
}

impl Stage {
    /// The spheres in the middle of width × height pixels, as large as `room` (pixels each way) allows.
    pub fn new(spheres: &[Sphere], size: [usize; 2], room: DVec2) -> Self {
        Self::seen(View::three_quarter(), spheres, size, room)
    }

    /// The same, seen from elsewhere.
    pub fn seen(view: View, spheres: &[Sphere], [width, height]: [usize; 2], room: DVec2) -> Self {
        let (low, high) = extent(&view, spheres);
        let pixels_per_metre = (room / (high - low)).min_element();
        let canvas = Canvas {
            width: width * SUPERSAMPLING,
            height: height * SUPERSAMPLING,
            scale: pixels_per_metre * SUPERSAMPLING as f64,
            middle: 0.5 * (low + high),
            view,
        };
        Self {
            shadow: canvas.shadow(spheres),
            canvas,
            pixels_per_metre,
        }
    }

    /// What the rays met, painted ray by ray.
    pub fn view(
        &self,
        hits: &[Option<Hit>],
        lighting: Lighting,
        paint: impl Fn(usize) -> [u8; 3] + Sync,
    ) -> ShadedView {
        let canvas = &self.canvas;
        let normals = match lighting {
            Lighting::Smoothed => canvas.smooth_normals(hits),
            Lighting::Plain | Lighting::Unlit => normals_of(hits),
        };
        let ray = |index: usize| match &hits[index] {
            None => Ray {
                light: 1.0 - 0.20 * f64::from(self.shadow[index]),
                paint: [BACKGROUND; 3],
            },
            Some(hit) => {
                let light = match lighting {
                    Lighting::Unlit => 1.0,
                    Lighting::Smoothed | Lighting::Plain => lit(normals[index]),
                };
                Ray {
                    light: light * (1.0 - 0.55 * canvas.step_down(hits, index, hit)),
                    paint: paint(index),
                }
            }
        };
        ShadedView {
            width: canvas.width,
            rays: (0..hits.len()).into_par_iter().map(ray).collect(),
        }
    }
}

/// Brightness under a lamp and a weaker one that fills the shades.
fn lit(normal: DVec3) -> f64 {
    let lamp = DVec3::new(-0.45, 0.65, 0.62).normalize();
    let fill = DVec3::new(0.8, 0.1, 0.6).normalize();
    0.30 + 0.62 * normal.dot(lamp).max(0.0) + 0.16 * normal.dot(fill).max(0.0)
}

fn normals_of(hits: &[Option<Hit>]) -> Vec<DVec3> {
    let normal = |hit: &Option<Hit>| hit.map_or(DVec3::ZERO, |hit| hit.normal);
    hits.iter().map(normal).collect()
}

impl ShadedView {
    /// Red, green, blue of a pixel, row 0 at the top.
    pub fn rgb(&self, x: usize, y: usize) -> [u8; 3] {
        let mut sum = [0.0; 3];
        for row in y * SUPERSAMPLING..(y + 1) * SUPERSAMPLING {
            for column in x * SUPERSAMPLING..(x + 1) * SUPERSAMPLING {
                let ray = &self.rays[row * self.width + column];
                for (total, paint) in sum.iter_mut().zip(ray.paint) {
                    *total += (f64::from(paint) * ray.light).min(255.0);
                }
            }
        }
        sum.map(|total| (total / (SUPERSAMPLING * SUPERSAMPLING) as f64).round() as u8)
    }
}

impl Canvas {
    /// 1 where a neighbouring ray sees something far behind this one: the object's inner and outer outlines.
    fn step_down(&self, hits: &[Option<Hit>], index: usize, hit: &Hit) -> f64 {
        // A slope of 80° between rays is not yet a step.
        let step = 8.0 / self.scale;
        let neighbours = [1, self.width].into_iter().flat_map(|d| {
            let before = index.checked_sub(d);
            let after = Some(index + d).filter(|&i| i < hits.len());
            [before, after]
        });
        let behind = neighbours.flatten().any(|i| match hits[i] {
            None => true,
            Some(other) => hit.height - other.height > step,
        });
        f64::from(u8::from(behind))
    }

    /// Normals averaged over neighbours at like depth, so that the eye sees the shape and not its spheres.
    fn smooth_normals(&self, hits: &[Option<Hit>]) -> Vec<DVec3> {
        let reach = (self.width.min(self.height) / 150).max(1) as isize;
        let mut normals = normals_of(hits);
        for stride in [1, self.width as isize] {
            normals = (0..hits.len())
                .map(|index| {
                    let Some(hit) = hits[index] else {
                        return DVec3::ZERO;
                    };
                    let mut sum = DVec3::ZERO;
                    for k in -reach..=reach {
                        let near = index as isize + k * stride;
                        let Some(Some(other)) = usize::try_from(near)
                            .ok()
                            .map(|i| hits.get(i).copied().flatten())
                        else {
                            continue;
                        };
                        if (other.height - hit.height).abs() * self.scale < 3.0 * (reach as f64) {
                            sum += normals[near as usize];
                        }
                    }
                    sum.normalize_or(hit.normal)
                })
                .collect();
        }
        normals
    }
}
