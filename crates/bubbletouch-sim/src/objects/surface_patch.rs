//! Patches of the surfaces of forms, each a map from a rectangle of parameters. Forms without a closed layout of spheres are packed by dividing their patches
//! into cells.

use crate::geometry::Pose;
use glam::{DMat3, DQuat, DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Patch of the surface of a part, parametrised by a rectangle of two parameters.
#[derive(Clone, Debug)]
pub(super) struct SurfacePatch {
    form: PatchForm,
    /// Pose of the patch in the frame of the part.
    pose: Pose,
    /// Distance by which the patch is moved outwards from the part's surface, metres.
    offset: f64,
    /// Lower corner of the rectangle of parameters.
    pub low: DVec2,
    pub high: DVec2,
}

#[derive(Clone, Copy, Debug)]
enum PatchForm {
    /// Plane z = 0 with the parameters x and y; the outside is above.
    Flat,
    /// Surface of revolution of a line in the half plane (distance from the axis, height). Parameters: distance along the line, and angle about z.
    Turned { start: DVec2, along: DVec2 },
    /// Torus about z, or a ball if `ring` is 0. Parameters: latitude on the tube, and angle about z.
    Round { ring: f64, tube: f64 },
}

/// Rectangular cell of a patch's parameters. The cell's surface lies within the distance `bulge` of the convex hull of its corners.
#[derive(Clone, Copy, Debug)]
pub(super) struct PatchCell {
    pub low: DVec2,
    pub high: DVec2,
    /// Points of the surface at the corners of the cell: the low corner, its neighbours along x and along y, and the high corner.
    pub corners: [DVec3; 4],
    bulge: f64,
}

impl SurfacePatch {
    /// Creates a rectangle about the origin of a plane with orthogonal unit axes `x` and `y`; the vector product x × y points outwards.
    pub fn flat(origin: DVec3, [x, y]: [DVec3; 2], half: DVec2) -> Self {
        Self {
            form: PatchForm::Flat,
            offset: 0.0,
            pose: Pose::new(frame(x, y), origin),
            low: -half,
            high: half,
        }
    }

    /// Creates a patch by rotating a line segment of the half plane (distance from the axis, height) about z, through the angles `angles[0]` to `angles[1]`.
    /// The outside is on the right of the segment.
    pub fn turned(start: DVec2, end: DVec2, angles: [f64; 2]) -> Self {
        let length = (end - start).length();
        let along = (end - start) / length;
        Self {
            form: PatchForm::Turned { start, along },
            offset: 0.0,
            pose: Pose::IDENTITY,
            low: DVec2::new(0.0, angles[0]),
            high: DVec2::new(length, angles[1]),
        }
    }

    /// Creates the surface of a torus about z with the radii `ring` (circle in the middle of the tube) and `tube`, metres.
    pub fn torus(ring: f64, tube: f64) -> Self {
        Self {
            form: PatchForm::Round { ring, tube },
            offset: 0.0,
            pose: Pose::IDENTITY,
            low: DVec2::ZERO,
            high: DVec2::splat(TAU),
        }
    }

    /// Creates the surface of a ball.
    pub fn ball(center: DVec3, radius: f64) -> Self {
        Self {
            pose: Pose::from_translation(center),
            low: DVec2::new(-FRAC_PI_2, 0.0),
            high: DVec2::new(FRAC_PI_2, TAU),
            ..Self::torus(0.0, radius)
        }
    }

    /// Creates one eighth of a ball's surface, on the given sides (1 or −1) of its centre along x, y, z.
    pub fn eighth_of_ball(center: DVec3, radius: f64, sides: DVec3) -> Self {
        let axes = [sides.x * DVec3::X, sides.y * DVec3::Y];
        let is_up = sides.x * sides.y * sides.z > 0.0;
        let latitude = if is_up { 0.0 } else { -FRAC_PI_2 };
        Self {
            pose: Pose::new(frame(axes[0], axes[1]), center),
            low: DVec2::new(latitude, 0.0),
            high: DVec2::new(latitude + FRAC_PI_2, FRAC_PI_2),
            ..Self::torus(0.0, radius)
        }
    }

    /// Returns the patch after a rigid motion, which may also change the direction of its z axis.
    pub fn moved(mut self, motion: &Pose) -> Self {
        self.pose = motion.compose(&self.pose);
        self
    }

    /// Returns the patch after a movement outwards by `offset`, metres.
    pub fn grown(mut self, offset: f64) -> Self {
        self.offset = offset;
        self
    }

    /// Returns the surface point at the given parameters, with the outward unit normal.
    pub fn at(&self, place: DVec2) -> (DVec3, DVec3) {
        let turned = |flat: DVec2, angle: f64| {
            let (sin, cos) = angle.sin_cos();
            DVec3::new(flat.x * cos, flat.x * sin, flat.y)
        };
        let (point, normal) = match self.form {
            PatchForm::Flat => (place.extend(0.0), DVec3::Z),
            PatchForm::Turned { start, along } => (
                turned(start + place.x * along, place.y),
                turned(-along.perp(), place.y),
            ),
            PatchForm::Round { ring, tube } => {
                let out = DVec2::from_angle(place.x);
                let point = DVec2::new(ring, 0.0) + tube * out;
                (turned(point, place.y), turned(out, place.y))
            }
        };
        (
            self.pose.transform_point(point + self.offset * normal),
            self.pose.rotation * normal,
        )
    }

    /// Divides the patch into cells that span at most an eighth of a circle.
    pub fn cells(&self) -> Vec<PatchCell> {
        let size = self.high - self.low;
        let is_angle = match self.form {
            PatchForm::Flat => [false, false],
            PatchForm::Turned { .. } => [false, true],
            PatchForm::Round { .. } => [true, true],
        };
        let n = [0, 1].map(|axis| match is_angle[axis] {
            true => (size[axis] / (0.25 * PI) - 1e-9).ceil().max(1.0),
            false => 1.0,
        });
        let mut cells = Vec::new();
        for i in 0..n[0] as usize {
            for j in 0..n[1] as usize {
                let at = |i: usize, j: usize| {
                    self.low + size * DVec2::new(i as f64 / n[0], j as f64 / n[1])
                };
                cells.push(self.cell(at(i, j), at(i + 1, j + 1)));
            }
        }
        cells
    }

    /// Returns points on the patch, including its border, at most about `spacing` (metres) apart.
    pub fn points(&self, spacing: f64) -> Vec<DVec3> {
        let mut points = Vec::new();
        for cell in self.cells() {
            let n = (cell.sides() / spacing).ceil().max(DVec2::splat(2.0));
            for (i, j) in (0..=n.x as usize).flat_map(|i| (0..=n.y as usize).map(move |j| (i, j))) {
                let share = DVec2::new(i as f64, j as f64) / n;
                points.push(self.at(cell.low + share * (cell.high - cell.low)).0);
            }
        }
        points
    }

    /// Returns the two halves of a cell, cut across its longer side.
    pub fn halves(&self, cell: &PatchCell) -> [PatchCell; 2] {
        let sides = cell.sides();
        let middle = 0.5 * (cell.low + cell.high);
        let (mut left, mut right) = (cell.high, cell.low);
        let axis = usize::from(sides.y > sides.x);
        left[axis] = middle[axis];
        right[axis] = middle[axis];
        [self.cell(cell.low, left), self.cell(right, cell.high)]
    }

    /// Creates the cell between two corners of the parameter rectangle, and computes its bulge. A map differs from its bilinear interpolant at the corners
    /// by at most Σ a² |f''| / 8. The sum is over the two sides a, with the second derivatives f'' along them. The interpolant lies in the convex hull of
    /// the corners.
    fn cell(&self, low: DVec2, high: DVec2) -> PatchCell {
        let squared = (high - low) * (high - low);
        let second = match self.form {
            PatchForm::Flat => DVec2::ZERO,
            PatchForm::Turned { start, along } => {
                let away = |at: f64| start.x + at * along.x;
                DVec2::new(0.0, away(low.x).max(away(high.x)) + self.offset)
            }
            PatchForm::Round { ring, tube } => {
                let tube = tube + self.offset;
                // The maximum distance from the axis is at an end, because the first cells end at the equator of the tube.
                let away = |latitude: f64| ring + tube * latitude.cos();
                DVec2::new(tube, away(low.x).max(away(high.x)))
            }
        };
        let places = [
            low,
            DVec2::new(high.x, low.y),
            DVec2::new(low.x, high.y),
            high,
        ];
        PatchCell {
            low,
            high,
            corners: places.map(|place| self.at(place).0),
            bulge: squared.dot(second) / 8.0,
        }
    }
}

impl PatchCell {
    /// Returns an upper bound of the distance from the point `from` to all points of the cell, metres.
    pub fn farthest(&self, from: DVec3) -> f64 {
        let distances = self.corners.map(|corner| corner.distance(from));
        distances.into_iter().fold(0.0, f64::max) + self.bulge
    }

    /// Returns the lengths of the cell along the two parameters, metres: the larger distance between corners on opposite sides.
    fn sides(&self) -> DVec2 {
        let [a, b, c, d] = self.corners;
        DVec2::new(
            a.distance(b).max(c.distance(d)),
            a.distance(c).max(b.distance(d)),
        )
    }

    /// Returns the parameters of the cell's middle and corners.
    pub fn places(&self) -> [DVec2; 5] {
        let (low, high) = (self.low, self.high);
        let middle = 0.5 * (low + high);
        [
            middle,
            low,
            DVec2::new(high.x, low.y),
            DVec2::new(low.x, high.y),
            high,
        ]
    }
}

/// Returns the rotation that maps the axes x and y to two orthogonal unit vectors.
pub(super) fn frame(x: DVec3, y: DVec3) -> DQuat {
    DQuat::from_mat3(&DMat3::from_cols(x, y, x.cross(y)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_of_a_cell_is_as_near_as_it_says() {
        let patches = [
            SurfacePatch::flat(DVec3::X, [DVec3::Y, DVec3::Z], DVec2::new(2.0, 0.5)),
            SurfacePatch::turned(DVec2::new(1.0, 0.0), DVec2::new(0.2, 2.0), [0.0, TAU]),
            SurfacePatch::torus(2.0, 0.7),
            SurfacePatch::ball(DVec3::Y, 1.3),
            SurfacePatch::eighth_of_ball(DVec3::Z, 0.4, DVec3::new(-1.0, 1.0, 1.0)),
        ];
        for patch in &patches {
            for cell in patch.cells() {
                let from = 0.3 * cell.corners[0] + 0.4 * cell.corners[3] + DVec3::splat(0.1);
                for i in 0..=10 {
                    for j in 0..=10 {
                        let share = DVec2::new(f64::from(i), f64::from(j)) / 10.0;
                        let (point, normal) = patch.at(cell.low + share * (cell.high - cell.low));
                        assert!(point.distance(from) <= cell.farthest(from) + 1e-12);
                        assert!((normal.length() - 1.0).abs() < 1e-12);
                    }
                }
            }
        }
    }

    #[test]
    fn the_eighths_of_a_ball_are_on_their_sides() {
        for number in 0..8 {
            let side = |axis: i32| if number >> axis & 1 == 1 { 1.0 } else { -1.0 };
            let sides = DVec3::new(side(0), side(1), side(2));
            let patch = SurfacePatch::eighth_of_ball(DVec3::ZERO, 1.0, sides);
            let (point, _) = patch.at(0.5 * (patch.low + patch.high));
            assert!((point * sides).min_element() > 0.3, "{sides}: {point}");
        }
    }
}
