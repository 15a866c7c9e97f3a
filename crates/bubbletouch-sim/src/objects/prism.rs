//! Prism, a polygon with a thickness: distance, surface and packing.

use super::Sphere;
use super::fit::{Fit, MAX_SPHERES};
use super::outline::Outline;
use super::solid::Form;
use super::surface_patch::SurfacePatch;
use glam::{DVec2, DVec3};

/// Smallest half width of the first cells of a wall, relative to the sum of both tolerances. Walls of thicker prisms begin with nearly square cells. If larger,
/// packings of thin prisms change; if smaller, walls of very thin prisms have millions of cells.
const NARROW: f64 = 1e-2;

/// Polygon in the plane z = 0, extended by half the thickness along +z and −z.
#[derive(Clone, Debug)]
pub(super) struct Prism {
    outline: Outline,
    /// Half the thickness of the prism, metres.
    half: f64,
}

impl Form for Prism {
    fn distance(&self, point: DVec3) -> f64 {
        let across = self.outline.distance(point.truncate());
        let above = point.z.abs() - self.half;
        let outside = DVec2::new(across, above).max(DVec2::ZERO).length();
        outside + across.max(above).min(0.0)
    }

    fn support(&self, direction: DVec3) -> f64 {
        self.outline.support(direction.truncate()) + self.half * direction.z.abs()
    }

    fn volume_and_center(&self) -> (f64, DVec3) {
        let corners = self.outline.vertices();
        let apex = corners[0];
        let (mut area, mut moment) = (0.0, DVec2::ZERO);
        for pair in corners.windows(2) {
            let [a, b] = [pair[0] - apex, pair[1] - apex];
            let triangle = 0.5 * a.perp_dot(b);
            area += triangle;
            moment += triangle * (a + b) / 3.0;
        }
        let center = apex + moment / area;
        (2.0 * self.half * area.abs(), center.extend(0.0))
    }

    /// Packs the prism with spheres. The walls are divided into cells first, then the uncovered remainder of the two faces into cells of a square around the
    /// outline.
    ///
    /// The ball of a cell touches the surface in the middle of the cell. The cell is divided until the enlarged ball covers the farthest point p of the cell:
    /// |p − c| ≤ r + h. Here c is the ball's centre, r its radius, and h the sum of both tolerances. On a plane this condition is |p − foot|² ≤ (r + h)² −
    /// r².
    fn pack(&self, fit: Fit, spheres: &mut Vec<Sphere>) {
        for edge in 0..self.outline.edges.len() {
            let length = self.outline.edges[edge].length;
            // The first cells are nearly square, because walls are much longer than high.
            let n = (0.5 * length / self.half.max(NARROW * fit.reach())).ceil();
            for i in 0..(n as usize).min(MAX_SPHERES + 1) {
                let cell = Cell {
                    middle: DVec2::new(length * (i as f64 + 0.5) / n, 0.0),
                    half: DVec2::new(0.5 * length / n, self.half),
                };
                self.pack_wall(edge, cell, fit, spheres);
            }
        }
        let [min, max] = self.outline.bounds();
        let cell = Cell {
            middle: 0.5 * (min + max),
            half: DVec2::splat(0.5 * (max - min).max_element()),
        };
        self.pack_face(cell, fit, spheres);
    }

    /// Returns the patches of the prism's surface: each wall, and a rectangle around each face. The parts of a rectangle beyond the outline are not part of
    /// the surface.
    fn patches(&self) -> Vec<SurfacePatch> {
        let walls = self.outline.edges.iter().map(|edge| {
            let middle = edge.point(0.5 * edge.length).extend(0.0);
            let axes = [edge.along.extend(0.0), DVec3::Z];
            SurfacePatch::flat(middle, axes, DVec2::new(0.5 * edge.length, self.half))
        });
        let [min, max] = self.outline.bounds();
        let middle = 0.5 * (min + max);
        let face = |up: f64| {
            let axes = [DVec3::X, up * DVec3::Y];
            SurfacePatch::flat(middle.extend(up * self.half), axes, 0.5 * (max - min))
        };
        walls.chain([face(1.0), face(-1.0)]).collect()
    }
}

impl Prism {
    pub fn new(outline: &[DVec2], thickness: f64) -> Self {
        Self {
            outline: Outline::new(outline, |_, _| true),
            half: 0.5 * thickness,
        }
    }

    fn pack_wall(&self, edge: usize, cell: Cell, fit: Fit, spheres: &mut Vec<Sphere>) {
        if spheres.len() > MAX_SPHERES {
            return;
        }
        let wall = &self.outline.edges[edge];
        let foot = wall.point(cell.middle.x);
        let radius = self
            .outline
            .tangent_radius(edge, foot)
            .min(self.half - cell.middle.y.abs());
        let center = foot + radius * wall.inward;
        if cell.half.length_squared() <= fit.disc_squared(radius) {
            let farthest = radius.hypot(cell.half.length());
            spheres.push(fit.covering(center.extend(cell.middle.y), radius, farthest));
            return;
        }
        for part in cell.split() {
            self.pack_wall(edge, part, fit, spheres);
        }
    }

    fn pack_face(&self, cell: Cell, fit: Fit, spheres: &mut Vec<Sphere>) {
        let inset = -self.outline.distance(cell.middle);
        if -inset > cell.half.length() || spheres.len() > MAX_SPHERES {
            return;
        }
        let (center, radius) = if inset > 0.0 {
            (cell.middle, inset.min(self.half))
        } else {
            self.border_disc(cell.middle, 0.25 * fit.reach())
        };
        let farthest = (cell.middle - center).length() + cell.half.length();
        if farthest * farthest <= fit.disc_squared(radius) {
            for z in [self.half - radius, radius - self.half] {
                spheres.push(fit.covering(center.extend(z), radius, radius.hypot(farthest)));
            }
            return;
        }
        for part in cell.split() {
            self.pack_face(part, fit, spheres);
        }
    }

    /// Returns the centre and the radius of a disc inside the outline, with a radius of at most `largest`. The disc touches the outline at the point nearest
    /// to `point`, which is outside. At a corner the disc is the corner itself, with radius 0.
    fn border_disc(&self, point: DVec2, largest: f64) -> (DVec2, f64) {
        let (edge, foot) = self.outline.nearest(point);
        let step = self
            .half
            .min(largest)
            .min(self.outline.tangent_radius(edge, foot));
        let center = foot + step * self.outline.edges[edge].inward;
        // At a corner rounding decides to which edge the foot belongs; only the distance itself is reliable.
        let inset = -self.outline.distance(center);
        if inset > 0.0 {
            (center, inset.min(self.half))
        } else {
            (foot, 0.0)
        }
    }
}

/// Rectangular cell in the coordinates of a wall or a face.
#[derive(Clone, Copy)]
struct Cell {
    middle: DVec2,
    half: DVec2,
}

impl Cell {
    /// Returns the two halves of a cell, cut across the longer side.
    fn split(&self) -> [Self; 2] {
        let mut half = self.half;
        let mut step = DVec2::ZERO;
        let longer = usize::from(half.y > half.x);
        half[longer] *= 0.5;
        step[longer] = half[longer];
        [self.middle - step, self.middle + step].map(|middle| Self { middle, half })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_patches_of_a_wall_and_of_a_face_end_where_the_wall_and_the_outline_do() {
        let corners = [[0., 0.], [3., 0.], [3., 1.], [1., 1.], [1., 2.], [0., 2.]];
        let prism = Prism::new(&corners.map(DVec2::from), 0.5);
        let patches = prism.patches();
        let middle = |patch: &SurfacePatch| patch.at(0.5 * (patch.low + patch.high));
        for (wall, edge) in patches.iter().zip(&prism.outline.edges) {
            let [a, b] = [edge.start, edge.point(edge.length)];
            let ends = [wall.at(wall.low).0, wall.at(wall.high).0];
            for (end, expected) in ends.iter().zip([a.extend(-0.25), b.extend(0.25)]) {
                assert!(end.distance(expected) < 1e-12, "{end} for {expected}");
            }
            let (middle, normal) = middle(wall);
            assert!((prism.distance(middle + 0.1 * normal) - 0.1).abs() < 1e-12);
        }
        assert_eq!(patches.len(), 6 + 2);
        for (face, z) in patches[6..].iter().zip([0.25, -0.25]) {
            let corners = [face.at(face.low).0, face.at(face.high).0];
            let (low, high) = (corners[0].min(corners[1]), corners[0].max(corners[1]));
            assert!(low.distance(DVec3::new(0.0, 0.0, z)) < 1e-12);
            assert!(high.distance(DVec3::new(3.0, 2.0, z)) < 1e-12);
            assert!((face.at(face.low).1 - z.signum() * DVec3::Z).length() < 1e-12);
        }
    }
}
