//! Descent from a direction to the nearest local minimum of the support function.
//!
//! The function is the maximum of smooth pieces, one per sphere, with creases where two spheres touch the table. Each step exactly minimises the maximum of the
//! linearised pieces inside a trust region. At a face with three contacts, the descent converges like Newton's method.

use super::support::Support;
use crate::objects::Sphere;
use glam::{DMat3, DVec3};

/// Initial radius of the trust region of a descent, radians: about the spacing of the mesh of directions.
const FIRST_REACH: f64 = 0.04;
/// Radius of the trust region below which the descent ends, radians.
const LAST_REACH: f64 = 1e-9;
/// Predicted decrease of the height that counts as rounding, relative to the farthest point's distance from the centre of mass.
const LEAST_GAIN: f64 = 1e-14;
/// Maximum number of steps of a descent; 20 to 60 are usual.
const MAX_STEPS: usize = 200;

/// Returns the direction at the local minimum of the height that a descent from `start` reaches; both are unit vectors. The height never increases during the
/// descent.
pub(crate) fn descend(support: &Support, start: DVec3) -> DVec3 {
    let mut down = start;
    let mut height = support.height(down);
    let mut reach = FIRST_REACH;
    let radius = support.radius();
    let flat = LEAST_GAIN * radius;
    let mut gathered = (down, 4.0 * reach);
    let mut spheres = support.candidates_near(gathered.0, gathered.1);
    for _ in 0..MAX_STEPS {
        // The corners of the walls are two trust-region radii away.
        if down.distance(gathered.0) + 2.0 * reach > gathered.1 {
            gathered = (down, 4.0 * reach);
            spheres = support.candidates_near(gathered.0, gathered.1);
        }
        // Inside the walls no height changes by more than two radii times the object's radius. A sphere lower by twice this amount therefore
        // stays below the highest.
        let lowest = height - 4.0 * reach * radius;
        let (step, predicted) = linear_step(&spheres, down, lowest, walls(radius, height, reach));
        let gain = height - predicted;
        if gain <= flat || reach < LAST_REACH {
            break;
        }
        let next = (down + step).normalize();
        let next_height = support.height(next);
        if height - next_height >= 0.25 * gain {
            (down, height) = (next, next_height);
            reach = (2.0 * reach).min(FIRST_REACH);
        } else {
            if next_height < height {
                (down, height) = (next, next_height);
            }
            reach *= 0.25;
        }
    }
    down
}

/// Linear lower bound of the height z due to one sphere: z ≥ `value` + `slope` · t for a step t in the tangent plane.
#[derive(Clone, Copy)]
struct LinearBound {
    value: f64,
    slope: [f64; 2],
}

impl LinearBound {
    fn at(&self, t: [f64; 2]) -> f64 {
        self.value + self.slope[0] * t[0] + self.slope[1] * t[1]
    }
}

/// Returns the step in the tangent plane that minimises the linearised height inside the bounding walls, and this height. Spheres below `lowest` are ignored.
fn linear_step(
    spheres: &[Sphere],
    down: DVec3,
    lowest: f64,
    walls: [LinearBound; 3],
) -> (DVec3, f64) {
    let (u, v) = down.any_orthonormal_pair();
    let piece = |sphere: &Sphere| LinearBound {
        value: sphere.center.dot(down) + sphere.radius,
        slope: [sphere.center.dot(u), sphere.center.dot(v)],
    };
    let counts = |piece: &LinearBound| piece.value >= lowest;
    let pieces: Vec<_> = spheres.iter().map(piece).filter(counts).collect();
    let (t, z) = lowest_maximum(&pieces, walls);
    (t[0] * u + t[1] * v, z)
}

/// Returns three linear functions that keep the step inside a triangle of inradius `reach`. The functions are steeper than the bound of any sphere and exceed
/// `height` outside the triangle. Well inside the triangle, they stay below every possible minimum.
fn walls(radius: f64, height: f64, reach: f64) -> [LinearBound; 3] {
    let steep = 4.0 * radius;
    [0.0, 1.0, 2.0].map(|third| {
        let (sin, cos) = (std::f64::consts::TAU * third / 3.0).sin_cos();
        LinearBound {
            value: height - steep * reach,
            slope: [steep * cos, steep * sin],
        }
    })
}

/// Returns the point t at which the maximum of all linear functions `pieces` and `walls` is lowest, and this maximum. The linear program in three variables
/// is solved by the dual simplex method.
///
/// The basis of the method contains three linear functions whose slopes have the weighted mean 0 with `weights` ≥ 0. The maximum of the three functions is
/// lowest at their common point. The function that is highest at this point enters the basis, and the function whose weight first becomes zero leaves the
/// basis.
fn lowest_maximum(pieces: &[LinearBound], walls: [LinearBound; 3]) -> ([f64; 2], f64) {
    let mut basis = walls;
    let mut weights = [1.0 / 3.0; 3];
    let mut answer = ([0.0; 2], walls[0].value);
    for _ in 0..MAX_STEPS {
        let (t, z) = answer;
        let mut enters = (&walls[0], f64::NEG_INFINITY);
        for piece in pieces.iter().chain(&walls) {
            let height = piece.at(t);
            if height > enters.1 {
                enters = (piece, height);
            }
        }
        let (enters, highest) = enters;
        if highest <= z + 1e-15 * z.abs().max(f64::MIN_POSITIVE) {
            break;
        }
        let column = |piece: &LinearBound| DVec3::new(piece.slope[0], piece.slope[1], 1.0);
        let columns = DMat3::from_cols(column(&basis[0]), column(&basis[1]), column(&basis[2]));
        let mix = (columns.inverse() * column(enters)).to_array();
        let ratio = |i: &usize| weights[*i] / mix[*i];
        let leaving = (0..3)
            .filter(|&i| mix[i] > 0.0)
            .min_by(|a, b| ratio(a).total_cmp(&ratio(b)));
        let Some(leaves) = leaving else {
            break;
        };
        let share = ratio(&leaves);
        for i in 0..3 {
            weights[i] = (weights[i] - share * mix[i]).max(0.0);
        }
        weights[leaves] = share;
        basis[leaves] = *enters;
        let Some(meeting) = common_point(&basis) else {
            break;
        };
        answer = meeting;
    }
    answer
}

/// Returns the point where three linear functions are equal, and their value there; `None` if their slopes lie on a line.
fn common_point(basis: &[LinearBound; 3]) -> Option<([f64; 2], f64)> {
    let row = |p: &LinearBound| DVec3::new(p.slope[0], p.slope[1], -1.0);
    let rows = DMat3::from_cols(row(&basis[0]), row(&basis[1]), row(&basis[2])).transpose();
    let values = DVec3::new(basis[0].value, basis[1].value, basis[2].value);
    let solution = rows.inverse() * -values;
    solution
        .is_finite()
        .then_some(([solution.x, solution.y], solution.z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objects::SphereUnion;
    use crate::random::Seed;
    use crate::world::fixtures::vector;
    use rand::Rng;

    #[test]
    fn the_linear_step_finds_the_lowest_maximum() {
        let mut rng = Seed::new(1).rng();
        for n in [1, 2, 3, 10, 100] {
            let mut random = || 2.0 * rng.r#gen::<f64>() - 1.0;
            let pieces: Vec<_> = (0..n)
                .map(|_| LinearBound {
                    value: random(),
                    slope: [random(), random()],
                })
                .collect();
            let walls = walls(2.0, 1.0, 0.5);
            let highest = |t: [f64; 2]| {
                let heights = pieces.iter().chain(&walls).map(|piece| piece.at(t));
                heights.fold(f64::NEG_INFINITY, f64::max)
            };
            let (t, z) = lowest_maximum(&pieces, walls);
            assert!((highest(t) - z).abs() < 1e-12);
            for i in -100..=100 {
                for j in -100..=100 {
                    let other = [0.01 * f64::from(i), 0.01 * f64::from(j)];
                    assert!(highest(other) >= z - 1e-12);
                }
            }
        }
    }

    #[test]
    fn settling_never_rises() {
        let mut rng = Seed::new(2).rng();
        let spheres = (0..40).map(|_| Sphere {
            center: 0.05 * vector(&mut rng),
            radius: 0.02,
        });
        let union = SphereUnion::new(spheres.collect()).unwrap();
        let support = Support::about(DVec3::ZERO, union.spheres());
        for start in support.directions.iter().step_by(101) {
            let end = descend(&support, *start);
            assert!(support.height(end) <= support.height(*start));
            assert!((end.length() - 1.0).abs() < 1e-12);
        }
    }
}
