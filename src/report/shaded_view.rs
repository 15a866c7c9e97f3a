//! Spheres drawn for the eye: orthographic, softly lit, with outlines and a shadow on the floor.

use crate::objects::Sphere;
use glam::{DVec2, DVec3};

/// Brightness of the floor and of blank paper, 0 to 255.
pub(super) const BACKGROUND: u8 = 250;

/// Rays a pixel, each way.
const SUPERSAMPLING: usize = 2;

/// What a ray of the picture meets first.
#[derive(Clone, Copy)]
struct Hit {
    /// Towards the eye, metres.
    height: f64,
    normal: DVec3,
}

/// Spheres as they are seen and lit, pixel by pixel.
pub(super) struct ShadedView {
    canvas: Canvas,
    shades: Vec<(f64, bool)>,
    /// Scale of the picture.
    pub pixels_per_metre: f64,
}

impl ShadedView {
    /// The spheres in the middle of width × height pixels, as large as `room` (pixels each way) allows.
    pub fn new(spheres: &[Sphere], [width, height]: [usize; 2], room: DVec2) -> Self {
        let view = View::three_quarter();
        let (low, high) = extent(&view, spheres);
        let pixels_per_metre = (room / (high - low)).min_element();
        let canvas = Canvas {
            width: width * SUPERSAMPLING,
            height: height * SUPERSAMPLING,
            scale: pixels_per_metre * SUPERSAMPLING as f64,
            middle: 0.5 * (low + high),
            view,
        };
        let shades = canvas.shades(&canvas.hits(spheres), &canvas.shadow(spheres));
        Self {
            canvas,
            shades,
            pixels_per_metre,
        }
    }

    /// Red, green, blue of a pixel, row 0 at the top.
    pub fn rgb(&self, x: usize, y: usize) -> [u8; 3] {
        self.canvas.pixel(&self.shades, x, y)
    }
}

/// Axes of the picture in the object's frame.
struct View {
    right: DVec3,
    up: DVec3,
    towards_eye: DVec3,
}

impl View {
    /// The eye stands before the object (−y), 30° to the right of it and 38° up.
    fn three_quarter() -> Self {
        let (azimuth, elevation) = (30f64.to_radians(), 38f64.to_radians());
        let right = DVec3::new(azimuth.cos(), azimuth.sin(), 0.0);
        let back = DVec3::new(azimuth.sin(), -azimuth.cos(), 0.0);
        let towards_eye = elevation.cos() * back + elevation.sin() * DVec3::Z;
        Self {
            right,
            up: towards_eye.cross(right),
            towards_eye,
        }
    }

    fn project(&self, point: DVec3) -> DVec2 {
        DVec2::new(point.dot(self.right), point.dot(self.up))
    }
}

fn extent(view: &View, spheres: &[Sphere]) -> (DVec2, DVec2) {
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
struct Canvas {
    width: usize,
    height: usize,
    /// Rays a metre.
    scale: f64,
    /// The point of the view's plane in the middle of the tile.
    middle: DVec2,
    view: View,
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

    fn hits(&self, spheres: &[Sphere]) -> Vec<Option<Hit>> {
        let mut hits: Vec<Option<Hit>> = vec![None; self.width * self.height];
        for sphere in spheres {
            let height = sphere.center.dot(self.view.towards_eye);
            let center = self.view.project(sphere.center);
            self.each_ray(center, DVec2::splat(sphere.radius), |index, offset| {
                let forward = (1.0 - offset.length_squared()).sqrt();
                let height = height + sphere.radius * forward;
                if hits[index].is_none_or(|hit| hit.height < height) {
                    let normal = DVec3::new(offset.x, -offset.y, forward);
                    hits[index] = Some(Hit { height, normal });
                }
            });
        }
        hits
    }

    /// Darkness of the floor z = lowest point, 0 to 1, under a wide lamp that stands left and above.
    fn shadow(&self, spheres: &[Sphere]) -> Vec<f32> {
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

    /// Brightness of each ray and whether it met the object.
    fn shades(&self, hits: &[Option<Hit>], shadow: &[f32]) -> Vec<(f64, bool)> {
        let normals = self.smooth_normals(hits);
        let lamp = DVec3::new(-0.45, 0.65, 0.62).normalize();
        let fill = DVec3::new(0.8, 0.1, 0.6).normalize();
        let indexed = hits.iter().zip(normals).enumerate();
        indexed
            .map(|(index, (hit, normal))| match hit {
                None => (1.0 - 0.20 * f64::from(shadow[index]), false),
                Some(hit) => {
                    let light =
                        0.30 + 0.62 * normal.dot(lamp).max(0.0) + 0.16 * normal.dot(fill).max(0.0);
                    let outline = self.step_down(hits, index, hit);
                    (light * (1.0 - 0.55 * outline), true)
                }
            })
            .collect()
    }

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
        let mut normals: Vec<DVec3> = hits
            .iter()
            .map(|hit| hit.map_or(DVec3::ZERO, |h| h.normal))
            .collect();
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

    fn pixel(&self, shades: &[(f64, bool)], x: usize, y: usize) -> [u8; 3] {
        // Slate blue paint on a near-white floor.
        const PAINT: [f64; 3] = [142.0, 178.0, 214.0];
        let mut sum = [0.0; 3];
        for row in y * SUPERSAMPLING..(y + 1) * SUPERSAMPLING {
            for column in x * SUPERSAMPLING..(x + 1) * SUPERSAMPLING {
                let (light, object) = shades[row * self.width + column];
                for (channel, total) in sum.iter_mut().enumerate() {
                    let color = if object {
                        PAINT[channel]
                    } else {
                        f64::from(BACKGROUND)
                    };
                    *total += (color * light).min(255.0);
                }
            }
        }
        sum.map(|total| (total / (SUPERSAMPLING * SUPERSAMPLING) as f64).round() as u8)
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
