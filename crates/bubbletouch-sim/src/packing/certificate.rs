//! Proof that all points of the outer surface are within the tolerance of the spheres, or a list of gaps.
//!
//! A ball contains a triangle if it contains its corners. Each triangle of the mesh is therefore halved until every piece has one of four results:
//!
//! - one ball contains the piece (proved),
//! - the piece lies inside the solid (it is no outer surface),
//! - the middle of the piece is on the outer surface, and no ball contains the piece (a gap),
//! - the piece is smaller than a limit (counted as a gap).
//!
//! If parts overlap, a triangle can lie partly inside another part. Testing a few points cannot show this, so pieces are only classified if no other face
//! crosses them.

use super::ball::Ball;
use super::sampling::Sample;
use super::target::Target;
use crate::mesh::{Bvh, Triangle};
use glam::DVec3;

/// Size of a piece of surface, relative to the tolerance, below which the piece counts as a gap if no single ball covers it.
const SMALLEST: f64 = 0.02;

/// Gaps: pieces of the mesh's surface that are not proved to lie within the tolerance of the spheres.
#[derive(Debug, Default)]
pub(super) struct Gaps {
    /// Centres and sizes of the gaps; empty if the tolerance is proved everywhere.
    pub places: Vec<Sample>,
    /// Indices of the triangles that contain gaps.
    pub triangles: Vec<usize>,
}

/// Returns the gaps that `balls` leave in the given triangles of the target. A triangle without gaps has none after more balls are added.
pub(super) fn gaps(target: &Target, triangles: &[usize], balls: &[Ball]) -> Gaps {
    let Target { surface, e, .. } = *target;
    let mut balls_near = vec![Vec::new(); triangles.len()];
    let looked_at = triangles
        .iter()
        .map(|&number| surface.mesh().triangle(number));
    let Some(tree) = Bvh::from_triangles(looked_at.collect()) else {
        return Gaps::default();
    };
    for (index, ball) in balls.iter().enumerate() {
        let reach2 = ball.reach(e).powi(2);
        tree.search(
            reach2,
            |bounds| bounds.distance_squared(ball.center),
            |number, triangle, limit| {
                if touches(triangle, ball, e) {
                    balls_near[number].push(index as u32);
                }
                limit
            },
        );
    }
    let mut gaps = Gaps::default();
    for (&number, near) in triangles.iter().zip(balls_near) {
        let n_before = gaps.places.len();
        gaps_of(
            target,
            surface.mesh().triangle(number),
            near,
            balls,
            &mut gaps.places,
        );
        if gaps.places.len() > n_before {
            gaps.triangles.push(number);
        }
    }
    gaps
}

fn touches(triangle: &Triangle, ball: &Ball, e: f64) -> bool {
    let reach2 = ball.reach(e).powi(2);
    let is_inside = |point: DVec3| point.distance_squared(ball.center) < reach2;
    // Most triangles that touch the ball have a corner inside.
    triangle.0.into_iter().any(is_inside) || is_inside(triangle.closest(ball.center).0)
}

fn gaps_of(
    target: &Target,
    triangle: Triangle,
    near: Vec<u32>,
    balls: &[Ball],
    gaps: &mut Vec<Sample>,
) {
    let e = target.e;
    let normal = triangle.normal().unwrap_or_default();
    let mut waiting = vec![(triangle, near)];
    while let Some((piece, near)) = waiting.pop() {
        let holds = |index: u32, point| {
            let ball = &balls[index as usize];
            ball.center.distance_squared(point) <= ball.reach(e).powi(2)
        };
        let holds_all = |&index: &u32| piece.0.iter().all(|&corner| holds(index, corner));
        if near.iter().any(holds_all) {
            continue;
        }
        let middle = piece.middle();
        let is_buried = target.is_buried(middle, normal);
        if is_buried && target.is_uncrossed(&piece, normal) {
            continue;
        }
        let is_held = is_buried || near.iter().any(|&index| holds(index, middle));
        let is_small = piece.longest_edge_squared() < (SMALLEST * e).powi(2);
        if !is_held || is_small {
            gaps.push(Sample {
                position: middle,
                radius: 0.5 * piece.longest_edge_squared().sqrt(),
            });
            continue;
        }
        for half in piece.bisected() {
            let still_near = near.iter().copied();
            let still_near = still_near.filter(|&i| touches(&half, &balls[i as usize], e));
            waiting.push((half, still_near.collect()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Surface, TriangleMesh};
    use crate::packing::Body;

    /// Returns a square of side 2 in the plane z = 0.
    fn square() -> Surface {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let corners = corners.map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec();
        let triangles = vec![[0, 1, 2], [0, 2, 3]];
        Surface::new(TriangleMesh::new("square", corners, triangles).unwrap())
    }

    fn gaps_with(balls: &[Ball], e: f64) -> Vec<Sample> {
        let surface = square();
        let target = Target {
            surface: &surface,
            body: Body::Sheet,
            e,
        };
        gaps(&target, &[0, 1], balls).places
    }

    #[test]
    fn four_balls_hold_a_square_exactly_when_they_reach_its_middle_and_corners() {
        let places = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];
        let balls = places.map(|(x, y)| Ball::on_surface(DVec3::new(x, y, 0.0)));
        // Each ball must reach √½ = 0.7071 = 3e/2.
        assert!(gaps_with(&balls, 0.4715).is_empty());
        let open = gaps_with(&balls, 0.4713);
        assert!(!open.is_empty());
        let is_expected =
            |place: DVec3| place.truncate().min_element() < 0.02 || place.max_element() > 0.98;
        let mut places = open.iter().map(|gap| gap.position.abs());
        assert!(places.all(is_expected));
    }

    #[test]
    fn without_one_ball_there_is_a_gap_where_it_was() {
        let places = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5)];
        let balls = places.map(|(x, y)| Ball::on_surface(DVec3::new(x, y, 0.0)));
        let open = gaps_with(&balls, 0.48);
        let missing = DVec3::new(-0.5, 0.5, 0.0);
        assert!(open.iter().any(|gap| gap.position.distance(missing) < 0.5));
        assert!(open.iter().all(|gap| gap.position.distance(missing) < 0.8));
    }
}
