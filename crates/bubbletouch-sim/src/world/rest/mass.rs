//! Centre of mass of a union of spheres as a homogeneous solid.

use crate::objects::SphereUnion;
use glam::DVec3;

/// Number of cubic cells along the longest side of the bounding box. A larger value is more accurate, with cubic run time. With 48 cells, the error is about
/// 0.2 % of the longest side, in about 2 ms.
const CELLS: f64 = 48.0;

const EMPTY: u8 = 0;
const SOLID: u8 = 1;
const OUTSIDE: u8 = 2;

/// Returns the centre of mass of a union of spheres, in the union's frame, metres.
///
/// The union is divided into cubes. Cavities enclosed by spheres are treated as solid. A shell of spheres around a mesh therefore has the mass of the mesh's
/// interior, but a mug stays hollow.
pub fn center_of_mass(spheres: &SphereUnion) -> DVec3 {
    let mut cells = Cells::around(spheres);
    cells.mark_spheres(spheres);
    cells.flood_outside();
    cells.centroid()
}

/// Cubic cells that fill the union's bounding box, surrounded by one layer of empty cells.
struct Cells {
    origin: DVec3,
    side: f64,
    size: [usize; 3],
    state: Vec<u8>,
}

impl Cells {
    fn around(spheres: &SphereUnion) -> Self {
        let bounds = spheres.bounds();
        let side = bounds.size().max_element() / CELLS;
        let inner = (bounds.size() / side - 1e-9).ceil().max(DVec3::ONE);
        let size = inner.to_array().map(|n| n as usize + 2);
        let origin = bounds.center() - 0.5 * side * (inner + 2.0);
        let state = vec![EMPTY; size.iter().product()];
        Self {
            origin,
            side,
            size,
            state,
        }
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.size[1] + y) * self.size[0] + x
    }

    /// Returns the centre of the cell with index `place` along one axis, in the union's frame, metres.
    fn center(&self, axis: usize, place: usize) -> f64 {
        self.origin[axis] + (place as f64 + 0.5) * self.side
    }

    /// Marks the cells whose centres are inside a sphere, and also the cell at each sphere's centre, so that thin parts are not lost.
    fn mark_spheres(&mut self, spheres: &SphereUnion) {
        for sphere in spheres.spheres() {
            let place = |axis: usize, offset: f64| {
                let cell = (sphere.center[axis] + offset - self.origin[axis]) / self.side;
                (cell.max(0.0) as usize).min(self.size[axis] - 1)
            };
            let first = [0, 1, 2].map(|axis| place(axis, -sphere.radius));
            let last = [0, 1, 2].map(|axis| place(axis, sphere.radius));
            let middle = self.index([0, 1, 2].map(|axis| place(axis, 0.0)));
            self.state[middle] = SOLID;
            for z in first[2]..=last[2] {
                let dz = self.center(2, z) - sphere.center.z;
                for y in first[1]..=last[1] {
                    let dy = self.center(1, y) - sphere.center.y;
                    for x in first[0]..=last[0] {
                        let dx = self.center(0, x) - sphere.center.x;
                        if dx * dx + dy * dy + dz * dz <= sphere.radius * sphere.radius {
                            let index = self.index([x, y, z]);
                            self.state[index] = SOLID;
                        }
                    }
                }
            }
        }
    }

    /// Marks as outside every empty cell that is connected to the outer layer through faces.
    fn flood_outside(&mut self) {
        let mut stack = vec![[0usize; 3]];
        self.state[0] = OUTSIDE;
        while let Some(cell) = stack.pop() {
            for axis in 0..3 {
                for step in [-1, 1] {
                    let mut next = cell;
                    let Some(place) = cell[axis].checked_add_signed(step) else {
                        continue;
                    };
                    if place >= self.size[axis] {
                        continue;
                    }
                    next[axis] = place;
                    let index = self.index(next);
                    if self.state[index] == EMPTY {
                        self.state[index] = OUTSIDE;
                        stack.push(next);
                    }
                }
            }
        }
    }

    /// Returns the mean centre of all cells that are not outside the union, metres.
    fn centroid(&self) -> DVec3 {
        let mut sum = DVec3::ZERO;
        let mut count = 0.0;
        for z in 0..self.size[2] {
            for y in 0..self.size[1] {
                for x in 0..self.size[0] {
                    if self.state[self.index([x, y, z])] != OUTSIDE {
                        let place = DVec3::new(x as f64, y as f64, z as f64);
                        sum += place + 0.5;
                        count += 1.0;
                    }
                }
            }
        }
        self.origin + self.side * sum / count
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objects::Sphere;

    fn union(spheres: &[([f64; 3], f64)]) -> SphereUnion {
        let sphere = |&(center, radius): &([f64; 3], f64)| Sphere {
            center: DVec3::from_array(center),
            radius,
        };
        SphereUnion::new(spheres.iter().map(sphere).collect()).unwrap()
    }

    #[test]
    fn one_sphere_has_its_mass_at_its_centre() {
        let center = center_of_mass(&union(&[([0.3, -0.2, 0.1], 0.04)]));
        assert!((center - DVec3::new(0.3, -0.2, 0.1)).length() < 1e-12);
    }

    #[test]
    fn two_spheres_balance_by_their_volumes() {
        let center = center_of_mass(&union(&[([0.0; 3], 0.02), ([0.1, 0.0, 0.0], 0.04)]));
        // The volumes are 1 : 8.
        let exact = 0.1 * 8.0 / 9.0;
        assert!((center - DVec3::new(exact, 0.0, 0.0)).length() < 0.002 * 0.16);
    }

    #[test]
    fn a_closed_shell_weighs_like_its_inside() {
        // Dumbbell whose left half is a dense shell and whose right half is solid.
        let mut spheres = vec![([0.1, 0.0, 0.0], 0.04)];
        let n = 2000;
        for i in 0..n {
            let z = 1.0 - (2 * i + 1) as f64 / n as f64;
            let (sin, cos) = (2.399963229728653 * i as f64).sin_cos();
            let flat = (1.0 - z * z).sqrt();
            spheres.push(([0.038 * flat * cos, 0.038 * flat * sin, 0.038 * z], 0.002));
        }
        let center = center_of_mass(&union(&spheres));
        assert!((center - DVec3::new(0.05, 0.0, 0.0)).length() < 0.001);
    }
}
