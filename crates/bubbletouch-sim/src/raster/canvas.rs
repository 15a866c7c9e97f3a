//! Ray casting: the rays of a picture, and their first intersections with spheres or another surface.

use crate::objects::Sphere;
use glam::{DMat3, DVec2, DVec3};
use rayon::prelude::*;

/// Number of rays per pixel along each side of the pixel. The supersampled picture is scaled down by this factor.
const SUPERSAMPLING: usize = 2;

/// First intersection of a ray with a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Coordinate of the intersection towards the viewer, metres.
    pub height: f64,
    /// Unit normal of the surface at the intersection, in the picture frame: right, up, towards the viewer.
    pub normal: DVec3,
    /// Index of the sphere that the ray hits; 0 for another surface.
    pub part: usize,
}

/// Returns the axes right, up and towards the viewer, in the object frame. The viewer is in front of the object (−y), 30° to the right and 38° up.
pub fn three_quarter_view() -> DMat3 {
    view_from(30f64.to_radians(), 38f64.to_radians())
}

/// Returns the axes right, up and towards the viewer. The viewer is in front of the object (−y), turned by the angles `azimuth` and `elevation`, radians.
pub fn view_from(azimuth: f64, elevation: f64) -> DMat3 {
    let right = DVec3::new(azimuth.cos(), azimuth.sin(), 0.0);
    let back = DVec3::new(azimuth.sin(), -azimuth.cos(), 0.0);
    let towards_eye = elevation.cos() * back + elevation.sin() * DVec3::Z;
    DMat3::from_cols(right, towards_eye.cross(right), towards_eye)
}

/// Function from the start and the direction of a ray to the hit point and the outward unit normal (metres, object frame). The result is `None` if the ray
/// hits nothing.
pub type SurfaceHit<'a> = dyn Fn(DVec3, DVec3) -> Option<(DVec3, DVec3)> + Sync + 'a;

/// Supersampled part of a picture that shows an object.
#[derive(Clone, Debug)]
pub struct Canvas {
    /// Number of rays in a row.
    pub width: usize,
    /// Number of rays in a column.
    pub height: usize,
    /// Number of rays per metre of the view plane.
    pub scale: f64,
    /// Centre of the canvas in the view plane, metres.
    middle: DVec2,
    /// Rotation from the picture frame (right, up, towards the viewer) to the object frame.
    view: DMat3,
}

impl Canvas {
    /// Creates a canvas of width × height pixels with the spheres in the middle, as large as `room` (width and height, pixels) allows.
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

    /// Returns the number of picture pixels per metre.
    pub fn pixels_per_metre(&self) -> f64 {
        self.scale / SUPERSAMPLING as f64
    }

    /// Returns the first intersection of each ray with the spheres; `None` for a ray that hits nothing.
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
                    // Outside the sphere, the height is NaN, and the comparison is false.
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

    /// Returns the first intersections of all rays with a surface, which is given by the function `first_hit`.
    ///
    /// Each ray starts outside the ball with the centre `middle` and the radius `radius`, metres, which must contain the object.
    pub fn cast(&self, first_hit: &SurfaceHit<'_>, middle: DVec3, radius: f64) -> Vec<Option<Hit>> {
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

    /// Returns the point on the ray with the given index whose coordinate towards the viewer is `height`, in the object frame.
    pub fn point(&self, index: usize, height: f64) -> DVec3 {
        let ray = DVec2::new(
            (index % self.width) as f64 + 0.5 - 0.5 * self.width as f64,
            0.5 * self.height as f64 - (index / self.width) as f64 - 0.5,
        );
        let place = self.middle + ray / self.scale;
        self.view * place.extend(height)
    }
}
