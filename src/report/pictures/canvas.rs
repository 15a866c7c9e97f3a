//! The rays of a picture, and what they meet of spheres or of another surface.

use crate::objects::Sphere;
use glam::{DMat3, DVec2, DVec3};
use rayon::prelude::*;

/// Rays a pixel, each way: a picture of rays is halved.
const SUPERSAMPLING: usize = 2;

/// What a ray of the picture meets first.
#[derive(Clone, Copy)]
pub(crate) struct Hit {
    /// Towards the eye, metres.
    pub height: f64,
    /// In the frame of the picture: right, up, towards the eye.
    pub normal: DVec3,
    /// Which of the spheres; 0 of another surface.
    pub part: usize,
}

/// Right, up and towards the eye, in the object's frame: the eye stands before the object (−y), 30° to the right of it and 38° up.
pub(crate) fn three_quarter_view() -> DMat3 {
    view_from(30f64.to_radians(), 38f64.to_radians())
}

/// The same from so many radians to the right of the object and up.
pub(crate) fn view_from(azimuth: f64, elevation: f64) -> DMat3 {
    let right = DVec3::new(azimuth.cos(), azimuth.sin(), 0.0);
    let back = DVec3::new(azimuth.sin(), -azimuth.cos(), 0.0);
    let towards_eye = elevation.cos() * back + elevation.sin() * DVec3::Z;
    DMat3::from_cols(right, towards_eye.cross(right), towards_eye)
}

/// A supersampled part of a picture that shows an object.
pub(crate) struct Canvas {
    /// Rays a row.
    pub width: usize,
    /// Rays a column.
    pub height: usize,
    /// Rays a metre.
    pub scale: f64,
    /// The point of the view's plane in the middle.
    middle: DVec2,
    /// Object from picture: right, up, towards the eye.
    view: DMat3,
}

impl Canvas {
    /// Spheres in the middle of width × height pixels, as large as `room` (pixels each way) allows.
    pub fn new(view: DMat3, spheres: &[Sphere], [width, height]: [usize; 2], room: DVec2) -> Self {
        let (mut low, mut high) = (DVec2::MAX, DVec2::MIN);
        for sphere in spheres {
            let center = view.transpose_mul_vec3(sphere.center).truncate();
            low = low.min(center - sphere.radius);
            high = high.max(center + sphere.radius);
        }
        Self {
            width: width * SUPERSAMPLING,
            height: height * SUPERSAMPLING,
            scale: (room / (high - low)).min_element() * SUPERSAMPLING as f64,
            middle: 0.5 * (low + high),
            view,
        }
    }

    /// The scale of the picture.
    pub fn pixels_per_metre(&self) -> f64 {
        self.scale / SUPERSAMPLING as f64
    }

    /// What the rays meet of spheres.
    pub fn hits(&self, spheres: &[Sphere]) -> Vec<Option<Hit>> {
        let mut hits: Vec<Option<Hit>> = vec![None; self.width * self.height];
        let size = DVec2::new(self.width as f64, self.height as f64);
        for (part, sphere) in spheres.iter().enumerate() {
            let center = self.view.transpose_mul_vec3(sphere.center);
            let offset = (center.truncate() - self.middle) * self.scale;
            let middle = 0.5 * size + DVec2::new(offset.x, -offset.y);
            let radius = sphere.radius * self.scale;
            let first = (middle - radius).floor().clamp(DVec2::ZERO, size);
            let last = (middle + radius).ceil().clamp(DVec2::ZERO, size);
            for row in first.y as usize..last.y as usize {
                for column in first.x as usize..last.x as usize {
                    let at = DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
                    let offset = (at - middle) / radius;
                    let forward = (1.0 - offset.length_squared()).sqrt();
                    let height = center.z + sphere.radius * forward;
                    let hit = &mut hits[row * self.width + column];
                    // Beside the sphere the height is NaN, which is above nothing.
                    if height > hit.map_or(f64::NEG_INFINITY, |hit| hit.height) {
                        *hit = Some(Hit {
                            height,
                            normal: DVec3::new(offset.x, -offset.y, forward),
                            part,
                        });
                    }
                }
            }
        }
        hits
    }

    /// What the rays meet of a surface, given by where a ray from a point meets it and its outward unit normal there
    /// (metres, frame of the object).
    ///
    /// Rays start outside `radius`, which is that of a ball about `middle` that holds the object.
    pub fn cast(
        &self,
        first_hit: impl Fn(DVec3, DVec3) -> Option<(DVec3, DVec3)> + Sync,
        middle: DVec3,
        radius: f64,
    ) -> Vec<Option<Hit>> {
        let towards_eye = self.view.z_axis;
        let start = middle.dot(towards_eye) + radius;
        let ray = |index: usize| {
            let (point, normal) = first_hit(self.point(index, start), -towards_eye)?;
            Some(Hit {
                height: point.dot(towards_eye),
                normal: self.view.transpose_mul_vec3(normal),
                part: 0,
            })
        };
        let rays = (0..self.width * self.height).into_par_iter();
        rays.map(ray).collect()
    }

    /// The point of a ray at a height towards the eye, in the frame of the object.
    pub fn point(&self, index: usize, height: f64) -> DVec3 {
        let ray = DVec2::new(
            (index % self.width) as f64 + 0.5 - 0.5 * self.width as f64,
            0.5 * self.height as f64 - (index / self.width) as f64 - 0.5,
        );
        let place = self.middle + ray / self.scale;
        self.view * place.extend(height)
    }
}
