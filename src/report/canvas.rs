//! The rays of a picture: what they meet of spheres or of another surface, and the shadow on the floor.

use crate::objects::Sphere;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Brightness of the floor and of blank paper, 0 to 255.
pub(crate) const BACKGROUND: u8 = 250;

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

/// Axes of the picture in the object's frame.
pub(crate) struct View {
    pub right: DVec3,
    pub up: DVec3,
    pub towards_eye: DVec3,
}

impl View {
    /// The eye stands before the object (−y), 30° to the right of it and 38° up.
    pub fn three_quarter() -> Self {
        Self::from_angles(30f64.to_radians(), 38f64.to_radians())
    }

    /// The eye stands before the object (−y), so many radians to the right of it and up.
    pub fn from_angles(azimuth: f64, elevation: f64) -> Self {
        let right = DVec3::new(azimuth.cos(), azimuth.sin(), 0.0);
        let back = DVec3::new(azimuth.sin(), -azimuth.cos(), 0.0);
        let towards_eye = elevation.cos() * back + elevation.sin() * DVec3::Z;
        Self {
            right,
            up: towards_eye.cross(right),
            towards_eye,
        }
    }

    pub fn project(&self, point: DVec3) -> DVec2 {
        DVec2::new(point.dot(self.right), point.dot(self.up))
    }
}

pub(crate) fn extent(view: &View, spheres: &[Sphere]) -> (DVec2, DVec2) {
    let mut low = DVec2::MAX;
    let mut high = DVec2::MIN;
    for sphere in spheres {
        let center = view.project(sphere.center);
        low = low.min(center - sphere.radius);
        high = high.max(center + sphere.radius);
    }
    (low, high)
}

/// The supersampled tile.
pub(crate) struct Canvas {
    pub width: usize,
    pub height: usize,
    /// Rays a metre.
    pub scale: f64,
    /// The point of the view's plane in the middle of the tile.
    pub middle: DVec2,
    pub view: View,
}

impl Canvas {
    fn column_row(&self, point: DVec2) -> DVec2 {
        let offset = (point - self.middle) * self.scale;
        DVec2::new(
            0.5 * self.width as f64 + offset.x,
            0.5 * self.height as f64 - offset.y,
        )
    }

    /// Calls `visit(index, offset from the centre in radii)` for each ray inside an upright ellipse.
    fn each_ray(&self, center: DVec2, radii: DVec2, mut visit: impl FnMut(usize, DVec2)) {
        let middle = self.column_row(center);
        let radii = radii * self.scale;
        let range = |middle: f64, radius: f64, n: usize| {
            let first = (middle - radius).floor().clamp(0.0, n as f64) as usize;
            first..(middle + radius).ceil().clamp(0.0, n as f64) as usize
        };
        for row in range(middle.y, radii.y, self.height) {
            for column in range(middle.x, radii.x, self.width) {
                let at = DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
                let offset = (at - middle) / radii;
                if offset.length_squared() <= 1.0 {
                    visit(row * self.width + column, offset);
                }
            }
        }
    }

    /// What the rays meet of spheres.
    pub fn hits(&self, spheres: &[Sphere]) -> Vec<Option<Hit>> {
        let mut hits: Vec<Option<Hit>> = vec![None; self.width * self.height];
        for (part, sphere) in spheres.iter().enumerate() {
            let height = sphere.center.dot(self.view.towards_eye);
            let center = self.view.project(sphere.center);
            self.each_ray(center, DVec2::splat(sphere.radius), |index, offset| {
                let forward = (1.0 - offset.length_squared()).sqrt();
                let height = height + sphere.radius * forward;
                if hits[index].is_none_or(|hit| hit.height < height) {
                    let normal = DVec3::new(offset.x, -offset.y, forward);
                    hits[index] = Some(Hit {
                        height,
                        normal,
                        part,
                    });
                }
            });
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
        let View {
            right,
            up,
            towards_eye,
        } = self.view;
        let start = middle.dot(towards_eye) + radius;
        let ray = |index: usize| {
            let (point, normal) = first_hit(self.point(index, start), -towards_eye)?;
            Some(Hit {
                height: point.dot(towards_eye),
                normal: DVec3::new(normal.dot(right), normal.dot(up), normal.dot(towards_eye)),
                part: 0,
            })
        };
        (0..self.width * self.height)
            .into_par_iter()
            .map(ray)
            .collect()
    }

    /// A value of the point that each ray met (metres, frame of the object); 0 where it met nothing.
    pub fn values(&self, hits: &[Option<Hit>], value: impl Fn(DVec3) -> f64 + Sync) -> Vec<f64> {
        let of_ray = |(index, hit): (usize, &Option<Hit>)| {
            let point = hit.as_ref().map(|hit| self.point(index, hit.height));
            point.map_or(0.0, &value)
        };
        hits.par_iter().enumerate().map(of_ray).collect()
    }

    /// The point of a ray at a height towards the eye, in the frame of the object.
    pub fn point(&self, index: usize, height: f64) -> DVec3 {
        let ray = DVec2::new(
            (index % self.width) as f64 + 0.5 - 0.5 * self.width as f64,
            0.5 * self.height as f64 - (index / self.width) as f64 - 0.5,
        );
        let place = self.middle + ray / self.scale;
        place.x * self.view.right + place.y * self.view.up + height * self.view.towards_eye
    }

    /// Darkness of the floor z = lowest point, 0 to 1, under a wide lamp that stands left and above.
    pub fn shadow(&self, spheres: &[Sphere]) -> Vec<f32> {
        let lowest = spheres.iter().map(|s| s.center.z - s.radius);
        let floor = lowest.fold(f64::INFINITY, f64::min);
        let mut dark = vec![0f32; self.width * self.height];
        let foreshortening = self.view.towards_eye.z;
        for sphere in spheres {
            let height = sphere.center.z - floor;
            let slant = DVec3::new(0.22, 0.16, -1.0);
            let center = self.view.project(sphere.center + height * slant);
            let radii = sphere.radius * DVec2::new(1.0, foreshortening);
            self.each_ray(center, radii, |index, _| dark[index] = 1.0);
        }
        let blur = (self.width.min(self.height) / 40).max(2);
        for _ in 0..2 {
            dark = box_blur(&dark, self.width, blur);
        }
        dark
    }
}

/// Mean over a square of side 2 · reach + 1; outside counts as 0.
fn box_blur(values: &[f32], width: usize, reach: usize) -> Vec<f32> {
    let height = values.len() / width;
    let along = |values: &[f32], n: usize, stride: usize, start: usize| -> Vec<f32> {
        let mut sums = Vec::with_capacity(n + 1);
        let mut sum = 0.0;
        sums.push(sum);
        for i in 0..n {
            sum += values[start + i * stride];
            sums.push(sum);
        }
        (0..n)
            .map(|i| {
                let (first, last) = (i.saturating_sub(reach), (i + reach + 1).min(n));
                (sums[last] - sums[first]) / (2 * reach + 1) as f32
            })
            .collect()
    };
    let mut rows = Vec::with_capacity(values.len());
    for row in 0..height {
        rows.extend(along(values, width, 1, row * width));
    }
    let mut blurred = vec![0.0; values.len()];
    for column in 0..width {
        for (row, value) in along(&rows, height, width, column).into_iter().enumerate() {
            blurred[row * width + column] = value;
        }
    }
    blurred
}
